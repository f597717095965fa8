// SPDX-License-Identifier: Apache-2.0
#include "shaper/tune/tune_plan.hpp"

#include "shaper/base/math.hpp"
#include "shaper/shaping/shaper_spec.hpp"

namespace stillpoint {

namespace {

constexpr double kHighestOfRate = 0.4;  // of the samples': room for the mean's roll-off
constexpr double kWantedPeriods = 4.0;
constexpr double kLeastPeriods = 3.0;
constexpr double kWindow_s = 0.1;
constexpr double kPatience_s = 0.25;
constexpr uint32_t kSensorLag = 3;    // ticks from the setpoint's rest to its being seen
constexpr double kMovesStill = 0.01;  // of the most it moved in a window
constexpr double kLeastCounts = 2.0;  // what an encoder flickers by
constexpr uint32_t kMostDecimation = 64;

Status between(Quantity quantity, double value, double low, double high) {
  if (!math::is_finite(value)) return refuse(Error::kNotFinite, quantity, value);
  if (value < low) return refuse(Error::kBelowMinimum, quantity, value, low);
  if (value > high) return refuse(Error::kAboveMaximum, quantity, value, high);
  return kOk;
}

Status check_choices(const TuneConfig& config) {
  const auto excitation = static_cast<uint32_t>(config.excitation);
  if (excitation >= kTuneExcitations)
    return refuse(Error::kAboveMaximum, Quantity::kKind, excitation, kTuneExcitations - 1.0);
  if (excitation > static_cast<uint32_t>(TuneExcitation::kMove))
    return refuse(Error::kNotAvailable, Quantity::kKind, excitation, static_cast<double>(TuneExcitation::kMove));
  const auto source = static_cast<uint32_t>(config.source);
  if (source >= kTuneSources) return refuse(Error::kAboveMaximum, Quantity::kKind, source, kTuneSources - 1.0);
  return between(Quantity::kTolerance, config.tolerance, kMinTolerance, kMaxTolerance);
}

// The least decimation whose record holds enough periods, as far as the high end lets it.
Status plan_listening(const TuneConfig& config, double tick_s, uint32_t samples, ListenPlan& listen) {
  Status status = check_positive(Quantity::kFrequency, config.low_hz);
  if (status.ok()) status = between(Quantity::kFrequency, config.high_hz, config.low_hz, kHighestOfRate / tick_s);
  if (!status.ok()) return status;
  const double record_s = samples * tick_s;
  uint32_t decimation = 1;
  while (record_s * decimation * config.low_hz < kWantedPeriods && decimation < kMostDecimation &&
         config.high_hz * tick_s * 2.0 * decimation <= kHighestOfRate)
    decimation *= 2;
  if (record_s * decimation * config.low_hz < kLeastPeriods)
    return refuse(Error::kBelowMinimum, Quantity::kFrequency, config.low_hz, kLeastPeriods / (record_s * decimation));
  listen.rate_hz = 1.0 / (tick_s * decimation);
  const double window = math::floor(kWindow_s / tick_s);
  const uint32_t most = samples / 2 * decimation;
  listen.window_ticks = window < 8.0 ? 8 : window < most ? static_cast<uint32_t>(window) : most;
  listen.patience_ticks = static_cast<uint32_t>(kPatience_s / tick_s);
  listen.samples = samples;
  listen.decimation = decimation;
  listen.pre_trigger = (listen.window_ticks - kSensorLag) / decimation - (decimation > 1 ? 1 : 0);
  return kOk;
}

// As AxisCore::command finds it.
Status find_target(const AxisCore& axis, const Move& move, const AxisState& now, TunePlan& plan) {
  const AxisConfig& config = axis.config();
  const int32_t counts = move.target_counts;
  if (config.modulo_counts != 0) {
    const auto turn = static_cast<int32_t>(config.modulo_counts);
    const Status status = between(Quantity::kPosition, counts, 0.0, turn - 1.0);
    if (!status.ok()) return status;
    Turns turns{};
    turns.configure(config.modulo_counts);
    turns.zero = now.zero;
    plan.home_counts = axis.reading_counts();
    plan.home = wrapping_sum(now.setpoint, signal_from_counts(plan.home_counts) - turns.reading(now.setpoint));
    plan.target = wrapping_sum(now.setpoint, turns.distance(now.setpoint, signal_from_counts(counts), move.approach));
    return kOk;
  }
  plan.target = signal_from_counts(counts);
  plan.home_counts = counts_from_signal(now.setpoint);
  plan.home = signal_from_counts(plan.home_counts);
  if (!config.has_soft_limits()) return kOk;
  const Status status = between(Quantity::kPosition, counts, config.soft_low_counts, config.soft_high_counts);
  return status.ok() ? between(Quantity::kPosition, plan.home_counts, config.soft_low_counts, config.soft_high_counts)
                     : status;
}

Status plan_move(const AxisCore& axis, const TuneConfig& config, double distance, Announcement& announced) {
  const double tick_s = axis.config().tick_s;
  Plan plan{};
  Status status = plan_rest_to_rest(distance, config.move.limits, config.move.kind, tick_s, plan, config.move.detail);
  if (!status.ok()) return status;
  const double wanted = math::floor(config.move.duration_s / tick_s + 0.5);
  if (config.move.duration_s != 0.0 && wanted < plan.duration_ticks)
    return refuse(Error::kBelowMinimum, Quantity::kDuration, config.move.duration_s, plan.duration_ticks * tick_s);
  if (wanted > plan.duration_ticks) status = stretch(plan, static_cast<uint32_t>(wanted));
  if (!status.ok()) return status;
  const Peaks peaks = peaks_of(plan, tick_s);
  announced =
      Announcement{math::abs(distance), peaks.velocity, peaks.acceleration, peaks.jerk, plan.duration_ticks * tick_s};
  return kOk;
}

}  // namespace

Status plan_tuning(const AxisCore& axis, const TuneConfig& config, size_t samples, size_t memory, TunePlan& plan) {
  const double tick_s = axis.config().tick_s;
  Status status = check_choices(config);
  if (status.ok()) status = config.move.limits.validate();
  if (status.ok()) status = config.move.limits.within(axis.config().maximum);
  if (status.ok()) status = between(Quantity::kDuration, config.move.duration_s, 0.0, kMaxDurationTicks * tick_s);
  if (status.ok()) status = check_positive(Quantity::kTravel, config.travel_counts);
  if (!status.ok()) return status;
  size_t size = samples;
  while (size > memory) size /= 2;
  if (size < kLeastTuneMemory)
    return refuse(Error::kLineTooShort, Quantity::kSamples, static_cast<double>(kLeastTuneMemory),
                  static_cast<double>(memory));
  TunePlan result{};
  status = plan_listening(config, tick_s, static_cast<uint32_t>(size), result.listen);
  if (!status.ok()) return status;
  const AxisState now = axis.state();
  status = find_target(axis, config.move, now, result);
  if (!status.ok()) return status;
  const double distance =
      static_cast<double>(wrapping_difference(result.target, now.setpoint)) / static_cast<double>(kSignalPerCount);
  if (distance == 0.0) return refuse(Error::kNotPositive, Quantity::kDistance, 0.0);
  if (math::abs(distance) > config.travel_counts)
    return refuse(Error::kAboveMaximum, Quantity::kTravel, math::abs(distance), config.travel_counts);
  status = plan_move(axis, config, distance, result.announced);
  if (!status.ok()) return status;
  const double window_s = result.listen.window_ticks * tick_s;
  const double still = kMovesStill * result.announced.velocity * window_s;
  result.listen.tolerance =
      static_cast<Signal>((still > kLeastCounts ? still : kLeastCounts) * static_cast<double>(kSignalPerCount));
  plan = result;
  return kOk;
}

}  // namespace stillpoint
