// SPDX-License-Identifier: Apache-2.0
// A stop against two optima that know nothing of its rule: a search over all sequences of whole accelerations, and the
// continuous one in closed form.
#include <cstdlib>
#include <vector>

#include "shaper/profile/stop_ramp.hpp"
#include "tests/shaper/profile/stop_time.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

// Least number of ticks to rest from every velocity and acceleration of a small lattice, found backwards from rest.
class LatticeStops {
 public:
  LatticeStops(int deceleration, int jerk) : deceleration_(deceleration), jerk_(jerk) {
    std::vector<State> reached{{0, 0}};
    ticks_[index(reached[0])] = 0;
    for (size_t i = 0; i < reached.size(); ++i) {
      const State after = reached[i];
      for (int a = after.acceleration - jerk; a <= after.acceleration + jerk; ++a) {
        const State before{after.velocity - after.acceleration, a};
        if (!inside(before) || !allowed(a, after.acceleration) || ticks_[index(before)] >= 0) continue;
        ticks_[index(before)] = ticks_[index(after)] + 1;
        reached.push_back(before);
      }
    }
  }

  // -1: none without leaving the lattice
  int ticks(int velocity, int acceleration) const { return ticks_[index({velocity, acceleration})]; }

  static constexpr int kVelocity = 150;
  static constexpr int kAcceleration = 14;

 private:
  struct State {
    int velocity;
    int acceleration;
  };

  static bool inside(const State& s) {
    return std::abs(s.velocity) <= kVelocity && std::abs(s.acceleration) <= kAcceleration;
  }
  static size_t index(const State& s) {
    return static_cast<size_t>((s.velocity + kVelocity) * (2 * kAcceleration + 1) + s.acceleration + kAcceleration);
  }
  // From outside the limit it is let go at the jerk limit until it is inside.
  bool allowed(int from, int to) const {
    if (std::abs(from) > deceleration_ + jerk_) return to == (from > 0 ? from - jerk_ : from + jerk_);
    return std::abs(to) <= deceleration_;
  }

  int deceleration_;
  int jerk_;
  std::vector<int> ticks_ = std::vector<int>((2 * kVelocity + 1) * (2 * kAcceleration + 1), -1);
};

StopRamp moving(const StopLimits& limits, int64_t velocity, int64_t acceleration) {
  StopRamp ramp;
  ramp.start(limits, 0, -velocity, -velocity - (velocity - acceleration));
  return ramp;
}

}  // namespace

TEST(a_stop_takes_the_fewest_ticks_of_all_sequences_of_whole_accelerations) {
  long states = 0;
  for (int deceleration : {1, 2, 3, 5, 8, 13}) {
    for (int jerk : {1, 2, 3, 4, 7, 12}) {
      TEST_INFO("deceleration", deceleration);
      TEST_INFO("jerk", jerk);
      const LatticeStops lattice(deceleration, jerk);
      for (int velocity = -60; velocity <= 60; ++velocity) {
        for (int acceleration = -LatticeStops::kAcceleration; acceleration <= LatticeStops::kAcceleration;
             ++acceleration) {
          const int least = lattice.ticks(velocity, acceleration);
          if (least < 0) continue;
          StopRamp ramp = moving(StopLimits{deceleration, jerk}, velocity, acceleration);
          int ticks = 0;
          for (; !ramp.at_rest() && ticks < 1000; ++ticks) static_cast<void>(ramp.tick());
          TEST_INFO("velocity", velocity);
          TEST_INFO("acceleration", acceleration);
          TEST_ASSERT_EQUAL_INT32(least, ticks);
          ++states;
        }
      }
    }
  }
  TEST_ASSERT_AT_LEAST_INT64(100000, states);
}

TEST(a_stop_stands_within_a_tick_of_the_continuous_optimum_over_all_magnitudes) {
  const uint64_t seed = 20261125;
  TEST_INFO("seed", seed);
  Random random(seed);
  long double worst = -1e9L;
  int tried = 0;
  for (int i = 0; i < 100000; ++i) {
    TEST_INFO("case", i);
    const auto magnitude = [&random](double low, double high) {
      return static_cast<int64_t>(std::exp2(random.between(low, high)));
    };
    const auto sign = [&random] { return random.next() % 2 == 0 ? 1 : -1; };
    const StopLimits limits{magnitude(0.0, 50.0), magnitude(0.0, 50.0)};
    const int64_t velocity = sign() * magnitude(0.0, 60.0);
    const int64_t acceleration =
        sign() * static_cast<int64_t>(std::fmin(static_cast<double>(limits.deceleration) * random.between(0.0, 1.5),
                                                static_cast<double>(magnitude(0.0, 51.0))));
    const Signal before = wrapping_difference(0, velocity);
    const long double least =
        least_stop_ticks(0, before, wrapping_difference(before, velocity - acceleration),
                         static_cast<long double>(limits.deceleration), static_cast<long double>(limits.jerk));
    if (least > 20000) continue;
    ++tried;
    StopRamp ramp = moving(limits, velocity, acceleration);
    Signal last = 0;
    long standing = 0;  // since this tick
    for (long tick = 1; !ramp.at_rest() && tick < 30000; ++tick) {
      const Signal next = ramp.tick();
      if (next != last) standing = tick;
      last = next;
    }
    TEST_ASSERT_TRUE(ramp.at_rest());
    const long double more = static_cast<long double>(standing) - least;
    if (more > worst) worst = more;
    TEST_INFO("velocity", velocity);
    TEST_INFO("acceleration", acceleration);
    TEST_INFO("deceleration", limits.deceleration);
    TEST_INFO("jerk", limits.jerk);
    TEST_ASSERT_AT_MOST_DOUBLE(1.0, more);
  }
  MESSAGE("most ticks above the continuous optimum: ", worst, " in ", tried, " stops");
  TEST_ASSERT_AT_LEAST_INT64(20000, tried);
}
