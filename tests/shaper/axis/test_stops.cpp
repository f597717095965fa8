// SPDX-License-Identifier: Apache-2.0
// Quick stops of a whole axis, against the continuous optimum in closed form.
#include <cmath>
#include <memory>

#include "shaper/axis/axis.hpp"
#include "tests/shaper/profile/stop_time.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr double kTick = 1e-3;
constexpr double kLsb = 4294967296.0;
using TestAxis = Axis<512>;

double decades(Random& random, double low, double high) { return std::pow(10.0, random.between(low, high)); }

AxisLimits random_limits(Random& random) {
  const double velocity = decades(random, 3.0, 8.0);
  const double acceleration = velocity * decades(random, 0.0, 2.0);
  const double deceleration = acceleration * decades(random, -0.5, 0.5);
  return AxisLimits{velocity, acceleration, deceleration, acceleration * decades(random, 0.7, 3.5)};
}

ShaperDesign random_shaper(Random& random) {
  constexpr ShaperKind kKinds[] = {ShaperKind::kZv,  ShaperKind::kZvd, ShaperKind::kMzv, ShaperKind::kEi,
                                   ShaperKind::kEi2, ShaperKind::kCv1, ShaperKind::kCv2, ShaperKind::kUmZv};
  ShaperDesign design{};
  for (int64_t modes = random.integer(0, 2); modes > 0; --modes) {
    const Mode mode{random.between(10.0, 100.0), random.between(0.0, 0.2)};
    TEST_ASSERT_OK(add_shaper(kKinds[random.integer(0, 7)], mode, kTick, design));
  }
  return design;
}

// What leaves the axis, and what was promised of it since the stop.
class WatchedStop {
 public:
  // `outputs`: the last three, newest first
  WatchedStop(const Signal (&outputs)[3], const AxisConfig& config)
      : last_(outputs[0]),
        velocity_(outputs[0] - outputs[1]),
        acceleration_(velocity_ - (outputs[1] - outputs[2])),
        deceleration_(config.quick_stop_deceleration * kTick * kTick * kLsb),
        jerk_(config.quick_stop_jerk * kTick * kTick * kTick * kLsb),
        least_ticks(least_stop_ticks(outputs[0], outputs[1], outputs[2], static_cast<long double>(deceleration_),
                                     static_cast<long double>(jerk_))) {}

  void next(Signal output) {
    const int64_t velocity = output - last_;
    const int64_t acceleration = velocity - velocity_;
    const double jerk = static_cast<double>(acceleration) - static_cast<double>(acceleration_);
    TEST_ASSERT_AT_MOST_DOUBLE(jerk_ + 4.0, std::fabs(jerk));
    // Inside the acceleration limit; from outside it, let go at the jerk limit.
    const double before = std::fabs(static_cast<double>(acceleration_));
    const double allowed = before - jerk_ > deceleration_ ? before - jerk_ : deceleration_;
    TEST_ASSERT_AT_MOST_DOUBLE(allowed + 2.0, std::fabs(static_cast<double>(acceleration)));
    ++ticks_;
    if (velocity != 0) stood_after = ticks_;
    last_ = output;
    velocity_ = velocity;
    acceleration_ = acceleration;
  }

 private:
  Signal last_;
  int64_t velocity_;
  int64_t acceleration_;
  double deceleration_;
  double jerk_;
  long ticks_ = 0;

 public:
  long stood_after = 0;  // ticks from the request to the last change of the output
  long double least_ticks;
};

// Both do the move and emit the same.
void move_alike(TestAxis& axis, TestAxis& fresh, const Move& move) {
  TEST_ASSERT_OK(axis.command(move, nullptr));
  TEST_ASSERT_OK(fresh.command(move, nullptr));
  do {
    TEST_ASSERT_EQUAL_INT64(fresh.tick(), axis.tick());
  } while (fresh.state().phase != AxisPhase::kAtRest);
  TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kAtRest);
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(move.target_counts), axis.state().setpoint);
}

}  // namespace

TEST(ten_thousand_stops_stand_within_a_tick_of_the_least_time_and_leave_a_clean_line) {
  const uint64_t seed = 2026;
  TEST_INFO("seed", seed);
  Random random(seed);
  const auto axis = std::make_unique<TestAxis>();
  long double worst = -1e9L;
  int draining = 0;
  for (int i = 0; i < 10000; ++i) {
    TEST_INFO("case", i);
    // GIVEN an axis in a move, with quick-stop limits smaller than the move's or larger
    *axis = TestAxis{};
    const AxisLimits limits = random_limits(random);
    const AxisConfig config{kTick, limits, limits.deceleration * decades(random, -0.7, 1.0),
                            limits.jerk * decades(random, -1.0, 1.5)};
    TEST_ASSERT_OK(axis->configure(config));
    const ShaperDesign shaper = random_shaper(random);
    TEST_ASSERT_OK(axis->set_shaper(shaper));
    axis->tick();
    const double reach = std::fmin(limits.velocity * decades(random, -3.0, 0.3), 1e9);
    const auto target = static_cast<int32_t>(random.between(-reach, reach));
    const auto kind = random.next() % 4 == 0 ? ProfileKind::kTrapezoid : ProfileKind::kSCurve;
    MoveReport report{};
    TEST_ASSERT_OK(axis->command(Move{target, kind, limits, 0.0, false}, &report));
    if (report.total_ticks < 2) continue;
    const int64_t run = random.next() % 4 != 0 || report.profile_ticks + 2 > report.total_ticks
                            ? random.integer(1, report.total_ticks - 1)
                            : random.integer(report.profile_ticks, report.total_ticks - 1);
    Signal outputs[3] = {};
    for (int64_t tick = 0; tick < run; ++tick) {
      outputs[2] = outputs[1];
      outputs[1] = outputs[0];
      outputs[0] = axis->tick();
    }
    if (axis->state().phase == AxisPhase::kDraining) ++draining;

    // WHEN it is stopped, and at times stopped again on the way
    axis->request_stop();
    WatchedStop watched(outputs, config);
    const bool again = random.next() % 3 == 0;
    do {
      if (again && random.next() % 8 == 0) axis->request_stop();
      watched.next(axis->tick(random.next() % 2 == 0));
    } while (axis->state().phase != AxisPhase::kAtRest);

    // THEN it stands in time, for good
    TEST_INFO("ticks", watched.stood_after);
    const long double more = static_cast<long double>(watched.stood_after) - watched.least_ticks;
    TEST_ASSERT_AT_MOST_DOUBLE(1.0, more);
    if (more > worst) worst = more;
    TEST_ASSERT_EQUAL_INT64(axis->state().setpoint, axis->state().demand);
    const Signal stand = axis->state().setpoint;
    for (int tick = 0; tick < 3; ++tick) watched.next(axis->tick());
    TEST_ASSERT_EQUAL_INT64(stand, axis->state().setpoint);
    // AND a new move is that of an axis that never did another
    TestAxis fresh{};
    TEST_ASSERT_OK(fresh.configure(config));
    fresh.reset(stand);
    TEST_ASSERT_OK(fresh.set_shaper(shaper));
    fresh.tick();
    move_alike(*axis, fresh, Move{-target / 2, kind, limits, 0.0, false});
  }
  MESSAGE("most ticks above the continuous optimum: ", worst, "; stopped while draining: ", draining);
  TEST_ASSERT_AT_LEAST_INT64(1000, draining);
}
