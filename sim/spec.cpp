// SPDX-License-Identifier: Apache-2.0
#include "sim/spec.hpp"

#include <cstdlib>
#include <fstream>

#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::sim {
namespace {

constexpr const char* kForm =
    "TYPE:FREQUENCY:DAMPING[:key=value[,key=value]] is accepted, e.g. zv:11:0.11 or ei:37:0.05:v=0.02";

ShaperKind parse_kind(const std::string& text) {
  std::string all;
  for (uint32_t i = 1; i < kShaperKinds; ++i) {
    const auto kind = static_cast<ShaperKind>(i);
    if (text == stillpoint::text(kind)) return kind;
    all += std::string(stillpoint::text(kind)) + " ";
  }
  if (text == stillpoint::text(ShaperKind::kNone)) return ShaperKind::kNone;
  throw bad_argument("shaper type", text, "not a known type, accepted: " + all + "none");
}

void parse_key(const std::string& pair, SpecifiedShaper& spec) {
  const size_t equals = pair.find('=');
  const std::string key = pair.substr(0, equals);
  const std::string value = equals == std::string::npos ? "" : pair.substr(equals + 1);
  if (equals != std::string::npos && key == "v") {
    spec.tolerance = parse_within(value, "tolerance", kMinTolerance, kMaxTolerance);
  } else if (equals != std::string::npos && key == "spacing" && spec.kind == ShaperKind::kMzv) {
    spec.spacing = parse_within(value, "spacing", kMinSpacing, kMaxSpacing);
  } else if (equals != std::string::npos && key == "file" && spec.kind == ShaperKind::kCustom) {
    spec.file = value;
    spec.owned = std::make_shared<const ImpulseTrain>(read_train(value));
    spec.train = spec.owned.get();
  } else {
    throw bad_argument("shaper key", pair,
                       "not known, v=TOLERANCE is accepted, of mzv spacing=PERIODS and of custom file=CSV as well");
  }
}

double damping_of(const std::string& text) {
  const double damping = parse_number(text, "damping ratio");
  if (damping < 0.0 || damping >= 1.0) {
    throw bad_argument("damping ratio", text, "out of range, a ratio from 0 to below 1 is accepted");
  }
  return damping;
}

// Everything behind the third colon: a file's name may have colons of its own.
std::string keys_of(const std::string& text) {
  size_t at = 0;
  for (int i = 0; i < 3 && at != std::string::npos; ++i) at = text.find(':', at == 0 ? 0 : at + 1);
  return at == std::string::npos ? "" : text.substr(at + 1);
}

SpecifiedShaper parse_shaper(const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  SpecifiedShaper spec = shaper_spec(parse_kind(parts[0]), Mode{0.0, 0.0});
  if (spec.kind == ShaperKind::kNone && parts.size() == 1) return spec;
  if (parts.size() < 3) {
    throw bad_argument("shaper", text, std::string("not a shaper specification, ") + kForm);
  }
  spec.mode.frequency_hz = parse_positive(parts[1], "frequency");
  spec.mode.damping_ratio = damping_of(parts[2]);
  if (parts.size() > 3) {
    for (const std::string& pair : split(keys_of(text), ',')) parse_key(pair, spec);
  }
  if (spec.kind == ShaperKind::kCustom && spec.train == nullptr)
    throw bad_argument("shaper", text, "has no train, custom:FREQUENCY:DAMPING:file=CSV is accepted");
  return spec;
}

bool is_number(const std::string& text) {
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return end != text.c_str();
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

SpecifiedShaper shaper_spec(ShaperKind kind, const Mode& mode, double tolerance) {
  SpecifiedShaper spec{};
  spec.kind = kind;
  spec.mode = mode;
  spec.tolerance = tolerance;
  spec.spacing = kDefaultSpacing;
  return spec;
}

ImpulseTrain read_train(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw bad_argument("train", path, "cannot be read, a CSV file of time_s,amplitude lines is accepted");
  ImpulseTrain train{};
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string where = path + ", line " + std::to_string(number);
    if (line.empty() || line[0] == '#' || line == "\r") continue;
    const std::vector<std::string> cells = split(line, ',');
    if (train.count == 0 && !is_number(cells[0])) continue;  // the header
    if (cells.size() < 2) throw bad_argument("train", where, "has no two numbers, time_s,amplitude is accepted");
    if (train.count == ImpulseTrain::kMaxImpulses)
      throw bad_argument("train", where, "too many impulses, " + std::to_string(train.count) + " are accepted");
    train.impulses[train.count++] = {parse_number(trimmed(cells[0]), where), parse_number(trimmed(cells[1]), where)};
  }
  require(train.validate());
  return train;
}

std::string spec_text(const SpecifiedShaper& spec) {
  std::string text = stillpoint::text(spec.kind);
  if (spec.kind == ShaperKind::kNone) return text;
  text += ":" + shortest(spec.mode.frequency_hz) + ":" + shortest(spec.mode.damping_ratio);
  char before = ':';
  const auto add = [&](const std::string& pair) {
    text += before + pair;
    before = ',';
  };
  if (spec.tolerance != kDefaultTolerance) add("v=" + shortest(spec.tolerance));
  if (spec.kind == ShaperKind::kMzv && spec.spacing != kDefaultSpacing) add("spacing=" + shortest(spec.spacing));
  if (spec.kind == ShaperKind::kCustom) add("file=" + spec.file);
  return text;
}

std::string spec_text(const std::vector<SpecifiedShaper>& specs) {
  std::string text;
  for (const SpecifiedShaper& spec : specs) text += (text.empty() ? "" : "+") + spec_text(spec);
  return text;
}

std::vector<SpecifiedShaper> specified(const ShaperSpec* specs, size_t count) {
  std::vector<SpecifiedShaper> all(count);
  for (size_t i = 0; i < count; ++i) static_cast<ShaperSpec&>(all[i]) = specs[i].with_defaults();
  return all;
}

std::vector<SpecifiedShaper> parse_shapers(std::string_view text) {
  std::vector<SpecifiedShaper> specs;
  for (const std::string& part : split(text, '+')) {
    const SpecifiedShaper spec = parse_shaper(part);
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

ShaperDesign design_for(const std::vector<SpecifiedShaper>& specs, double tick_s) {
  ShaperDesign design{};
  for (const SpecifiedShaper& spec : specs) require(add_shaper(spec, tick_s, design));
  return design;
}

}  // namespace stillpoint::sim
