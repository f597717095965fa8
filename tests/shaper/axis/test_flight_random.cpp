// SPDX-License-Identifier: Apache-2.0
// Random commands at random moments of random motion, behind random shapers. The limits are those in force and, until
// the shaper has forgotten them, those before; at every tick, on every difference.
#include <cmath>

#include "shaper/axis/axis.hpp"
#include "tests/shaper/profile/moving_stream_check.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::MovingStreamCheck;
using stillpoint::testing::Random;

namespace {

constexpr double kTick = 1e-3;
constexpr AxisLimits kMaximum{1e9, 1e12, 1e12, 1e15};
constexpr AxisLimits kQuickStop{1.0, 40e6, 40e6, 2e9};

struct RandomFlight {
  Axis<1024> axis = {};

  RandomFlight() { TEST_ASSERT_OK(axis.configure(AxisConfig{kTick, kMaximum, 40e6, 2e9})); }

  void shape(Random& random) {
    constexpr ShaperKind kKinds[] = {ShaperKind::kNone, ShaperKind::kZv, ShaperKind::kZvd, ShaperKind::kEi,
                                     ShaperKind::kUmZv};
    ShaperDesign design{};
    const ShaperKind kind = kKinds[random.integer(0, 4)];
    if (kind != ShaperKind::kNone) {
      TEST_ASSERT_OK(add_shaper(kind, Mode{random.between(5.0, 60.0), random.between(0.0, 0.15)}, kTick, design));
    }
    TEST_ASSERT_OK(axis.set_shaper(design));
    axis.tick();
  }

  static AxisLimits random_limits(Random& random) {
    const double velocity = std::pow(10.0, random.between(3.0, 6.5));
    return AxisLimits{velocity, velocity * random.between(3.0, 50.0), velocity * random.between(3.0, 50.0),
                      velocity * std::exp(random.between(3.0, 9.0))};
  }

  bool standing() const { return axis.state().phase == AxisPhase::kAtRest && !axis.pending(); }

  // One command; true if it was accepted.
  bool command(Random& random, const AxisLimits& limits) {
    const double reach = limits.velocity * random.between(0.001, 1.5);
    switch (random.integer(0, 5)) {
      case 0: return axis.halt(limits, nullptr).ok();
      case 1: return axis.jog(limits.velocity * random.between(-1.0, 1.0), limits, nullptr).ok();
      default: {
        const double here = static_cast<double>(axis.state().demand) / 4294967296.0;
        const auto target = static_cast<int32_t>(here + reach * random.between(-1.0, 1.0));
        return axis.command(Move{target, ProfileKind::kSCurve, limits, 0.0, random.next() % 8 == 0}, nullptr).ok();
      }
    }
  }
};

AxisLimits around(const AxisLimits& a, const AxisLimits& b) {
  return AxisLimits{std::fmax(a.velocity, b.velocity), std::fmax(a.acceleration, b.acceleration),
                    std::fmax(a.deceleration, b.deceleration), std::fmax(a.jerk, b.jerk)};
}

// What the setpoints may do: all the limits since the profile was last inside those in force for as long as the shaper
// remembers.
class Watch {
 public:
  Watch(const AxisCore& axis, const AxisLimits& limits)
      : check(axis.state().setpoint, limits, kTick, axis.shaper().stage_count),
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
    const double velocity = static_cast<double>(state.demand - demand_) / (4294967296.0 * kTick);
    const double acceleration = (velocity - velocity_) / kTick;
    const double jerk = (acceleration - acceleration_) / kTick;
    demand_ = state.demand;
    velocity_ = velocity;
    acceleration_ = acceleration;
    const bool inside = std::fabs(velocity) <= limits_.velocity &&
                        std::fabs(acceleration) <= std::fmin(limits_.acceleration, limits_.deceleration) &&
                        std::fabs(jerk) <= limits_.jerk * (1.0 + 1e-6) + 1.0;
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

}  // namespace

TEST_HOST_F(RandomFlight, two_thousand_flights_of_ten_commands_keep_every_limit) {
  const uint64_t seed = 20261125;
  TEST_INFO("seed", seed);
  Random random(seed);
  long in_motion = 0, stopped = 0;
  for (int flight = 0; flight < 2000; ++flight) {
    TEST_INFO("flight", flight);
    axis.reset(signal_from_counts(static_cast<int32_t>(random.integer(-1000000, 1000000))));
    shape(random);
    AxisLimits limits = random_limits(random);
    Watch watch(axis, limits);
    const auto run = [&](int64_t ticks, bool to_rest) {
      for (int64_t tick = 0; tick < ticks && !(to_rest && standing()); ++tick) {
        axis.tick();
        if (axis.state().phase == AxisPhase::kStopping) watch.change(around(kQuickStop, limits));
        watch.next(axis.state());
        axis.service();
        stopped += axis.state().phase == AxisPhase::kStopping;
      }
      TEST_INFO("velocity", watch.check.velocity_excess);
      TEST_INFO("acceleration", watch.check.acceleration_excess);
      TEST_INFO("jerk", watch.check.jerk_excess);
      TEST_INFO("stages", axis.shaper().stage_count);
      TEST_ASSERT_TRUE(watch.check.within());
    };
    for (int i = 0; i < 10; ++i) {
      TEST_INFO("command", i);
      // Half of them change the limits too.
      const AxisLimits next = random.next() % 2 == 0 ? limits : random_limits(random);
      const bool moving = axis.state().phase != AxisPhase::kAtRest;
      if (command(random, next)) {
        in_motion += moving;
        watch.change(next);
        limits = next;
      }
      run(random.integer(1, 2000), false);
    }
    TEST_ASSERT_OK(axis.halt(limits, nullptr));
    run(10000000, true);
    TEST_ASSERT_TRUE(standing());
  }
  TEST_INFO("commands in motion", in_motion);
  TEST_INFO("ticks of quick stops", stopped);
  TEST_ASSERT_AT_LEAST_INT64(5000, in_motion);
  TEST_ASSERT_AT_MOST_INT64(2000, stopped);
}
