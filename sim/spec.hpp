// SPDX-License-Identifier: Apache-2.0
// The shaper and arm specifications that people write.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shaper/shaping/design.hpp"
#include "shaper/shaping/mode.hpp"
#include "sim/plant/arm.hpp"

namespace stillpoint::sim {

// TYPE:FREQUENCY:DAMPING[:v=TOLERANCE], taken apart.
struct ShaperSpec {
  ShaperKind kind;
  Mode mode;
  double tolerance;  // tolerated residual, 0..1
};

constexpr double kDefaultTolerance = 0.05;

// "zv", "zvd", "none".
const char* name(ShaperKind kind);
std::string spec_text(const ShaperSpec& spec);

// One SPEC, or several joined by '+'. `none` gives no shaper. Throws a Refusal.
std::vector<ShaperSpec> parse_shapers(std::string_view text);

// F:Z[:SHARE][,F:Z[:SHARE]...]. A share left out: what the others leave, in equal parts. Throws a Refusal.
ArmModes parse_arm(std::string_view text);

// All stages one after the other. Throws a Refusal.
ShaperDesign design_for(const std::vector<ShaperSpec>& specs, double tick_s);

}  // namespace stillpoint::sim
