// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/drive_scope.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "firmware/default_axis.hpp"
#include "firmware/registers.hpp"
#include "shaper/identify/capture.hpp"
#include "shaper/tune/auto_tune.hpp"
#include "sim/cli/chip_client.hpp"
#include "sim/cli/progress.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::Register;
using firmware::ScopeCommand;
using firmware::ScopeTrigger;

uint16_t one_of(const std::string& option, const std::string& text, const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found != names.end()) return static_cast<uint16_t>(found - names.begin());
  std::string accepted;
  for (const std::string& name : names) accepted += " " + name;
  throw sim::bad_argument(option, text, "not known, accepted:" + accepted);
}

struct Wanted {
  std::vector<uint16_t> channels;
  uint16_t trigger;
  int32_t level;
  uint16_t edge;
  uint16_t pre_percent;
  uint16_t decimation;
  double timeout_s;
};

Wanted wanted_of(const ScopeRequest& request) {
  Wanted wanted{};
  std::istringstream names(request.channels);
  for (std::string name; std::getline(names, name, ',');) wanted.channels.push_back(scope_channel_named(name));
  if (wanted.channels.empty() || wanted.channels.size() > kMaxChannels) {
    throw sim::bad_argument("--channels", request.channels,
                            fmt::format("one to {} of these are accepted: {}", kMaxChannels, kScopeChannels));
  }
  wanted.trigger = one_of("--trigger", request.trigger, {"hand", "level", "motion", "fault", "rest"});
  wanted.level = static_cast<int32_t>(sim::parse_integer(request.level, "--level", INT32_MIN, INT32_MAX));
  wanted.edge = one_of("--edge", request.edge, {"rising", "falling", "either"});
  wanted.pre_percent = static_cast<uint16_t>(sim::parse_integer(request.pre_percent, "--pre", 0, 99));
  wanted.decimation = static_cast<uint16_t>(sim::parse_integer(request.decimation, "--decimation", 1, UINT16_MAX));
  wanted.timeout_s = sim::parse_positive(request.timeout, "--timeout");
  return wanted;
}

class DriveScope {
 public:
  explicit DriveScope(sim::RegisterPort& port) : port_(port), client_(port) {}

  void arm(const Wanted& wanted) {
    // Level and edge around an even address; 0309 in front of the channels is not to be written.
    client_.write(Register::kScopeTrigger, wanted.trigger);
    client_.write(Register::kScopeTriggerChannel, 0);
    client_.write32(Register::kScopeLevel, static_cast<uint32_t>(wanted.level));
    port_.write(address_of(Register::kScopeEdge), {wanted.edge, wanted.pre_percent, wanted.decimation});
    std::vector<uint16_t> channels = wanted.channels;
    channels.resize(kMaxChannels);
    port_.write(address_of(Register::kFirstScopeChannel), channels);
    try {
      command(ScopeCommand::kArm);
    } catch (const sim::RegisterRefusal& refusal) {
      client_.explain(refusal);
    }
  }

  void wait(const Wanted& wanted, uint32_t most_samples, const std::function<void()>& meanwhile) {
    Progress progress("capturing");
    const uint32_t before = most_samples * wanted.pre_percent / 100;
    const bool by_hand = wanted.trigger == static_cast<uint16_t>(ScopeTrigger::kByHand);
    bool triggered = false;
    for (const uint64_t begun = port_.ticks();;) {
      if (meanwhile) meanwhile();
      const auto state = static_cast<CaptureState>(client_.read(Register::kScopeState));
      if (state == CaptureState::kFull) return;
      if (state == CaptureState::kIdle) throw cannot("stopped", "the drive needs its memory", "scope_stopped");
      const uint32_t samples = client_.read(Register::kScopeSamples);
      if (!meanwhile) progress.update(static_cast<double>(samples) / most_samples);
      if (by_hand && !triggered && samples >= before) {
        command(ScopeCommand::kTrigger);
        triggered = true;
      }
      const bool late = static_cast<double>(port_.ticks() - begun) > 1000.0 * wanted.timeout_s;
      if (!late || state == CaptureState::kRunning) continue;
      throw cannot("not triggered", "a longer --timeout, or another --trigger or --level, is accepted",
                   "not_triggered");
    }
  }

  ScopeRecord fetch(const Wanted& wanted) {
    const uint32_t count = client_.read(Register::kScopeSamples);
    const uint32_t before = client_.read(Register::kScopeBefore);
    ScopeRecord record;
    const double interval_s = firmware::kDefaultAxis.tick_s * wanted.decimation;
    for (uint32_t n = 0; n < count; ++n) {
      record.time_s.push_back((static_cast<double>(n) - static_cast<double>(before)) * interval_s);
    }
    for (size_t k = 0; k < wanted.channels.size(); ++k) {
      record.names.emplace_back(scope_channel_name(wanted.channels[k]));
      record.channels.push_back(channel(static_cast<uint32_t>(k), count));
    }
    return record;
  }

  void try_to_stop() {
    try {
      command(ScopeCommand::kStop);
    } catch (const sim::Refusal&) {  // silent: what ends it here is said
    }
  }

 private:
  static sim::Refusal cannot(const char* value, const char* why, const char* result) {
    return sim::Refusal(sim::Refusal::Cause::kCannot, "scope", value, why, result);
  }
  void command(ScopeCommand what) { client_.write(Register::kScopeCommand, static_cast<uint16_t>(what)); }

  std::vector<double> channel(uint32_t k, uint32_t count) {
    std::vector<double> values;
    for (uint32_t block = 0; values.size() < count; ++block) {
      client_.write(Register::kScopePage, static_cast<uint16_t>(k << 8 | block));
      const size_t left = std::min<size_t>(firmware::kScopePage, count - values.size());
      const std::vector<uint16_t> words = port_.read(firmware::kFirstScopeWord, static_cast<uint16_t>(2 * left));
      for (size_t i = 0; i < left; ++i) {
        values.push_back(static_cast<int32_t>(uint32_t{words[2 * i]} << 16 | words[2 * i + 1]));
      }
    }
    return values;
  }

  sim::RegisterPort& port_;
  ChipClient client_;
};

}  // namespace

ScopeRecord capture_scope(sim::RegisterPort& port, const ScopeRequest& request, const std::function<void()>& armed,
                          const std::function<void()>& meanwhile) {
  const Wanted wanted = wanted_of(request);
  DriveScope scope(port);
  scope.arm(wanted);
  try {
    armed();
    scope.wait(wanted, static_cast<uint32_t>(TuneMemory::kSamples / wanted.channels.size()), meanwhile);
    return scope.fetch(wanted);
  } catch (const sim::Refusal&) {
    scope.try_to_stop();
    throw;
  }
}

void stop_scope(sim::RegisterPort& port) {
  port.write(address_of(Register::kScopeCommand), static_cast<uint16_t>(ScopeCommand::kStop));
}

Settings settings_of(const ScopeRequest& request) {
  return {{"channels", request.channels},
          {"trigger", request.trigger},
          {"level", request.level},
          {"edge", request.edge},
          {"pre-trigger", request.pre_percent + " %"},
          {"decimation", request.decimation + " ticks"},
          {"time", "0 at the trigger"}};
}

void add_scope_request(CLI::App& app, ScopeRequest& request) {
  add_value(app, "--channels", request.channels, "NAME,...", std::string("scope: up to four of ") + kScopeChannels);
  add_value(app, "--trigger", request.trigger, "hand|level|motion|fault|rest", "scope: what begins the record");
  add_value(app, "--level", request.level, "VALUE", "scope: of the first channel, with --trigger level");
  add_value(app, "--edge", request.edge, "rising|falling|either", "scope: which way it is crossed");
  add_value(app, "--pre", request.pre_percent, "PERCENT", "scope: of the record, from before the trigger");
  add_value(app, "--decimation", request.decimation, "TICKS", "scope: a sample every so many");
  add_value(app, "--timeout", request.timeout, "S", "scope: how long the trigger may take");
}

}  // namespace stillpoint::cli
