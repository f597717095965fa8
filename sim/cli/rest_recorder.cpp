// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/rest_recorder.hpp"

#include <cmath>

#include "firmware/default_axis.hpp"
#include "firmware/registers.hpp"
#include "shaper/tune/auto_tune.hpp"
#include "sim/cli/drive_scope.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

using firmware::Register;

constexpr uint32_t kGapsOfTicks = 100;  // one in so many, at most
// Four channels leave each half a second, which a motor has to come to rest (see RestWatch).
constexpr char kLookedAt[] = "following-error,accelerometer,setpoint,position";

}  // namespace

void RestRecorder::prepare(const TuneConfig& config, int32_t home) {
  ListenPlan listen{};
  sim::require(plan_listening(config.low_hz, config.high_hz, firmware::kDefaultAxis.tick_s, config.samples, listen));
  decimation_ = listen.decimation;
  source_ = config.source;
  ends_[0] = home;
  ends_[1] = config.move.target_counts;
}

sim::RecordedRest RestRecorder::move_and_record() {
  if (!looked_ && source_ != TuneSource::kFollowingError) look_at_sensors();
  looked_ = true;
  sim::RecordedRest rest;
  rest.following_error = motor_;
  sim::RestChannel& heard = by_accelerometer_ ? rest.acceleration : rest.following_error;
  const uint32_t missing_before = client_.read32(Register::kServoMissing);
  heard = {record(by_accelerometer_ ? "accelerometer" : "following-error", decimation_)[0], decimation_};
  gaps_ = client_.read32(Register::kServoMissing) - missing_before;
  if (gaps_ > heard.ticks() / kGapsOfTicks) {
    throw sim::Refusal(sim::Refusal::Cause::kCannot, "record", std::to_string(gaps_) + " ticks without feedback",
                       "at most 1 % are accepted", text(Finding::kNoisy));
  }
  return rest;
}

void RestRecorder::look_at_sensors() {
  const Channels both = record(kLookedAt, 1);
  motor_ = {both[0], 1};
  by_accelerometer_ = source_ == TuneSource::kAccelerometer || sim::changes(both[1]);
  client_.finish(start_other_way().total_ticks);
}

RestRecorder::Channels RestRecorder::record(const std::string& channels, uint32_t decimation) {
  ScopeRequest request;
  request.channels = channels;
  request.trigger = "rest";
  request.pre_percent = "0";
  request.decimation = std::to_string(decimation);
  const ScopeRecord record = capture_scope(
      port_, request, [this] { start_other_way(); }, meanwhile_);
  Channels whole;
  for (const std::vector<double>& channel : record.channels) {
    std::vector<int32_t>& samples = whole.emplace_back();
    for (const double value : channel) samples.push_back(static_cast<int32_t>(std::lround(value)));
  }
  return whole;
}

MoveReport RestRecorder::start_other_way() {
  is_out_ = !is_out_;
  client_.write32(Register::kTargetPosition, static_cast<uint32_t>(ends_[is_out_ ? 1 : 0]));
  try {
    return client_.start();
  } catch (const sim::Refusal& refusal) {
    if (refusal.result() != "drive_refused" || client_.read(Register::kZeroDelay) == 0) throw;
    client_.write(Register::kZeroDelay, 0);
  }
  return client_.start();
}

}  // namespace stillpoint::cli
