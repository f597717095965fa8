// SPDX-License-Identifier: Apache-2.0
#include "sim/spec.hpp"

#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::sim {
namespace {

constexpr const char* kForm = "TYPE:FREQUENCY:DAMPING[:v=TOLERANCE] is accepted, e.g. zv:11:0.11";
constexpr const char* kTypes = "accepted: zv zvd none";

ShaperKind parse_kind(const std::string& text) {
  if (text == "zv") return ShaperKind::kZv;
  if (text == "zvd") return ShaperKind::kZvd;
  if (text == "none") return ShaperKind::kNone;
  throw bad_argument("shaper type", text, std::string("not a known type, ") + kTypes);
}

double parse_tolerance(const std::string& text) {
  const double tolerance = parse_number(text, "tolerance");
  if (tolerance <= 0.0 || tolerance >= 1.0) {
    throw bad_argument("tolerance", text, "out of range, a residual above 0 and below 1 is accepted");
  }
  return tolerance;
}

void parse_keys(const std::string& text, ShaperSpec& spec) {
  for (const std::string& pair : split(text, ',')) {
    const size_t equals = pair.find('=');
    if (equals == std::string::npos || pair.substr(0, equals) != "v") {
      throw bad_argument("shaper key", pair, "not known, v=TOLERANCE is accepted");
    }
    spec.tolerance = parse_tolerance(pair.substr(equals + 1));
  }
}

double damping_of(const std::string& text) {
  const double damping = parse_number(text, "damping ratio");
  if (damping < 0.0 || damping >= 1.0) {
    throw bad_argument("damping ratio", text, "out of range, a ratio from 0 to below 1 is accepted");
  }
  return damping;
}

ShaperSpec parse_shaper(const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  ShaperSpec spec{parse_kind(parts[0]), Mode{0.0, 0.0}, kDefaultTolerance};
  if (spec.kind == ShaperKind::kNone && parts.size() == 1) return spec;
  if (parts.size() < 3 || parts.size() > 4) {
    throw bad_argument("shaper", text, std::string("not a shaper specification, ") + kForm);
  }
  spec.mode.frequency_hz = parse_positive(parts[1], "frequency");
  spec.mode.damping_ratio = damping_of(parts[2]);
  if (parts.size() == 4) parse_keys(parts[3], spec);
  return spec;
}

void share_out(ArmModes& modes, size_t without_share, double given, const std::string& text) {
  if (without_share == 0) return;
  const double rest = 1.0 - given;
  if (rest <= 0.0) {
    throw bad_argument("arm", text,
                       "nothing is left for the modes without a share, a sum of shares below 1 is accepted");
  }
  for (ArmMode& mode : modes) {
    if (mode.share == 0.0) mode.share = rest / static_cast<double>(without_share);
  }
}

}  // namespace

const char* name(ShaperKind kind) {
  switch (kind) {
    case ShaperKind::kNone: return "none";
    case ShaperKind::kZv: return "zv";
    case ShaperKind::kZvd: return "zvd";
  }
  return "none";
}

std::string spec_text(const ShaperSpec& spec) {
  if (spec.kind == ShaperKind::kNone) return "none";
  std::string text =
      std::string(name(spec.kind)) + ":" + shortest(spec.mode.frequency_hz) + ":" + shortest(spec.mode.damping_ratio);
  if (spec.tolerance != kDefaultTolerance) text += ":v=" + shortest(spec.tolerance);
  return text;
}

std::vector<ShaperSpec> parse_shapers(std::string_view text) {
  std::vector<ShaperSpec> specs;
  for (const std::string& part : split(text, '+')) {
    const ShaperSpec spec = parse_shaper(part);
    if (spec.kind != ShaperKind::kNone) specs.push_back(spec);
  }
  return specs;
}

ArmModes parse_arm(std::string_view text) {
  ArmModes modes;
  size_t without_share = 0;
  double given = 0.0;
  for (const std::string& part : split(text, ',')) {
    const std::vector<std::string> values = split(part, ':');
    if (values.size() < 2 || values.size() > 3) {
      throw bad_argument("arm", part, "not a mode, FREQUENCY:DAMPING[:SHARE] is accepted, e.g. 11:0.11");
    }
    ArmMode mode{{parse_positive(values[0], "arm frequency"), damping_of(values[1])}, 0.0};
    if (values.size() == 3) {
      mode.share = parse_positive(values[2], "arm share");
      given += mode.share;
    } else {
      ++without_share;
    }
    modes.push_back(mode);
  }
  share_out(modes, without_share, given, std::string(text));
  if (!validate(modes).ok()) {
    throw bad_argument("arm", std::string(text), "the shares sum to more than 1, a sum of at most 1 is accepted");
  }
  return modes;
}

ShaperDesign design_for(const std::vector<ShaperSpec>& specs, double tick_s) {
  ShaperDesign design{};
  for (const ShaperSpec& spec : specs) require(add_shaper(spec.kind, spec.mode, tick_s, design));
  return design;
}

}  // namespace stillpoint::sim
