// SPDX-License-Identifier: Apache-2.0
#include "sim/recorded_rest.hpp"

#include <algorithm>
#include <functional>

namespace stillpoint::sim {
namespace {

// The patience of a quarter of a second and what the window looks back over, in ticks of a millisecond: see
// plan_listening. A decimation leaves more.
constexpr uint32_t kLatestRest = 256;

}  // namespace

int32_t RestChannel::at(uint32_t tick) const {
  if (samples.empty()) return 0;
  return samples[std::min<size_t>(tick / every, samples.size() - 1)];
}

size_t RecordedRest::ticks() const { return std::max(following_error.ticks(), acceleration.ticks()); }

TuneSample RecordedRest::at(uint32_t tick, Signal setpoint) const {
  return {setpoint, setpoint - following_error.at(tick) * kSignalPerCount, acceleration.at(tick), true};
}

bool changes(const std::vector<int32_t>& samples) {
  return std::adjacent_find(samples.begin(), samples.end(), std::not_equal_to<>()) != samples.end();
}

uint32_t samples_for_tuning(uint32_t scope) { return scope > kLatestRest ? scope - kLatestRest : 0; }

}  // namespace stillpoint::sim
