// SPDX-License-Identifier: Apache-2.0
// The shaper and arm specifications that people write.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "shaper/shaping/design.hpp"
#include "shaper/shaping/mode.hpp"
#include "sim/plant/arm.hpp"

namespace stillpoint::sim {

// TYPE:FREQUENCY:DAMPING[:key=value[,key=value]], taken apart: v=TOLERANCE, spacing=PERIODS (mzv), file=CSV (custom).
struct SpecifiedShaper : stillpoint::ShaperSpec {
  std::string file;
  std::shared_ptr<const ImpulseTrain> owned;  // what `train` points to
};
SpecifiedShaper shaper_spec(ShaperKind kind, const Mode& mode, double tolerance = kDefaultTolerance);

// A train of `time_s,amplitude` lines; a header line and lines that start with '#' are passed over. Throws a Refusal.
ImpulseTrain read_train(const std::string& path);

std::string spec_text(const SpecifiedShaper& spec);
// Joined by '+', as parse_shapers reads them.
std::string spec_text(const std::vector<SpecifiedShaper>& specs);
// What the core proposes, none of it custom.
std::vector<SpecifiedShaper> specified(const ShaperSpec* specs, size_t count);

// One SPEC, or several joined by '+'. `none` gives no shaper. Throws a Refusal.
std::vector<SpecifiedShaper> parse_shapers(std::string_view text);

// F:Z[:SHARE][,F:Z[:SHARE]...]. A share left out: what the others leave, in equal parts. Throws a Refusal.
ArmModes parse_arm(std::string_view text);

// All stages one after the other. Throws a Refusal.
ShaperDesign design_for(const std::vector<SpecifiedShaper>& specs, double tick_s);

}  // namespace stillpoint::sim
