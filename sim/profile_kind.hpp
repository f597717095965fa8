// SPDX-License-Identifier: Apache-2.0
// The kind of profile that people write.
#pragma once

#include <memory>
#include <string>

#include "shaper/profile/plan.hpp"
#include "sim/table_file.hpp"

namespace stillpoint::sim {

struct SpecifiedProfile {
  ProfileKind kind = ProfileKind::kSCurve;
  ProfileDetail detail = {};
  std::string file;  // of a table

  bool jerk_limited() const { return limits_jerk(kind, detail); }

 private:
  friend SpecifiedProfile parse_profile(const std::string& text);
  struct Owned {
    TableData data;
    ProfileTable table;
  };
  std::shared_ptr<const Owned> owned_;  // what `detail` points to
};

// s-curve trapezoid sin2 poly5 poly7 table:FILE matched:F:Z. Throws a Refusal.
SpecifiedProfile parse_profile(const std::string& text);

std::string profile_text(const SpecifiedProfile& profile);

}  // namespace stillpoint::sim
