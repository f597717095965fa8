// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/shaper_in_force.hpp"

#include <cmath>

#include "firmware/default_axis.hpp"
#include "firmware/registers.hpp"
#include "sim/refusal.hpp"
#include "sim/spec.hpp"

namespace stillpoint::cli {
namespace {

using firmware::address_of;
using firmware::Register;
using firmware::ShaperState;

constexpr uint16_t kModeWords = firmware::kModeStride * firmware::kMaxModes;
constexpr uint16_t kApplyAtRest = 1;
constexpr double kUsPerSecond = 1e6;

sim::Refusal cannot(const char* value, const char* why) {
  return sim::Refusal(sim::Refusal::Cause::kCannot, "shaper", value, why, "drive_refused");
}

}  // namespace

ShaperInForce::ShaperInForce(sim::RegisterPort& port)
    : port_(port), client_(port), shown_(client_.read(Register::kShaperSet)) {
  if (static_cast<ShaperState>(client_.read(Register::kShaperState)) == ShaperState::kPending)
    throw cannot("pending", "one is on its way, a drive that has it in force is accepted");
  const uint32_t delay_us = client_.read32(Register::kActiveDelayUs);
  bool found = delay_us == 0 || is_in_force(delay_us);
  for (uint16_t set = 0; set < firmware::kShaperSets && !found; ++set) {
    show(set);
    found = is_in_force(delay_us);
  }
  if (!found) {
    show(shown_);
    throw cannot("in force",
                 "not as any set has it staged and so not to be put back, one applied as staged is accepted");
  }
  staged_count_ = client_.read(Register::kModeCount);
  count_ = delay_us == 0 ? uint16_t{0} : staged_count_;
  staged_ = port_.read(address_of(Register::kFirstMode), kModeWords);
}

// Designed as the drive does, so that the delays are equal to the microsecond that the register has.
bool ShaperInForce::is_in_force(uint32_t delay_us) {
  const std::vector<sim::SpecifiedShaper> specs = specified(client_.staged_modes());
  const double tick_s = firmware::kDefaultAxis.tick_s;
  try {
    return std::lround(sim::design_for(specs, tick_s).delay_ticks() * tick_s * kUsPerSecond) == delay_us;
  } catch (const sim::Refusal&) {  // staged, and nothing that could be in force
    return false;
  }
}

void ShaperInForce::show(uint16_t set) { client_.write(Register::kShaperSet, set); }

void ShaperInForce::put_back() {
  port_.write(address_of(Register::kFirstMode), staged_);
  client_.write(Register::kModeCount, count_);
  client_.write(Register::kApplyShaper, kApplyAtRest);
  auto state = ShaperState::kPending;
  for (const uint64_t begun = port_.ticks();
       state == ShaperState::kPending && client_.read(Register::kErrorCode) == 0;) {
    state = static_cast<ShaperState>(client_.read(Register::kShaperState));
    if (port_.ticks() - begun > ChipClient::kPatienceTicks)
      throw cannot("of before", "not put back in time, it is staged, and an apply (0130 = 1) is accepted");
  }
  if (state == ShaperState::kRefused) client_.refuse_with_reason();
  client_.write(Register::kModeCount, staged_count_);
  show(shown_);
}

void ShaperInForce::keep() { show(shown_); }

}  // namespace stillpoint::cli
