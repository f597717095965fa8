// SPDX-License-Identifier: Apache-2.0
// Shapers that several tests run.
#pragma once

#include "shaper/shaping/design.hpp"
#include "tests/support/test.hpp"

namespace stillpoint::testing {

inline ShaperDesign shaper_of(ShaperKind kind, double frequency_hz, double damping_ratio, double tick_s) {
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(kind, Mode{frequency_hz, damping_ratio}, tick_s, design));
  return design;
}

// Undamped, 5 %: a long one of a single stage.
inline ShaperDesign three_hump_ei(double frequency_hz, double tick_s) {
  return shaper_of(ShaperKind::kEi3, frequency_hz, 0.0, tick_s);
}

}  // namespace stillpoint::testing
