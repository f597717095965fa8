// SPDX-License-Identifier: Apache-2.0
// What a drive with a pulse input asks for, and what it comes to in a timer's cycles. constexpr: a board whose drive is
// known when it is built has its timing from the compiler, and nothing of this in its flash.
#pragma once

#include <stdint.h>

#include "shaper/base/status.hpp"

namespace stillpoint::firmware {

// A pulse is a pause of half its period and then the level of half its period; the drive counts the edge between them.
// Times are whole nanoseconds, up to a second.
struct PulseConfig {
  uint32_t pulses;            // this many pulses are
  uint32_t counts;            // this many counts of the setpoint; both [1, 2^31 - 1]
  uint32_t clock_hz;          // of the timer that makes the pulses, [1, 2^31 - 1]
  uint32_t max_frequency_hz;  // of the pulses, [1, clock_hz]
  uint32_t tick_ns;           // > 0
  uint32_t width_ns;          // least length of a pulse and of the pause before it, > 0
  uint32_t setup_ns;          // least time from a change of direction to the first counted edge
  uint32_t hold_ns;           // least time from the end of the last pulse to a change of direction
  uint32_t jitter_ns;         // how unevenly the ticks start, from the earliest to the latest
  uint32_t most_pulses;       // in a tick, that the hardware can count, [1, kMostPulses]
  uint32_t fault_after;       // ticks in a row with pulses left over that are a fault; 0: never, they only count
  bool without_reversal_gap;  // see PulseTrain
};

constexpr uint32_t kMostPulses = 1023;

// Registers 00D0 and 00D2.
struct PulseRatio {
  uint32_t pulses, counts;
};

struct PulseTiming {
  PulseRatio ratio;
  uint32_t window_cycles;   // of a tick, that pulses may fill
  uint32_t most;            // pulses in a tick
  uint32_t most_reversing;  // in one that begins with a change of direction
  uint32_t fault_after;
  bool reversal_gap;
};

namespace pulse_timing {

constexpr uint32_t kSecondInNs = 1000000000;

constexpr uint32_t larger(uint32_t a, uint32_t b) { return a > b ? a : b; }
constexpr uint32_t smaller(uint32_t a, uint32_t b) { return a < b ? a : b; }

// a * b / c, c > 0, rounded up; it must fit.
constexpr uint32_t scaled(uint32_t a, uint32_t b, uint32_t c) {
  return static_cast<uint32_t>((uint64_t{a} * b + (c - 1)) / c);
}

constexpr Status check(const PulseConfig& config) {
  struct Range {
    uint32_t value, low, high;
    Quantity quantity;
  };
  const Range ranges[] = {{config.pulses, 1, INT32_MAX, Quantity::kGearRatio},
                          {config.counts, 1, INT32_MAX, Quantity::kGearRatio},
                          {config.clock_hz, 1, INT32_MAX, Quantity::kFrequency},
                          {config.max_frequency_hz, 1, config.clock_hz, Quantity::kFrequency},
                          {config.tick_ns, 1, kSecondInNs, Quantity::kTick},
                          {config.width_ns, 1, kSecondInNs, Quantity::kDuration},
                          {config.setup_ns, 0, kSecondInNs, Quantity::kDuration},
                          {config.hold_ns, 0, kSecondInNs, Quantity::kDuration},
                          {config.jitter_ns, 0, kSecondInNs, Quantity::kDuration},
                          {config.most_pulses, 1, kMostPulses, Quantity::kSamples}};
  for (const Range& range : ranges) {
    if (range.value < range.low) return refuse(Error::kBelowMinimum, range.quantity, range.value, range.low);
    if (range.value > range.high) return refuse(Error::kAboveMaximum, range.quantity, range.value, range.high);
  }
  return kOk;
}

}  // namespace pulse_timing

// Refuses what is outside its range, as kGearRatio, kFrequency, kTick, kDuration or kSamples (most_pulses), and a tick
// that one pulse with set-up, hold and jitter does not fit into; `timing` is then left as it was. Background: it
// divides.
constexpr Status plan_pulses(const PulseConfig& config, PulseTiming& timing) {
  using namespace pulse_timing;
  if (const Status status = check(config); !status.ok()) return status;
  const auto cycles = [&](uint32_t time_ns) { return scaled(time_ns, config.clock_hz, kSecondInNs); };
  // Half a period, rounded down, is to be no shorter than the width; rounded up, than the set-up.
  const uint32_t shortest = larger(2 * cycles(config.width_ns), scaled(config.clock_hz, 1, config.max_frequency_hz));
  const uint32_t reversing = larger(2 * cycles(config.setup_ns), shortest);
  const uint32_t kept = cycles(config.hold_ns) + cycles(config.jitter_ns) + 1;  // one for the tick, rounded up
  const uint64_t least_cycles = uint64_t{kept} + reversing;
  const uint32_t tick_cycles = cycles(config.tick_ns);
  if (tick_cycles < least_cycles) {
    const uint64_t least_ns = least_cycles * kSecondInNs / config.clock_hz + 1;
    return refuse(Error::kBelowMinimum, Quantity::kTick, config.tick_ns, static_cast<double>(least_ns));
  }
  const uint32_t window = tick_cycles - kept;
  const uint32_t most = smaller(window / shortest, config.most_pulses);
  timing =
      PulseTiming{{config.pulses, config.counts}, window, most, smaller(window / reversing, most), config.fault_after,
                  !config.without_reversal_gap};
  return kOk;
}

}  // namespace stillpoint::firmware
