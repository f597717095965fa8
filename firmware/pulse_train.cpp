// SPDX-License-Identifier: Apache-2.0
#include "firmware/pulse_train.hpp"

#include "shaper/base/divide.hpp"

namespace stillpoint::firmware {
namespace {

constexpr int kCountBits = 10;
static_assert(kMostPulses < 1u << kCountBits, "a burst's count is found bit by bit");

}  // namespace

void PulseTrain::use(const PulseTiming& timing) {
  timing_ = timing;
  pulse_ = Wide{uint64_t{timing.ratio.counts} << kSignalFractionBits, 0};
  align(setpoint_);
}

void PulseTrain::align(Signal setpoint) {
  setpoint_ = setpoint;
  owed_ = Wide{};
  moved_ = false;
  limited_in_a_row_ = 0;
}

// Whole pulses owed, either way, halves up; kMostPulses and more are just that.
uint32_t PulseTrain::due() const {
  const bool backward = is_negative(owed_);
  const uint64_t half = pulse_.low / 2 - (backward ? 1 : 0);
  Wide sum{half, 0};
  add_product(sum, owed_, Wide::from_int(backward ? -1 : 1));
  Wide rest = sum;
  uint32_t count = 0;
  for (uint32_t bit = 1u << kCountBits; (bit >>= 1) != 0;) {
    Wide left = sum;
    add_product(left, pulse_, Wide::from_int(-static_cast<int64_t>(count | bit)));
    if (is_negative(left)) continue;
    rest = left;
    count |= bit;
  }
  const bool reversal = moved_ && backward == forward_;
  return timing_.reversal_gap && reversal && count == 1 && rest.low < half ? 0 : count;
}

void PulseTrain::owe(int64_t pulses) { add_product(owed_, pulse_, Wide::from_int(pulses)); }

PulseBurst PulseTrain::next(Signal setpoint) {
  add_product(owed_, Wide::from_int(wrapping_difference(setpoint, setpoint_)), Wide{timing_.ratio.pulses, 0});
  setpoint_ = setpoint;
  PulseBurst burst{due(), 0, forward_, false};
  if (burst.count == 0) {
    note_limit(false);
    return burst;
  }
  burst.forward = !is_negative(owed_);
  burst.reversed = burst.forward != forward_;
  const uint32_t most = burst.reversed ? timing_.most_reversing : timing_.most;
  note_limit(burst.count > most);
  if (burst.count > most) burst.count = most;
  if (burst.count == 0) return {0, 0, forward_, false};  // not configured
  burst.period_cycles = static_cast<uint32_t>(divide(timing_.window_cycles, burst.count));
  const int64_t signed_count = burst.count;
  owe(burst.forward ? -signed_count : signed_count);
  forward_ = burst.forward;
  moved_ = true;
  return burst;
}

void PulseTrain::give_back(const PulseBurst& burst) {
  const int64_t signed_count = burst.count;
  owe(burst.forward ? signed_count : -signed_count);
  if (burst.reversed) forward_ = !forward_;
}

void PulseTrain::note_limit(bool limited) {
  limited_ticks_ += limited ? 1 : 0;
  limited_in_a_row_ = limited ? limited_in_a_row_ + 1 : 0;
}

}  // namespace stillpoint::firmware
