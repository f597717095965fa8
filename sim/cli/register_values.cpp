// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/register_values.hpp"

#include <cmath>

#include "firmware/default_axis.hpp"
#include "firmware/parameters.hpp"
#include "firmware/register_units.hpp"
#include "firmware/registers.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

using firmware::kBandPerHz;
using firmware::kDampingPerOne;
using firmware::kFrequencyPerHz;
using firmware::kResidualPerOne;
using firmware::kSpacingPerPeriod;

constexpr double kMsPerSecond = 1e3;
constexpr int16_t kTrapezoidType = 0;
constexpr int16_t kSin2Type = 1;
constexpr int16_t kSCurveType = 3;

// `value` in the register's unit; `shown` as the user gave it, in a unit of `per_shown` register units.
uint32_t to_register(const std::string& what, double value, double per_shown, double low, double high) {
  const double nearest = std::round(value);
  if (nearest >= low && nearest <= high) return static_cast<uint32_t>(nearest);
  throw sim::bad_argument(what, sim::shortest(value / per_shown),
                          "beyond the drive's register, " + sim::shortest(low / per_shown) + " to " +
                              sim::shortest(high / per_shown) + " is accepted");
}

int16_t type_of(const sim::SpecifiedProfile& profile) {
  switch (profile.kind) {
    case ProfileKind::kTrapezoid: return kTrapezoidType;
    case ProfileKind::kSin2: return kSin2Type;
    case ProfileKind::kSCurve: return kSCurveType;
    default:
      throw sim::bad_argument("--kind", profile_text(profile),
                              "not in the drive's register of profile types, s-curve, trapezoid and sin2 are accepted");
  }
}

sim::MoveTask rounded(const sim::MoveTask& task) {
  const MoveRegisters registers = registers_of(task);
  sim::MoveTask exact = task;
  exact.limits.velocity = registers.velocity;
  exact.limits.acceleration = registers.acceleration;
  exact.limits.deceleration = registers.deceleration;
  exact.limits.jerk = registers.jerk * firmware::kJerkUnit;
  exact.limits.deceleration_jerk = 0.0;
  exact.duration_s = registers.duration_ms / kMsPerSecond;
  return exact;
}

}  // namespace

MoveRegisters registers_of(const sim::MoveTask& task) {
  if (task.tick_s != firmware::kDefaultAxis.tick_s) {
    throw sim::bad_argument("--tick", sim::shortest(task.tick_s),
                            "not the firmware's, " + sim::shortest(firmware::kDefaultAxis.tick_s) + " is accepted");
  }
  constexpr double kMost = UINT32_MAX;
  const double unit = task.counts_per_unit;
  const double jerk = task.limits.jerk / firmware::kJerkUnit;
  MoveRegisters registers{};
  registers.target = task.distance_counts;
  registers.velocity = to_register("velocity", task.limits.velocity, unit, 1.0, kMost);
  registers.acceleration = to_register("acceleration", task.limits.acceleration, unit, 1.0, kMost);
  registers.deceleration = to_register("deceleration", task.limits.deceleration, unit, 1.0, kMost);
  registers.kind = type_of(task.profile);
  // The trapezoid takes no notice of its jerk; any will do.
  const bool trapezoid = registers.kind == kTrapezoidType;
  if (!trapezoid && task.limits.braking_jerk() != task.limits.jerk)
    throw sim::bad_argument("--deceleration-jerk", sim::shortest(task.limits.deceleration_jerk / unit),
                            "the drive has one register of jerk, that of --jerk is accepted");
  registers.jerk = trapezoid ? 1U : to_register("jerk", jerk, unit / firmware::kJerkUnit, 1.0, kMost);
  // A duration of nothing means the least; one asked for is not rounded to that.
  const double shortest_ms = task.duration_s > 0.0 ? 1.0 : 0.0;
  registers.duration_ms = to_register("duration", task.duration_s * kMsPerSecond, kMsPerSecond, shortest_ms, kMost);
  registers.zero_delay = task.zero_delay ? 1 : 0;
  return registers;
}

std::vector<ModeRegisters> registers_of(const std::vector<sim::SpecifiedShaper>& specs) {
  if (specs.size() > firmware::kMaxModes) {
    throw sim::bad_argument(
        "--shaper", std::to_string(specs.size()) + " modes",
        "more than the drive has registers for, at most " + std::to_string(firmware::kMaxModes) + " are accepted");
  }
  std::vector<ModeRegisters> all;
  for (const sim::SpecifiedShaper& spec : specs) {
    ModeRegisters mode{};
    mode.frequency = to_register("frequency", spec.mode.frequency_hz * kFrequencyPerHz, kFrequencyPerHz, 5000, 3000000);
    mode.damping = static_cast<uint16_t>(
        to_register("damping ratio", spec.mode.damping_ratio * kDampingPerOne, kDampingPerOne, 0, 30000));
    mode.tolerance =
        static_cast<uint16_t>(to_register("tolerance", spec.tolerance * kResidualPerOne, kResidualPerOne, 10, 2000));
    if (spec.kind == ShaperKind::kCustom)
      throw sim::bad_argument("--shaper", sim::spec_text(spec),
                              "a train that the drive has no registers for, the other types are accepted");
    mode.kind = static_cast<uint16_t>(spec.kind);
    mode.spacing =
        static_cast<uint16_t>(to_register("spacing", spec.spacing * kSpacingPerPeriod, kSpacingPerPeriod, 2500, 5000));
    all.push_back(mode);
  }
  return all;
}

TuneRegisters tune_registers_of(const sim::TuneTask& task) {
  constexpr double kMost = UINT32_MAX;
  const double unit = task.move.counts_per_unit;
  const bool by_move = task.excitation == TuneExcitation::kAuto || task.excitation == TuneExcitation::kMove;
  const double amplitude = by_move ? std::abs(static_cast<double>(task.move.distance_counts)) : task.amplitude_counts;
  const auto band = [](double hz) {
    return static_cast<uint16_t>(to_register("--band", hz * kBandPerHz, kBandPerHz, 1.0, UINT16_MAX));
  };
  TuneRegisters registers{};
  registers.excitation = static_cast<uint16_t>(task.excitation);
  registers.amplitude = to_register("--amplitude", amplitude, unit, 1.0, kMost);
  registers.travel = to_register("--travel", task.travel_counts, unit, 1.0, kMost);
  registers.band_low = band(task.low_hz);
  registers.band_high = band(task.high_hz);
  registers.source = static_cast<uint16_t>(task.source);
  registers.tolerance =
      static_cast<uint16_t>(to_register("--tolerance", task.tolerance * kResidualPerOne, kResidualPerOne, 10, 2000));
  registers.sensor_highest = sim::highest_reading(task.drive.accelerometer);
  registers.sensor_lowest = -registers.sensor_highest;
  return registers;
}

sim::SpecifiedShaper specified(const ModeRegisters& mode) {
  const Mode of{mode.frequency / kFrequencyPerHz, mode.damping / kDampingPerOne};
  sim::SpecifiedShaper spec = sim::shaper_spec(static_cast<ShaperKind>(mode.kind), of);
  // 0: left out.
  if (mode.tolerance != 0) spec.tolerance = mode.tolerance / kResidualPerOne;
  if (mode.spacing != 0) spec.spacing = mode.spacing / kSpacingPerPeriod;
  return spec;
}

std::vector<sim::SpecifiedShaper> specified(const std::vector<ModeRegisters>& modes) {
  std::vector<sim::SpecifiedShaper> specs;
  for (const ModeRegisters& mode : modes) specs.push_back(specified(mode));
  return specs;
}

void round_to_registers(sim::SpecifiedShaper& spec) {
  spec = specified(registers_of(std::vector<sim::SpecifiedShaper>{spec})[0]);
}

MoveJob rounded(const MoveJob& job) {
  MoveJob exact = job;
  exact.plain = rounded(job.plain);
  exact.shaped = rounded(job.shaped);
  static_cast<void>(registers_of(job.specs));  // there is room for as many
  for (sim::SpecifiedShaper& spec : exact.specs) round_to_registers(spec);
  exact.design = sim::design_for(exact.specs, exact.plain.tick_s);
  return exact;
}

}  // namespace stillpoint::cli
