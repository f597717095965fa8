// SPDX-License-Identifier: Apache-2.0
#include "shaper/tune/tune_plan.hpp"

#include "shaper/base/math.hpp"
#include "shaper/shaping/shaper_spec.hpp"

namespace stillpoint {

namespace {

constexpr double kHighestOfRate = 0.4;  // of the samples': room for the mean's roll-off
constexpr double kWantedPeriods = 4.0;
constexpr double kLeastPeriods = 3.0;
constexpr double kWindow = 0.1;       // seconds
constexpr double kPatience = 0.25;    // seconds
constexpr uint32_t kSensorLag = 3;    // ticks from the setpoint's rest to its being seen
constexpr double kMovesStill = 0.01;  // of the most it moved in a window
constexpr double kLeastCounts = 2.0;  // what an encoder flickers by
constexpr uint32_t kMostDecimation = 64;
constexpr double kApart = 0.1;  // steps of a sine, in the logarithm of the frequency

double counts_of(Signal signal) { return static_cast<double>(signal) / static_cast<double>(kSignalPerCount); }

Status check_choices(const TuneConfig& config) {
  const auto excitation = static_cast<uint32_t>(config.excitation);
  if (excitation >= kTuneExcitations)
    return refuse(Error::kAboveMaximum, Quantity::kKind, excitation, kTuneExcitations - 1.0);
  const auto source = static_cast<uint32_t>(config.source);
  if (source >= kTuneSources) return refuse(Error::kAboveMaximum, Quantity::kKind, source, kTuneSources - 1.0);
  return check_range(Quantity::kTolerance, config.tolerance, kMinTolerance, kMaxTolerance);
}

}  // namespace

Status plan_listening(double low_hz, double high_hz, double tick_s, uint32_t samples, ListenPlan& listen) {
  Status status = check_positive(Quantity::kFrequency, low_hz);
  if (status.ok()) status = check_range(Quantity::kFrequency, high_hz, low_hz, kHighestOfRate / tick_s);
  if (!status.ok()) return status;
  const double record_s = samples * tick_s;
  uint32_t decimation = 1;
  while (record_s * decimation * low_hz < kWantedPeriods && decimation < kMostDecimation &&
         high_hz * tick_s * 2.0 * decimation <= kHighestOfRate)
    decimation *= 2;
  if (record_s * decimation * low_hz < kLeastPeriods)
    return refuse(Error::kBelowMinimum, Quantity::kFrequency, low_hz, kLeastPeriods / (record_s * decimation));
  listen.rate_hz = 1.0 / (tick_s * decimation);
  const double window = kWindow / tick_s;
  const uint32_t most = samples / 2 * decimation;
  listen.window_ticks = window < 8.0 ? 8 : window < most ? static_cast<uint32_t>(window) : most;
  listen.patience_ticks = static_cast<uint32_t>(kPatience / tick_s);
  listen.samples = samples;
  listen.decimation = decimation;
  listen.pre_trigger = (listen.window_ticks - kSensorLag) / decimation - (decimation > 1 ? 1 : 0);
  return kOk;
}

namespace {

Status plan_move(AxisCore& axis, const TuneConfig& config, TunePlan& plan) {
  const Signal from = axis.state().setpoint;
  MoveReport report{};
  Move back = config.move;
  back.approach = Approach::kShortest;
  back.duration_s = 0.0;
  back.target_counts = axis.config().modulo_counts != 0 ? axis.reading_counts() : counts_from_signal(from);
  plan.home_counts = back.target_counts;
  Status status = axis.preview(back, plan.home, report);
  if (status.ok()) status = axis.preview(config.move, plan.target, report);
  if (!status.ok()) return status;
  const double distance = math::abs(counts_of(wrapping_difference(plan.target, from)));
  if (distance == 0.0) return refuse(Error::kNotPositive, Quantity::kDistance, 0.0);
  plan.announced = Announcement{distance, report.peaks.velocity, report.peaks.acceleration, report.peaks.jerk,
                                report.profile_ticks * axis.config().tick_s};
  return check_range(Quantity::kTravel, distance, 0.0, config.travel_counts);
}

// Excites without leading anywhere.
bool stays(const TuneConfig& config) { return config.excitation >= TuneExcitation::kBump; }

void cover(const Announcement& announced, Announcement& all) {
  all.travel = math::greater(all.travel, announced.travel);
  all.velocity = math::greater(all.velocity, announced.velocity);
  all.acceleration = math::greater(all.acceleration, announced.acceleration);
  all.jerk = math::greater(all.jerk, announced.jerk);
  all.duration_s = math::greater(all.duration_s, announced.duration_s);
}

// Up from home, or down where a soft limit is in the way; after the move from its target back, which keeps the travel.
Status plan_bump(AxisCore& axis, const TuneConfig& config, Excitation& bump, TunePlan& plan) {
  const bool only = stays(config);
  const Signal home = axis.state().setpoint;
  Signal from = home;
  bool forward = true;
  if (!only) {
    from = plan.target;
    forward = wrapping_difference(plan.target, home) < 0;
  }
  if (only && config.amplitude_counts > config.travel_counts)
    return refuse(Error::kAboveMaximum, Quantity::kTravel, config.amplitude_counts, config.travel_counts);
  Announcement announced{};
  const Status status = prepare_bump(axis, config, bump, announced);
  if (!status.ok()) return status;
  const AxisConfig& of_axis = axis.config();
  if (of_axis.has_soft_limits()) {
    const double at = counts_of(from);
    const double below = at - of_axis.soft_low_counts;
    const double above = of_axis.soft_high_counts - at;
    if (only && above < announced.travel) forward = false;
    const double room = forward ? above : below;
    if (room < announced.travel) return refuse(Error::kAboveMaximum, Quantity::kAmplitude, announced.travel, room);
  }
  plan.has_bump = true;
  plan.bump_forward = forward;
  cover(announced, plan.announced);
  return kOk;
}

// What excites, in order; kAuto can do without the bump.
Status plan_excitation(AxisCore& axis, const TuneConfig& config, Excitation& bump, TunePlan& plan) {
  if (stays(config)) {
    plan.home = axis.state().setpoint;
    const Status status = config.move.limits.validate();
    const Status within = status.ok() ? config.move.limits.within(axis.config().maximum) : status;
    return within.ok() ? plan_bump(axis, config, bump, plan) : within;
  }
  const Status status = plan_move(axis, config, plan);
  if (status.ok() && config.excitation == TuneExcitation::kAuto) static_cast<void>(plan_bump(axis, config, bump, plan));
  return status;
}

Status prepare(const AxisCore& axis, const TuneConfig& config, ExcitationKind kind, Excitation& excitation,
               Announcement& announced, const Meanwhile& meanwhile) {
  const AxisLimits& limits = config.move.limits;
  ExcitationConfig wanted{};
  wanted.kind = kind;
  wanted.tick_s = axis.config().tick_s;
  wanted.amplitude = config.amplitude_counts;
  wanted.travel = config.travel_counts;
  wanted.velocity = limits.velocity;
  wanted.acceleration = math::lesser(limits.acceleration, limits.deceleration);
  wanted.jerk = limits.jerk;
  wanted.low_hz = config.low_hz;
  wanted.high_hz = config.high_hz;
  wanted.steps = static_cast<uint32_t>(
      math::greater(kLeastSteps, math::lesser(kMostBins, math::log(config.high_hz / config.low_hz) / kApart + 2.0)));
  excitation = Excitation{};
  return excitation.prepare(wanted, announced, meanwhile);
}

}  // namespace

Status prepare_bump(const AxisCore& axis, const TuneConfig& config, Excitation& bump, Announcement& announced) {
  return prepare(axis, config, ExcitationKind::kBump, bump, announced, {});
}

Status prepare_sine(const AxisCore& axis, const TuneConfig& config, const TunePlan& plan, Excitation& sine,
                    Announcement& announced, const Meanwhile& meanwhile) {
  Announcement own{};
  const bool is_chirp = config.excitation == TuneExcitation::kChirp;
  const ExcitationKind kind = is_chirp ? ExcitationKind::kChirp : ExcitationKind::kSteppedSine;
  Status status = prepare(axis, config, kind, sine, own, meanwhile);
  if (!status.ok()) return status;
  const AxisConfig& of_axis = axis.config();
  const Signal from = axis.state().setpoint;
  const double away = math::abs(counts_of(wrapping_difference(from, plan.home)));
  status = check_range(Quantity::kTravel, away + own.travel, 0.0, config.travel_counts);
  if (status.ok() && of_axis.has_soft_limits()) {
    const double at = counts_of(from);
    const double room = math::lesser(at - of_axis.soft_low_counts, of_axis.soft_high_counts - at);
    if (room < own.travel) status = refuse(Error::kAboveMaximum, Quantity::kAmplitude, own.travel, room);
  }
  if (status.ok()) cover(own, announced);
  return status;
}

Status plan_tuning(AxisCore& axis, const TuneConfig& config, size_t samples, size_t memory, Excitation& excitation,
                   TunePlan& plan) {
  const double tick_s = axis.config().tick_s;
  size_t size = config.samples != 0 && config.samples < samples ? config.samples : samples;
  while (size > memory) size /= 2;
  if (size < kLeastTuneMemory)
    return refuse(Error::kLineTooShort, Quantity::kSamples, static_cast<double>(kLeastTuneMemory),
                  static_cast<double>(memory));
  TunePlan result{};
  Status status = check_choices(config);
  if (status.ok()) status = check_positive(Quantity::kTravel, config.travel_counts);
  if (status.ok())
    status = plan_listening(config.low_hz, config.high_hz, tick_s, static_cast<uint32_t>(size), result.listen);
  if (status.ok()) status = plan_excitation(axis, config, excitation, result);
  if (!status.ok()) return status;
  const double still = kMovesStill * result.announced.velocity * result.listen.window_ticks * tick_s;
  result.listen.tolerance =
      static_cast<Signal>((still > kLeastCounts ? still : kLeastCounts) * static_cast<double>(kSignalPerCount));
  if (config.excitation > TuneExcitation::kBump)
    status = prepare_sine(axis, config, result, excitation, result.announced);
  if (status.ok()) plan = result;
  return status;
}

}  // namespace stillpoint
