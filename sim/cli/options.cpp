// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/options.hpp"

#include <cmath>

#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

using sim::bad_argument;
using sim::parse_number;
using sim::parse_positive;

std::string needed(const std::string& text, const std::string& option, const std::string& what) {
  if (text.empty()) throw bad_argument(option, "missing", what + " is needed, `" + option + " NUMBER` is accepted");
  return text;
}

int32_t distance_counts(const MoveOptions& options, double counts_per_unit) {
  const double distance = parse_number(needed(options.distance, "--distance", "a distance"), "--distance");
  const double counts = std::round(distance * counts_per_unit);
  constexpr double kMost = kMaxPositionCounts;
  if (!(std::abs(counts) <= kMost)) {
    throw bad_argument("--distance", options.distance,
                       "beyond the range of positions, at most " + sim::shortest(kMost / counts_per_unit) +
                           " either way is accepted with --counts-per-unit " + options.counts_per_unit);
  }
  if (counts == 0.0 && distance != 0.0) {
    throw bad_argument(
        "--distance", options.distance,
        "less than half a count, 0 or at least " + sim::shortest(0.5 / counts_per_unit) + " is accepted");
  }
  return static_cast<int32_t>(counts);
}

// Left out: an s-curve where a jerk is given to plan it with, a trapezoid where not.
sim::SpecifiedProfile profile_of(const MoveOptions& options) {
  if (options.kind.empty()) return sim::parse_profile(options.jerk.empty() ? "trapezoid" : "s-curve");
  return sim::parse_profile(options.kind);
}

// What a limit in units is in counts. Beyond the range of doubles it would no longer be one.
double in_counts(const std::string& text, const std::string& option, double counts_per_unit) {
  const double counts = parse_positive(text, option) * counts_per_unit;
  if (counts > 0.0 && std::isfinite(counts)) return counts;
  throw bad_argument(option, text, "not a finite number of counts above zero, a value nearer to 1 is accepted");
}

}  // namespace

void add_tick(CLI::App& app, TickOption& option) {
  add_value(app, "--tick", option.tick, "S", "period of the setpoints, seconds (default 0.001)");
}

double tick_of(const TickOption& option) { return parse_positive(option.tick, "--tick"); }

void add_shaper(CLI::App& app, ShaperOption& option) {
  add_values(
      app, "--shaper", option.specs, "SPEC",
      "TYPE:FREQUENCY:DAMPING[:key=value[,key=value]], frequency in Hz (natural), damping ratio; types: zv zvd zvdd "
      "zvddd mzv ei ei2 ei3 cv1 cv2 cv3 cv4 um-zv custom none; keys: v=TOLERANCE (humps, 0.05), spacing=PERIODS "
      "(mzv, 0.375), file=CSV (custom); several modes: joined by +, or the option repeated");
}

std::vector<sim::SpecifiedShaper> specs_of(const ShaperOption& option) {
  if (option.specs.empty()) {
    throw bad_argument("--shaper", "missing",
                       "a shaper is needed, `--shaper zv:11:0.11` or `--shaper none` is accepted");
  }
  std::vector<sim::SpecifiedShaper> all;
  for (const std::string& text : option.specs) {
    const std::vector<sim::SpecifiedShaper> specs = sim::parse_shapers(text);
    all.insert(all.end(), specs.begin(), specs.end());
  }
  return all;
}

void add_limits(CLI::App& app, LimitOptions& options) {
  add_value(app, "--velocity", options.velocity, "V", "velocity limit [unit/s]");
  add_value(app, "--acceleration", options.acceleration, "A", "acceleration limit [unit/s^2]");
  add_value(app, "--deceleration", options.deceleration, "D", "deceleration limit [unit/s^2] (default: acceleration)");
  add_value(app, "--jerk", options.jerk, "J",
            "jerk limit [unit/s^3]; all need it but the trapezoid and tables of order 1");
  add_value(app, "--deceleration-jerk", options.deceleration_jerk, "J",
            "jerk limit while slowing down [unit/s^3] (default: jerk)");
  add_value(app, "--counts-per-unit", options.counts_per_unit, "N", "drive counts a unit (default 1000000)");
}

AxisLimits limits_of(const LimitOptions& options) {
  const double unit = parse_positive(options.counts_per_unit, "--counts-per-unit");
  AxisLimits limits{};
  limits.velocity = in_counts(needed(options.velocity, "--velocity", "a velocity limit"), "--velocity", unit);
  limits.acceleration =
      in_counts(needed(options.acceleration, "--acceleration", "an acceleration limit"), "--acceleration", unit);
  limits.deceleration =
      options.deceleration.empty() ? limits.acceleration : in_counts(options.deceleration, "--deceleration", unit);
  limits.jerk = in_counts(needed(options.jerk, "--jerk", "a jerk limit"), "--jerk", unit);
  if (!options.deceleration_jerk.empty())
    limits.deceleration_jerk = in_counts(options.deceleration_jerk, "--deceleration-jerk", unit);
  return limits;
}

void add_move_options(CLI::App& app, MoveOptions& options) {
  add_value(app, "--distance", options.distance, "D", "signed distance to move [unit]");
  add_limits(app, options);
  add_value(
      app, "--kind", options.kind, "KIND",
      "s-curve, trapezoid, sin2, poly5, poly7, table:FILE (of `stillpoint table`) or matched:F:Z (an s-curve that "
      "leaves the mode of F Hz and damping ratio Z still) (default: s-curve if there is a jerk limit)");
  add_value(app, "--duration", options.duration, "T", "wanted duration [s] (default: the least the limits allow)");
  add_tick(app, options.tick);
}

sim::MoveTask task_of(const MoveOptions& options) {
  sim::MoveTask task{};
  task.tick_s = tick_of(options.tick);
  const double unit = parse_positive(options.counts_per_unit, "--counts-per-unit");
  task.counts_per_unit = unit;
  task.distance_counts = distance_counts(options, unit);
  task.profile = profile_of(options);
  // Kinds without a jerk limit do not look at it, but an axis wants to see one.
  MoveOptions limits = options;
  if (task.profile.jerk_limited()) {
    limits.jerk = needed(options.jerk, "--jerk", "a jerk limit for the " + profile_text(task.profile));
  } else if (options.jerk.empty()) {
    limits.jerk = "1";
  }
  task.limits = limits_of(limits);
  if (options.jerk.empty()) {
    task.limits.jerk = task.limits.acceleration / task.tick_s;
    task.limits.deceleration_jerk = 0.0;
  }
  if (!options.duration.empty()) task.duration_s = parse_positive(options.duration, "--duration");
  return task;
}

Settings settings_of(const sim::MoveTask& task) {
  const double unit = task.counts_per_unit;
  Settings settings = {
      {"distance", sim::shortest(task.distance_counts / unit) + " unit"},
      {"kind", profile_text(task.profile)},
      {"velocity limit", sim::shortest(task.limits.velocity / unit) + " unit/s"},
      {"acceleration limit", sim::shortest(task.limits.acceleration / unit) + " unit/s^2"},
      {"deceleration limit", sim::shortest(task.limits.deceleration / unit) + " unit/s^2"},
  };
  if (task.profile.jerk_limited()) {
    settings.emplace_back("jerk limit", sim::shortest(task.limits.jerk / unit) + " unit/s^3");
    if (task.limits.deceleration_jerk != 0.0)
      settings.emplace_back("deceleration jerk limit",
                            sim::shortest(task.limits.deceleration_jerk / unit) + " unit/s^3");
  }
  if (!task.from_rest()) {
    settings.emplace_back("start velocity", sim::shortest(task.start.velocity / unit) + " unit/s");
    settings.emplace_back("start acceleration", sim::shortest(task.start.acceleration / unit) + " unit/s^2");
  }
  settings.emplace_back("duration", task.duration_s > 0.0 ? sim::shortest(task.duration_s) + " s" : "least");
  settings.emplace_back("counts per unit", sim::shortest(unit));
  settings.emplace_back("tick", sim::shortest(task.tick_s) + " s");
  return settings;
}

}  // namespace stillpoint::cli
