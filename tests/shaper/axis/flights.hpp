// SPDX-License-Identifier: Apache-2.0
// Random commands at random moments of random motion, behind random shapers, each flight judged whole: at every tick,
// on every difference. The tests fly a few of them, flight_campaign as many as asked for.
#pragma once

#include <cmath>

#include "shaper/axis/axis.hpp"
#include "tests/shaper/profile/moving_stream_check.hpp"
#include "tests/support/random.hpp"

namespace stillpoint::testing {

constexpr double kFlightTick = 1e-3;
constexpr AxisLimits kFlightMaximum{1e9, 1e12, 1e12, 1e15};
// With more jerk than any motion here, so that letting go of an acceleration passes no velocity limit.
constexpr AxisLimits kFlightQuickStop{1.0, 1e9, 1e9, 1e12};

inline AxisLimits around(const AxisLimits& a, const AxisLimits& b) {
  return AxisLimits{std::fmax(a.velocity, b.velocity), std::fmax(a.acceleration, b.acceleration),
                    std::fmax(a.deceleration, b.deceleration), std::fmax(a.larger_jerk(), b.larger_jerk())};
}

// What the setpoints may do: all the limits since the profile was last inside those in force for as long as the shaper
// remembers.
class Watch {
 public:
  Watch(const AxisCore& axis, const AxisLimits& limits)
      : check(axis.state().setpoint, limits, kFlightTick, axis.shaper().stage_count),
        limits_(limits),
        allowed_(limits),
        length_(axis.shaper().length_ticks()),
        demand_(axis.state().demand) {}

  void change(const AxisLimits& limits) {
    allowed_ = around(forgotten() ? limits_ : allowed_, limits);
    limits_ = limits;
    check.change_limits(allowed_);
    inside_ = 0;
  }

  void next(const AxisState& state) {
    const double velocity = static_cast<double>(state.demand - demand_) / (4294967296.0 * kFlightTick);
    const double acceleration = (velocity - velocity_) / kFlightTick;
    const double jerk = (acceleration - acceleration_) / kFlightTick;
    demand_ = state.demand;
    velocity_ = velocity;
    acceleration_ = acceleration;
    const bool inside = std::fabs(velocity) <= limits_.velocity &&
                        std::fabs(acceleration) <= std::fmin(limits_.acceleration, limits_.deceleration) &&
                        std::fabs(jerk) <= std::fmin(limits_.jerk, limits_.braking_jerk()) * (1.0 + 1e-6) + 1.0;
    inside_ = inside ? inside_ + 1 : 0;
    check.change_limits(forgotten() ? limits_ : allowed_);
    check.next(state.setpoint);
  }

  MovingStreamCheck check;

 private:
  bool forgotten() const { return inside_ > length_ + 16; }

  AxisLimits limits_;
  AxisLimits allowed_;
  uint32_t length_;
  Signal demand_;
  double velocity_ = 0.0;
  double acceleration_ = 0.0;
  uint32_t inside_ = 0;
};

class RandomFlights {
 public:
  explicit RandomFlights(uint64_t seed) : random_(seed) {}

  // Ten commands, at rest and in flight, and a halt. What is wrong, or nullptr.
  const char* fly() {
    constexpr AxisConfig kConfig{kFlightTick, kFlightMaximum, kFlightQuickStop.deceleration, kFlightQuickStop.jerk};
    axis_.reset(0);
    axis_.tick();
    if (!axis_.configure(kConfig).ok()) return "not configured";
    axis_.reset(signal_from_counts(static_cast<int32_t>(random_.integer(-1000000, 1000000))));
    if (!shape()) return "not shaped";
    AxisLimits limits = random_limits();
    Watch watch(axis_, limits);
    for (int i = 0; i < 10; ++i) {
      // Half of them change the limits too.
      const AxisLimits next = random_.next() % 2 == 0 ? limits : random_limits();
      const bool moving = axis_.state().phase != AxisPhase::kAtRest;
      if (command(next)) {
        in_motion += moving;
        watch.change(next);
        limits = next;
      }
      run(random_.integer(1, 2000), watch, limits);
      if (!watch.check.within()) return "a limit is broken";
    }
    if (!axis_.halt(limits, nullptr).ok()) return "does not halt";
    for (int64_t ticks = 0; ticks < 10000000 && !standing(); ticks += 1) run(1, watch, limits);
    if (!watch.check.within()) return "a limit is broken at the halt";
    return standing() ? nullptr : "does not stand";
  }

  long in_motion = 0;      // commands accepted while the axis moved
  long stopped_ticks = 0;  // of quick stops that halts fell back on

 private:
  bool standing() const { return axis_.state().phase == AxisPhase::kAtRest && !axis_.pending(); }

  bool shape() {
    constexpr ShaperKind kKinds[] = {ShaperKind::kNone, ShaperKind::kZv, ShaperKind::kZvd, ShaperKind::kEi,
                                     ShaperKind::kUmZv};
    ShaperDesign design{};
    const ShaperKind kind = kKinds[random_.integer(0, 4)];
    const Mode mode{random_.between(5.0, 60.0), random_.between(0.0, 0.15)};
    if (kind != ShaperKind::kNone && !add_shaper(kind, mode, kFlightTick, design).ok()) return false;
    if (!axis_.set_shaper(design).ok()) return false;
    axis_.tick();
    return true;
  }

  AxisLimits random_limits() {
    const double velocity = std::pow(10.0, random_.between(3.0, 6.5));
    AxisLimits limits{velocity, velocity * random_.between(3.0, 50.0), velocity * random_.between(3.0, 50.0),
                      velocity * std::exp(random_.between(3.0, 9.0))};
    if (random_.next() % 2 == 0) limits.deceleration_jerk = limits.jerk * std::exp(random_.between(-2.0, 2.0));
    return limits;
  }

  // True if it was accepted.
  bool command(const AxisLimits& limits) {
    const double reach = limits.velocity * random_.between(0.001, 1.5);
    switch (random_.integer(0, 5)) {
      case 0: return axis_.halt(limits, nullptr).ok();
      case 1: return axis_.jog(limits.velocity * random_.between(-1.0, 1.0), limits, nullptr).ok();
      default: {
        const double here = static_cast<double>(axis_.state().demand) / 4294967296.0;
        const auto target = static_cast<int32_t>(here + reach * random_.between(-1.0, 1.0));
        constexpr ProfileKind kKinds[] = {ProfileKind::kSCurve, ProfileKind::kSCurve, ProfileKind::kSCurve,
                                          ProfileKind::kSin2,   ProfileKind::kPoly5,  ProfileKind::kPoly7};
        const ProfileKind kind = kKinds[random_.integer(0, 5)];
        return axis_.command(Move{target, kind, limits, 0.0, random_.next() % 8 == 0}, nullptr).ok();
      }
    }
  }

  void run(int64_t ticks, Watch& watch, const AxisLimits& limits) {
    for (int64_t tick = 0; tick < ticks; ++tick) {
      axis_.tick();
      const AxisState state = axis_.state();
      if (state.phase == AxisPhase::kStopping) watch.change(around(kFlightQuickStop, limits));
      watch.next(state);
      axis_.service();
      stopped_ticks += state.phase == AxisPhase::kStopping;
    }
  }

  Random random_;
  Axis<1024> axis_ = {};
};

}  // namespace stillpoint::testing
