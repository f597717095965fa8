// SPDX-License-Identifier: Apache-2.0
// The registers' units, and from the shaper's doubles to a register's whole numbers, so that the value put into a
// register is one that would be accepted. Background.
#pragma once

#include <stdint.h>

namespace stillpoint::firmware {

constexpr double kFrequencyPerHz = 1e4;  // of a mode
constexpr double kDampingPerOne = 1e5;
constexpr double kResidualPerOne = 1e4;  // tolerances too
constexpr double kSpacingPerPeriod = 1e4;
constexpr double kBandPerHz = 10.0;  // of the auto-tune

// Values that are whole but for rounding count as whole.
constexpr double kRegisterSlack = 1e-6;

[[gnu::noinline]] constexpr uint32_t register_floor(double value) {
  const double nudged = value + kRegisterSlack;
  if (!(nudged >= 1.0)) return 0;
  return nudged >= static_cast<double>(UINT32_MAX) ? UINT32_MAX : static_cast<uint32_t>(nudged);
}

[[gnu::noinline]] inline uint32_t register_nearest(double value, double per_unit) {
  return register_floor(value * per_unit + 0.5);
}

constexpr uint32_t register_ceiling(double value) {
  if (!(value > kRegisterSlack)) return 0;
  const uint32_t below = register_floor(value);
  return static_cast<double>(below) >= value - kRegisterSlack || below == UINT32_MAX ? below : below + 1;
}

// The bits of an i32 register, towards zero.
constexpr uint32_t signed_register(double value) {
  return value < 0.0 ? UINT32_C(0) - register_floor(-value) : register_floor(value);
}

}  // namespace stillpoint::firmware
