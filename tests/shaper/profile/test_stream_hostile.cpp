// SPDX-License-Identifier: Apache-2.0
// No stream makes the limiter break a limit, and it comes back to its input in little more than the time of a plan.
#include <algorithm>
#include <vector>

#include "shaper/profile/plan_from.hpp"
#include "shaper/profile/track.hpp"
#include "tests/shaper/profile/limited_stream_rig.hpp"
#include "tests/shaper/profile/stop_time.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

// A tick of a stream that means no good.
class Hostile {
 public:
  Hostile(Random& random, const AxisLimits& limits)
      : random_(random), velocity_(lsb_per_tick(limits.velocity)), jerk_(made(limits).jerk / 4) {}

  Signal next(Signal last) {
    if (left_ == 0) {
      kind_ = static_cast<int>(random_.integer(0, 8));
      left_ = random_.integer(1, 400);
      step_ = static_cast<int64_t>(static_cast<double>(velocity_) * random_.between(-3.0, 3.0));
    }
    --left_;
    const auto noise = [this](int64_t size) { return random_.integer(-size, size); };
    switch (kind_) {
      case 0: return last;                                                   // a frozen master
      case 1: return wrapping_sum(last, step_);                              // a velocity out of nowhere
      case 2: return wrapping_sum(last, left_ % 50 == 0 ? 100 * step_ : 0);  // steps
      case 3: return wrapping_sum(last, left_ % 40 < 20 ? step_ : -step_);   // reversals
      case 4: return wrapping_sum(last, noise(8 * jerk_));                   // noise of a jerk
      case 5: return wrapping_sum(last, noise(velocity_));                   // noise of a velocity
      case 6: return static_cast<Signal>(random_.next());                    // anything
      case 7:
        return wrapping_sum(last,
                            left_ == 0 ? wrapping_sum(INT64_MIN, noise(velocity_)) : step_ / 4);  // half the range
      default: return left_ % 2 == 0 ? INT64_MAX : INT64_MIN;  // the ends of the range
    }
  }

 private:
  Random& random_;
  int64_t velocity_;
  int64_t jerk_;
  int kind_ = 0;
  int64_t left_ = 0;
  int64_t step_ = 0;
};

}  // namespace

TEST(no_stream_makes_it_break_a_limit) {
  const uint64_t seed = 305;
  TEST_INFO("seed", seed);
  Random random(seed);
  uint32_t limited = 0;
  for (int i = 0; i < 500; ++i) {
    TEST_INFO("case", i);
    const AxisLimits limits = random_limits(random, 1.0);
    Stream stream(limits, StreamPolicy::kClamp);
    Hostile hostile(random, limits);
    for (int tick = 0; tick < 2000; ++tick) {
      TEST_INFO("tick", tick);
      stream.step(hostile.next(stream.input));
    }
    limited += stream.limiter.limited_ticks();
  }
  TEST_ASSERT_AT_LEAST_INT64(500000, limited);
}

TEST(no_stream_leads_it_past_its_ends) {
  // GIVEN ends to stay between, sometimes too near for full speed WHEN the stream runs against them THEN none is passed
  // and every limit is kept; an input that stands on an end is reached
  const uint64_t seed = 307;
  TEST_INFO("seed", seed);
  Random random(seed);
  long at_ends = 0;
  for (int i = 0; i < 500; ++i) {
    TEST_INFO("case", i);
    const AxisLimits limits = random_limits(random, 1.0);
    const double room = limits.velocity * kLsb * decades(random, -3.0, 1.0);
    const Signal low = -static_cast<Signal>(room * random.unit()), high = static_cast<Signal>(room);
    Stream stream(limits, StreamPolicy::kClamp);
    stream.limiter.keep_between(low, high);
    Hostile hostile(random, limits);
    for (int tick = 0; tick < 2000; ++tick) {
      TEST_INFO("tick", tick);
      const Signal output = stream.step(hostile.next(stream.input));
      TEST_ASSERT_TRUE(low <= output && output <= high);
      at_ends += output == low || output == high;
    }
    const Signal end = i % 2 == 0 ? low : high;
    for (int tick = 0; tick < 200000 && stream.limiter.position() != end; ++tick) stream.step(end);
    stream.pass(end);
  }
  TEST_ASSERT_AT_LEAST_INT64(10000, at_ends);
}

TEST(limits_of_any_magnitude_are_kept) {
  const uint64_t seed = 311;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 1000; ++i) {
    TEST_INFO("case", i);
    const AxisLimits limits{decades(random, -6.0, 10.0), decades(random, -3.0, 13.0), decades(random, -3.0, 13.0),
                            decades(random, 0.0, 16.0)};
    Stream stream(limits, StreamPolicy::kClamp);
    Hostile hostile(random, limits);
    for (int tick = 0; tick < 500; ++tick) stream.step(hostile.next(stream.input));
  }
}

TEST(limits_of_a_few_lsb_are_kept_as_well) {
  const uint64_t seed = 306;
  TEST_INFO("seed", seed);
  Random random(seed);
  const double lsb = 1e3 / kLsb;  // of velocity, in counts/s
  for (int i = 0; i < 300; ++i) {
    TEST_INFO("case", i);
    const AxisLimits limits{lsb * decades(random, 0.0, 3.0), 1e3 * lsb * decades(random, 0.0, 2.0),
                            1e3 * lsb * decades(random, 0.0, 2.0), 1e6 * lsb * decades(random, 0.0, 2.0)};
    Stream stream(limits, StreamPolicy::kClamp);
    Hostile hostile(random, limits);
    for (int tick = 0; tick < 1000; ++tick) stream.step(hostile.next(stream.input));
    const Signal stand = wrapping_sum(stream.limiter.position(), 1000);
    for (int tick = 0; tick < 3000; ++tick) stream.step(stand);
    TEST_ASSERT_FALSE(stream.limiter.limiting());
  }
}

namespace {

struct Ratios {
  std::vector<double> all = {};
  double at(double share) {
    std::sort(all.begin(), all.end());
    return all[static_cast<size_t>(share * static_cast<double>(all.size() - 1))];
  }
};

constexpr long kMoreTicks = 8;

// The output's last three samples, and the input's velocity.
struct Pursuit {
  Stream& stream;
  AxisLimits limits;
  int64_t velocity;  // of the input, LSB/tick
  Signal outputs[3] = {};

  void step(Signal input) {
    outputs[2] = outputs[1];
    outputs[1] = outputs[0];
    outputs[0] = stream.step(input);
  }
  void step() { step(wrapping_sum(stream.input, velocity)); }

  // Ticks that a plan takes from the middle of the three samples on, where their central differences are the velocity
  // and acceleration: in the frame that moves with the input, and with the velocity that is left in the direction from
  // which the input is reached.
  double planned_ticks() const {
    const auto scaled = [](double lsb) { return lsb / kLsb / kTick; };
    const auto after = static_cast<double>(wrapping_difference(outputs[0], outputs[1]));
    const auto before = static_cast<double>(wrapping_difference(outputs[1], outputs[2]));
    const double input_velocity = scaled(static_cast<double>(velocity));
    const StartMotion start{scaled((after + before) / 2.0) - input_velocity, scaled(after - before) / kTick};
    const Signal input = wrapping_difference(stream.input, velocity);  // then
    const double distance = static_cast<double>(wrapping_difference(input, outputs[1])) / kLsb;
    Plan plan{};
    TEST_ASSERT_OK(plan_to_velocity(start, 0.0, limits, kTick, plan));
    AxisLimits relative = limits;
    relative.velocity -= distance > plan.distance ? input_velocity : -input_velocity;
    TEST_ASSERT_OK(plan_from(start, distance, relative, kTick, plan));
    return plan.optimum_ticks;
  }

  // Until the output is the input, for good.
  void reach(Ratios& ratios) {
    const double planned = planned_ticks();
    if (planned > 10000.0) return;
    long ticks = 1;  // since the middle
    while (stream.limiter.limiting()) {
      step();
      ++ticks;
      TEST_ASSERT_AT_MOST_DOUBLE(1.5 * planned + kMoreTicks, static_cast<double>(ticks));
    }
    for (int tick = 0; tick < 10; ++tick) stream.pass(wrapping_sum(stream.input, velocity));
    ratios.all.push_back(static_cast<double>(ticks - kMoreTicks) / std::fmax(planned, 1.0));
  }
};

void report(Ratios& ratios) {
  MESSAGE("time over the plan's, less ", kMoreTicks, " ticks: median ", ratios.at(0.5), ", 90 % ", ratios.at(0.9),
          ", 99 % ", ratios.at(0.99), ", worst ", ratios.at(1.0), " of ", ratios.all.size());
}

double random_distance(Random& random, const AxisLimits& limits) {
  return std::fmin(limits.velocity * decades(random, -5.0, 0.5), 1e9) * random.between(-1.0, 1.0);
}

}  // namespace

TEST(a_step_is_caught_up_with_in_little_more_than_the_time_of_a_plan) {
  const uint64_t seed = 307;
  TEST_INFO("seed", seed);
  Random random(seed);
  Ratios standing, moving;
  for (int i = 0; i < 20000; ++i) {
    TEST_INFO("case", i);
    // GIVEN an output in motion WHEN the input jumps, and stands or goes on at a velocity (limits symmetric, for in its
    // frame braking may be either), THEN it is caught up with within 1.5 times the time of a plan and a few ticks. It
    // takes two ticks to see that the jump is not a velocity.
    const bool stands = i % 2 == 0;
    const AxisLimits limits = random_limits(random, stands ? 0.5 : 0.0);
    Stream stream(limits, StreamPolicy::kClamp, lsb_per_tick(limits.velocity * random.between(-1.0, 1.0)));
    Pursuit pursuit{stream, limits, stands ? 0 : lsb_per_tick(limits.velocity * random.between(-0.9, 0.9))};
    stream.input = static_cast<Signal>(random_distance(random, limits) * kLsb);
    for (int tick = 0; tick < 3; ++tick) pursuit.step();
    pursuit.reach(stands ? standing : moving);
  }
  report(standing);
  report(moving);
}

TEST(after_any_stream_a_standing_input_is_reached_and_kept) {
  const uint64_t seed = 309;
  TEST_INFO("seed", seed);
  Random random(seed);
  Ratios ratios;
  for (int i = 0; i < 2000; ++i) {
    TEST_INFO("case", i);
    const AxisLimits limits = random_limits(random, 0.5);
    Stream stream(limits, StreamPolicy::kClamp);
    Hostile hostile(random, limits);
    Pursuit pursuit{stream, limits, 0};
    for (int64_t tick = random.integer(1, 500); tick > 0; --tick) pursuit.step(hostile.next(stream.input));
    stream.input = wrapping_sum(pursuit.outputs[0], static_cast<Signal>(random_distance(random, limits) * kLsb));
    for (int tick = 0; tick < 3; ++tick) pursuit.step();
    pursuit.reach(ratios);
  }
  report(ratios);
}

TEST(a_standing_input_is_passed_by_no_more_than_a_stop_at_once_passes_it) {
  const uint64_t seed = 308;
  TEST_INFO("seed", seed);
  Random random(seed);
  double worst = 0.0;
  for (int i = 0; i < 10000; ++i) {
    TEST_INFO("case", i);
    const AxisLimits limits = random_limits(random, 0.5);
    const double velocity = i % 2 == 0 ? 0.0 : limits.velocity * random.between(-1.0, 1.0);
    Stream stream(limits, StreamPolicy::kClamp, lsb_per_tick(velocity));
    const double distance = random_distance(random, limits);
    const double side = distance < 0 ? -1.0 : 1.0;
    // In the first tick the jump may be taken for a velocity, and sped up towards. A stop from there:
    const double first = side * std::fmin(std::fmin(limits.jerk * kTick, limits.acceleration),
                                          std::fmax(limits.velocity - side * velocity, 0.0) / kTick);
    const StartMotion start{velocity + first * kTick, first};
    Plan stop{};
    TEST_ASSERT_OK(plan_to_velocity(start, 0.0, limits, kTick, stop));
    const double leads_to = start.velocity * kTick + stop.distance;
    const double jerk = limits.jerk * kTick * kTick * kTick;
    const double forced = std::fmax((leads_to - distance) * side, 0.0);
    const auto target = static_cast<Signal>(distance * kLsb);
    double passed = 0.0;
    for (int tick = 0; tick < 3000 && (tick < 3 || stream.limiter.limiting()); ++tick) {
      stream.step(target);
      const double beyond = static_cast<double>(stream.limiter.position() - target) / kLsb * side;
      passed = std::fmax(passed, beyond);
    }
    worst = std::fmax(worst, (passed - 2.0 * jerk) / std::fmax(forced, jerk));
    TEST_ASSERT_AT_MOST_DOUBLE(forced + 2.0 * jerk, passed);
  }
  MESSAGE("passed by, less 2 jerks, over what a stop passes by: at most ", worst);
}

TEST(a_fault_follows_to_the_tick_before_and_then_stops_in_the_least_time) {
  const uint64_t seed = 310;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 2000; ++i) {
    TEST_INFO("case", i);
    const AxisLimits limits = random_limits(random, 0.5);
    Stream stream(limits, StreamPolicy::kFault);
    Plan plan{};
    const auto distance = static_cast<int32_t>(std::fmin(limits.velocity * random.between(0.01, 1.0), 1e9));
    TEST_ASSERT_OK(plan_rest_to_rest(distance, limits, ProfileKind::kSCurve, kTick, plan));
    if (plan.duration_ticks > 5000) continue;
    Track track{};
    Track::make(plan, 0, signal_from_counts(distance), track);
    Sampler sampler;
    sampler.begin(track);
    Signal outputs[3] = {};
    for (int64_t tick = random.integer(1, plan.duration_ticks); tick > 0; --tick) {
      outputs[2] = outputs[1];
      outputs[1] = outputs[0];
      stream.pass(sampler.tick());
      outputs[0] = stream.input;
    }
    TEST_ASSERT_FALSE(stream.limiter.faulted());
    // more than a tick can bridge
    const StreamLimits in_lsb = made(limits);
    const double least = static_cast<double>(least_stop_ticks(outputs[0], outputs[1], outputs[2],
                                                              limits.deceleration * kTick * kTick * kLsb,
                                                              limits.jerk * kTick * kTick * kTick * kLsb));
    Signal input = outputs[0] + 2 * in_lsb.velocity;
    long stood_after = 0;
    for (long tick = 1; tick == 1 || !stream.limiter.at_rest(); ++tick) {
      const Signal output = stream.step(input);
      TEST_ASSERT_TRUE(stream.limiter.faulted());
      if (output != outputs[0]) stood_after = tick;
      outputs[0] = output;
      input = static_cast<Signal>(random.next());
    }
    TEST_ASSERT_AT_MOST_DOUBLE(least + 1.0, static_cast<double>(stood_after));
    for (int tick = 0; tick < 5; ++tick) TEST_ASSERT_EQUAL_INT64(outputs[0], stream.step(outputs[0]));
    TEST_ASSERT_TRUE(stream.limiter.faulted());
  }
}
