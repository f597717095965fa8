// SPDX-License-Identifier: Apache-2.0
#include "sim/profile_kind.hpp"

#include "shaper/profile/matched.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::sim {
namespace {

struct NamedKind {
  const char* name;
  ProfileKind kind;
};

constexpr NamedKind kKinds[] = {{"s-curve", ProfileKind::kSCurve}, {"trapezoid", ProfileKind::kTrapezoid},
                                {"sin2", ProfileKind::kSin2},      {"poly5", ProfileKind::kPoly5},
                                {"poly7", ProfileKind::kPoly7},    {"table", ProfileKind::kTable},
                                {"matched", ProfileKind::kMatched}};

Refusal unknown(const std::string& text) {
  return bad_argument(
      "--kind", text,
      "not a known kind of profile, accepted: s-curve trapezoid sin2 poly5 poly7 table:FILE matched:F:Z");
}

ProfileDetail mode_of(const std::string& text) {
  const std::vector<std::string> cells = split(text, ':');
  if (cells.size() != 3)
    throw bad_argument("--kind", text, "not a mode, matched:FREQUENCY:DAMPING (Hz, ratio) is accepted");
  return ProfileDetail{nullptr, parse_positive(cells[1], "--kind"), parse_within(cells[2], "--kind", 0.0, 0.99),
                       plan_matched};
}

}  // namespace

SpecifiedProfile parse_profile(const std::string& text) {
  const size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  SpecifiedProfile profile{};
  const NamedKind* found = nullptr;
  for (const NamedKind& kind : kKinds) {
    if (name == kind.name) found = &kind;
  }
  if (found == nullptr) throw unknown(text);
  profile.kind = found->kind;
  if (profile.kind == ProfileKind::kMatched) {
    profile.detail = mode_of(text);
  } else if (profile.kind == ProfileKind::kTable) {
    profile.file = colon == std::string::npos ? "" : text.substr(colon + 1);
    const auto owned = std::make_shared<SpecifiedProfile::Owned>();
    owned->data = read_table(profile.file);
    owned->table = owned->data.table();
    profile.detail.table = &owned->table;
    profile.owned_ = owned;
  } else if (colon != std::string::npos) {
    throw unknown(text);
  }
  return profile;
}

std::string profile_text(const SpecifiedProfile& profile) {
  std::string text;
  for (const NamedKind& kind : kKinds) {
    if (profile.kind == kind.kind) text = kind.name;
  }
  if (profile.kind == ProfileKind::kTable) text += ":" + profile.file;
  if (profile.kind == ProfileKind::kMatched)
    text += ":" + shortest(profile.detail.frequency_hz) + ":" + shortest(profile.detail.damping_ratio);
  return text;
}

}  // namespace stillpoint::sim
