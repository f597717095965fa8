// SPDX-License-Identifier: Apache-2.0
// Motion that is changed while it lasts: another target, other limits, a velocity, a halt.
#include "shaper/axis/axis.hpp"
#include "tests/shaper/profile/moving_stream_check.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using stillpoint::testing::MovingStreamCheck;
using stillpoint::testing::Random;

namespace {

constexpr double kTick = 1e-3;
constexpr AxisLimits kMaximum{2e6, 40e6, 40e6, 2e9};
constexpr AxisLimits kLimits{1.2e6, 20e6, 12e6, 600e6};
constexpr AxisLimits kGentle{0.3e6, 5e6, 4e6, 100e6};

struct Flying {
  Axis<512> axis = {};

  Flying() { configure(AxisConfig{kTick, kMaximum, 40e6, 2e9}); }

  void configure(const AxisConfig& config) { TEST_ASSERT_OK(axis.configure(config)); }

  void shape(ShaperKind kind) {
    ShaperDesign design{};
    TEST_ASSERT_OK(add_shaper(kind, Mode{11.0, 0.11}, kTick, design));
    TEST_ASSERT_OK(axis.set_shaper(design));
    axis.tick();
  }

  static Move to(int32_t target, const AxisLimits& limits = kLimits) {
    return Move{target, ProfileKind::kSCurve, limits, 0.0, false};
  }

  void run(uint32_t ticks, MovingStreamCheck* check = nullptr) {
    for (uint32_t i = 0; i < ticks; ++i) {
      const Signal setpoint = axis.tick();
      if (check != nullptr) check->next(setpoint);
    }
  }

  uint32_t run_to_rest(MovingStreamCheck* check = nullptr, uint32_t give_up = 100000) {
    uint32_t ticks = 0;
    do {
      run(1, check);
    } while ((axis.state().phase != AxisPhase::kAtRest || axis.pending()) && ++ticks < give_up);
    return ticks + 1;
  }
};

}  // namespace

TEST_F(Flying, another_target_is_gone_to_at_once_and_to_the_last_bit) {
  TEST_ASSERT_OK(axis.command(to(1700000), nullptr));
  MovingStreamCheck check(0, kLimits, kTick);
  run(700, &check);
  MoveReport report{};
  TEST_ASSERT_OK(axis.command(to(-300000), &report));
  TEST_ASSERT_TRUE(axis.pending());
  TEST_ASSERT_REFUSED(kBusy, kNone, axis.command(to(5), nullptr));
  const uint32_t ticks = run_to_rest(&check);
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(-300000), axis.state().setpoint);
  TEST_ASSERT_TRUE(check.within());
  // The profile takes over four ticks from now.
  TEST_ASSERT_EQUAL_UINT32(report.total_ticks + 4, ticks);
}

TEST_F(Flying, until_it_takes_over_the_motion_in_force_goes_on_bit_for_bit) {
  Axis<512> other = {};
  TEST_ASSERT_OK(other.configure(axis.config()));
  TEST_ASSERT_OK(axis.command(to(1700000), nullptr));
  TEST_ASSERT_OK(other.command(to(1700000), nullptr));
  for (int i = 0; i < 300; ++i) TEST_ASSERT_EQUAL_INT64(other.tick(), axis.tick());
  TEST_ASSERT_OK(axis.command(to(1000000), nullptr));
  for (int i = 0; i < 4; ++i) TEST_ASSERT_EQUAL_INT64(other.tick(), axis.tick());
  TEST_ASSERT_TRUE(other.tick() != axis.tick());
}

TEST_F(Flying, lower_limits_are_come_down_to_without_a_dip) {
  // GIVEN a cruise WHEN the limits fall THEN the velocity falls to the new one, never below it before it brakes
  TEST_ASSERT_OK(axis.command(to(1700000), nullptr));
  run(600);
  TEST_ASSERT_OK(axis.command(to(1700000, kGentle), nullptr));
  Signal last = axis.state().setpoint;
  const Signal gentle = static_cast<Signal>(kGentle.velocity * kTick * 4294967296.0);
  bool down = false;
  Signal slowest = INT64_MAX;
  while (signal_from_counts(1700000) - last > signal_from_counts(200000)) {
    const Signal next = axis.tick();
    const Signal velocity = next - last;
    down = down || velocity <= gentle + 1;
    if (velocity < slowest) slowest = velocity;
    if (down) TEST_ASSERT_AT_MOST_INT64(gentle + 1, velocity);
    last = next;
  }
  TEST_ASSERT_TRUE(down);
  TEST_ASSERT_AT_LEAST_INT64(gentle - 1 - gentle / 1000000, slowest);
  run_to_rest();
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1700000), axis.state().setpoint);
}

TEST_F(Flying, a_jog_keeps_its_velocity_and_wraps_at_the_end_of_the_range) {
  shape(ShaperKind::kZvd);
  const Signal begin = signal_from_counts(INT32_MAX - 200000);
  axis.reset(begin);
  MoveReport report{};
  TEST_ASSERT_OK(axis.jog(1e6, kLimits, &report));
  MovingStreamCheck check(begin, kLimits, kTick, 2);
  run(report.total_ticks, &check);
  const Signal velocity = signal_from_counts(1000);
  Signal last = axis.state().setpoint;
  for (int i = 0; i < 1000; ++i) {
    const Signal next = axis.tick();
    check.next(next);
    TEST_ASSERT_EQUAL_INT64(velocity, wrapping_difference(next, last));
    last = next;
  }
  TEST_ASSERT_TRUE(last < 0);
  TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kMoving);
  TEST_ASSERT_OK(axis.jog(-0.5e6, kLimits, nullptr));
  run(600, &check);
  TEST_ASSERT_OK(axis.halt(kLimits, &report));
  TEST_ASSERT_EQUAL_UINT32(report.total_ticks + 4, run_to_rest(&check));
  TEST_ASSERT_TRUE(check.within());
  TEST_ASSERT_OK(axis.command(to(INT32_MIN), nullptr));
  run_to_rest();
  TEST_ASSERT_EQUAL_INT64(INT64_MIN, axis.state().setpoint);
}

TEST_F(Flying, a_year_of_cruise_is_counted_exactly) {
  // GIVEN a track that cruises WHEN it is asked for a tick beyond 2^32 THEN the end has gone on by as many steps
  Plan plan{};
  TEST_ASSERT_OK(plan_to_velocity(StartMotion{0.0, 0.0}, 1e6, kLimits, kTick, plan));
  Track track{};
  Track::make_cruise(plan, standing(0), 1000.0, track);
  uint32_t unused = 0;
  const uint64_t ticks = UINT64_C(31536000000);
  const Differences far = track.differences_at(track.duration_ticks + ticks, unused);
  const auto travel = static_cast<Signal>(ticks * 1000U % (UINT64_C(1) << 32) << 32);
  TEST_ASSERT_EQUAL_INT64(wrapping_sum(signal_of(track.end), travel), signal_of(far));
}

TEST_F(Flying, a_halt_ramps_before_the_shaper_and_so_stands_still) {
  // GIVEN a shaped move WHEN it is halted THEN the setpoint is the shaper's answer to a profile that came to rest by
  // its limits, and ends the shaper's length after it
  shape(ShaperKind::kZv);
  LineSample memory[512] = {};
  Shaper shaper = {};
  TEST_ASSERT_OK(shaper.configure(axis.shaper(), memory, 512, 0));
  TEST_ASSERT_OK(axis.command(to(1700000), nullptr));
  MovingStreamCheck demand(0, kLimits, kTick);
  uint32_t profile = 0, total = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    if (tick == 500) TEST_ASSERT_OK(axis.halt(kLimits, nullptr));
    const Signal before = axis.state().demand;
    const Signal setpoint = axis.state().setpoint;
    axis.tick();
    demand.next(axis.state().demand);
    if (axis.state().demand != before) profile = static_cast<uint32_t>(tick);
    if (axis.state().setpoint != setpoint) total = static_cast<uint32_t>(tick);
    TEST_ASSERT_EQUAL_INT64(shaper.tick(axis.state().demand), axis.state().setpoint);
  }
  TEST_ASSERT_TRUE(demand.within());
  TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kAtRest);
  TEST_ASSERT_EQUAL_UINT32(profile + axis.shaper().length_ticks(), total);
  TEST_ASSERT_OK(axis.command(to(-5), nullptr));
  run_to_rest();
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(-5), axis.state().setpoint);
}

TEST_F(Flying, a_halt_at_rest_and_before_a_move_has_begun_drops_what_waits) {
  TEST_ASSERT_OK(axis.halt(kLimits, nullptr));
  TEST_ASSERT_OK(axis.command(to(1000), nullptr));
  TEST_ASSERT_OK(axis.halt(kLimits, nullptr));
  TEST_ASSERT_FALSE(axis.pending());
  for (int i = 0; i < 10; ++i) TEST_ASSERT_EQUAL_INT64(0, axis.tick());
}

TEST_F(Flying, a_new_move_need_not_wait_until_the_line_has_drained) {
  shape(ShaperKind::kZvd);
  MoveReport report{};
  TEST_ASSERT_OK(axis.command(to(100000), &report));
  MovingStreamCheck check(0, kLimits, kTick, 2);
  run(report.profile_ticks + 10, &check);
  TEST_ASSERT_TRUE(axis.state().phase == AxisPhase::kDraining);
  TEST_ASSERT_REFUSED(kBusy, kNone, axis.command(Move{0, ProfileKind::kSCurve, kLimits, 3.0, false}, nullptr));
  TEST_ASSERT_OK(axis.command(to(0), nullptr));
  run_to_rest(&check);
  TEST_ASSERT_TRUE(check.within());
  TEST_ASSERT_EQUAL_INT64(0, axis.state().setpoint);
}

TEST_F(Flying, what_the_tick_misses_is_planned_again) {
  // GIVEN a drive that withholds its commit past the tick of the hand-over WHEN it is serviced THEN the new target is
  // planned from further on
  TEST_ASSERT_OK(axis.command(to(1700000), nullptr));
  MovingStreamCheck check(0, kLimits, kTick);
  run(400, &check);
  TEST_ASSERT_OK(axis.command(to(500000), nullptr));
  for (int i = 0; i < 50; ++i) check.next(axis.tick(false));
  TEST_ASSERT_TRUE(axis.pending());
  axis.service();
  run(20, &check);
  TEST_ASSERT_FALSE(axis.pending());
  run_to_rest(&check);
  TEST_ASSERT_TRUE(check.within());
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(500000), axis.state().setpoint);
}

TEST_F(Flying, a_commit_before_its_tick_is_enough) {
  TEST_ASSERT_OK(axis.command(to(1700000), nullptr));
  run(400);
  TEST_ASSERT_OK(axis.command(to(500000), nullptr));
  axis.tick(true);
  for (int i = 0; i < 10; ++i) axis.tick(false);
  TEST_ASSERT_FALSE(axis.pending());
  run_to_rest();
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(500000), axis.state().setpoint);
}

TEST_F(Flying, a_stop_drops_what_waits_in_flight) {
  TEST_ASSERT_OK(axis.command(to(1700000), nullptr));
  run(400);
  TEST_ASSERT_OK(axis.command(to(-500000), nullptr));
  axis.request_stop();
  run_to_rest();
  const Signal stands = axis.state().setpoint;
  TEST_ASSERT_FALSE(axis.pending());
  for (int i = 0; i < 200; ++i) TEST_ASSERT_EQUAL_INT64(stands, axis.tick());
  axis.request_stop();
  TEST_ASSERT_OK(axis.command(to(0), nullptr));
  run_to_rest();
}

TEST_F(Flying, a_jog_or_halt_with_bad_numbers_is_refused_by_name) {
  Axis<512> raw = {};
  TEST_ASSERT_REFUSED(kNotAvailable, kNone, raw.jog(1.0, kLimits, nullptr));
  TEST_ASSERT_REFUSED(kNotAvailable, kNone, raw.halt(kLimits, nullptr));
  TEST_ASSERT_REFUSED(kNotFinite, kVelocity, axis.jog(__builtin_nan(""), kLimits, nullptr));
  const Status fast = axis.jog(-1.3e6, kLimits, nullptr);
  TEST_ASSERT_REFUSED(kAboveMaximum, kVelocity, fast);
  TEST_ASSERT_DOUBLE_WITHIN(0, 1.2e6, fast.accepted);
  TEST_ASSERT_REFUSED(kAboveMaximum, kJerk, axis.jog(1.0, {1, 1, 1, 3e9}, nullptr));
  TEST_ASSERT_REFUSED(kNotPositive, kJerk, axis.halt({1, 1, 1, 0}, nullptr));
  TEST_ASSERT_FALSE(axis.pending());
}

TEST_F(Flying, a_shaper_changes_in_the_cruise_of_a_jog) {
  shape(ShaperKind::kZv);
  TEST_ASSERT_OK(axis.jog(1e6, kLimits, nullptr));
  MovingStreamCheck check(0, kLimits, kTick, 4);
  run(500, &check);
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(ShaperKind::kZvd, Mode{15.0, 0.05}, kTick, design));
  TEST_ASSERT_OK(axis.set_shaper(design, Retune::kBlended));
  run(3000, &check);
  TEST_ASSERT_FALSE(axis.pending());
  TEST_ASSERT_EQUAL_UINT32(2, axis.shaper().stage_count);
  TEST_ASSERT_OK(axis.halt(kLimits, nullptr));
  run_to_rest(&check);
  TEST_ASSERT_TRUE(check.within());
}

TEST_F(Flying, the_same_flights_give_the_same_bits_everywhere) {
  // GIVEN commands of every kind in flight WHEN the setpoints are hashed (FNV-1a) THEN every machine prints this number
  shape(ShaperKind::kZvd);
  uint64_t hash = UINT64_C(0xcbf29ce484222325);
  for (int i = 0; i < 8; ++i) {
    switch (i) {
      case 2: TEST_ASSERT_OK(axis.jog(-0.7e6, kLimits, nullptr)); break;
      case 4: TEST_ASSERT_OK(axis.command(to(-5, kGentle), nullptr)); break;
      case 5: TEST_ASSERT_OK(axis.jog(1.1e6, kLimits, nullptr)); break;
      case 7: TEST_ASSERT_OK(axis.halt(kGentle, nullptr)); break;
      default: TEST_ASSERT_OK(axis.command(to(i % 2 == 0 ? 1700000 : -33333), nullptr)); break;
    }
    for (int tick = 0; tick < 100 + 37 * i; ++tick) {
      uint64_t bits = static_cast<uint64_t>(axis.tick());
      for (int byte = 0; byte < 8; ++byte, bits >>= 8) hash = (hash ^ (bits & 0xFF)) * UINT64_C(0x100000001b3);
    }
  }
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(13314076089814778931), hash);
}

struct Fenced : Flying {
  Fenced() {
    AxisConfig config = axis.config();
    config.soft_low_counts = -100000;
    config.soft_high_counts = 900000;
    configure(config);
  }
};

TEST_F(Fenced, a_target_beyond_a_soft_limit_is_refused_before_anything_starts) {
  const Status above = axis.command(to(900001), nullptr);
  TEST_ASSERT_REFUSED(kAboveMaximum, kPosition, above);
  TEST_ASSERT_DOUBLE_WITHIN(0, 900000, above.accepted);
  TEST_ASSERT_REFUSED(kBelowMinimum, kPosition, axis.command(to(-100001), nullptr));
  TEST_ASSERT_OK(axis.command(to(900000), nullptr));
  run(500);
  TEST_ASSERT_REFUSED(kAboveMaximum, kPosition, axis.command(to(900001), nullptr));
  run_to_rest();
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(900000), axis.state().setpoint);
}

TEST_F(Fenced, a_path_that_would_swing_out_past_a_soft_limit_is_refused) {
  // GIVEN a move that brakes onto the limit WHEN weaker brakes are asked for THEN the path would lead past it
  TEST_ASSERT_OK(axis.command(to(900000), nullptr));
  run(800);
  TEST_ASSERT_REFUSED(kAboveMaximum, kPosition, axis.command(to(0, kGentle), nullptr));
  TEST_ASSERT_OK(axis.command(to(0), nullptr));
  MovingStreamCheck check(axis.state().setpoint, kLimits, kTick);
  Signal highest = INT64_MIN;
  for (int i = 0; i < 2000; ++i) {
    const Signal next = axis.tick();
    if (next > highest) highest = next;
  }
  TEST_ASSERT_AT_MOST_INT64(signal_from_counts(900000), highest);
  TEST_ASSERT_EQUAL_INT64(0, axis.state().setpoint);
}

TEST_F(Fenced, a_jog_stands_on_the_soft_limit_in_time) {
  shape(ShaperKind::kZv);
  TEST_ASSERT_OK(axis.jog(1e6, kLimits, nullptr));
  MovingStreamCheck check(0, kLimits, kTick, 1);
  run_to_rest(&check);
  TEST_ASSERT_TRUE(check.within());
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(900000), axis.state().setpoint);
  TEST_ASSERT_REFUSED(kAboveMaximum, kPosition, axis.jog(1e6, kLimits, nullptr));
  TEST_ASSERT_OK(axis.jog(-1e6, kLimits, nullptr));
  run_to_rest();
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(-100000), axis.state().setpoint);
}

TEST_F(Fenced, from_outside_the_soft_limits_only_what_leads_back_is_accepted) {
  axis.reset(signal_from_counts(1000000));
  TEST_ASSERT_REFUSED(kAboveMaximum, kPosition, axis.command(to(950000), nullptr));
  TEST_ASSERT_REFUSED(kAboveMaximum, kPosition, axis.jog(1e6, kLimits, nullptr));
  TEST_ASSERT_OK(axis.command(to(0), nullptr));
  run(100);
  TEST_ASSERT_OK(axis.command(to(-1), nullptr));
  run_to_rest();
}

TEST_F(Fenced, a_halt_with_weak_brakes_still_keeps_the_soft_limit) {
  TEST_ASSERT_OK(axis.command(to(900000), nullptr));
  run(800);
  TEST_ASSERT_OK(axis.halt(kGentle, nullptr));
  run_to_rest();
  TEST_ASSERT_AT_MOST_INT64(signal_from_counts(900000), axis.state().setpoint);
}

struct Rotary : Flying {
  static constexpr int32_t kTurn = 36007;

  Rotary() {
    AxisConfig config = axis.config();
    config.modulo_counts = kTurn;
    configure(config);
  }

  static Move to(int32_t target, Approach approach = Approach::kShortest) {
    Move move = Flying::to(target);
    move.approach = approach;
    return move;
  }

  void arrives(int32_t reading, Signal at) {
    run_to_rest();
    TEST_ASSERT_EQUAL_INT32(reading, axis.reading_counts());
    TEST_ASSERT_EQUAL_INT64(at, axis.state().setpoint);
  }
};

TEST_F(Rotary, a_target_is_approached_the_way_that_was_asked_for) {
  TEST_ASSERT_OK(axis.command(to(36000), nullptr));
  arrives(36000, signal_from_counts(-7));
  TEST_ASSERT_OK(axis.command(to(35990, Approach::kPositive), nullptr));
  arrives(35990, signal_from_counts(35990));
  TEST_ASSERT_OK(axis.command(to(10, Approach::kNegative), nullptr));
  arrives(10, signal_from_counts(10));
  TEST_ASSERT_REFUSED(kAboveMaximum, kPosition, axis.command(to(36007), nullptr));
  TEST_ASSERT_REFUSED(kBelowMinimum, kPosition, axis.command(to(-1), nullptr));
  TEST_ASSERT_REFUSED(kNotAvailable, kPosition, [this] {
    AxisConfig config = axis.config();
    config.soft_high_counts = 1;
    return axis.configure(config);
  }());
}

TEST_F(Rotary, a_direction_asked_for_in_flight_is_never_turned_back_from) {
  TEST_ASSERT_OK(axis.jog(1.2e6, kLimits, nullptr));
  run(500);
  TEST_ASSERT_OK(axis.command(to(100, Approach::kPositive), nullptr));
  Signal last = axis.state().setpoint;
  while (axis.state().phase != AxisPhase::kAtRest) {
    const Signal next = axis.tick();
    TEST_ASSERT_TRUE(next >= last);
    last = next;
  }
  TEST_ASSERT_EQUAL_INT32(100, axis.reading_counts());
}

TEST_F(Rotary, it_turns_for_ever_and_loses_no_count) {
  // GIVEN a fast jog past the end of the range again and again WHEN its steps are summed apart THEN the reading is
  // what they come to
  AxisConfig config = axis.config();
  config.maximum = AxisLimits{400e9, 40e12, 40e12, 2e15};
  configure(config);
  TEST_ASSERT_OK(axis.jog(300e9, config.maximum, nullptr));
  Signal last = 0;
  uint64_t whole = 0, fraction = 0;  // counts modulo a turn, and 2^-32 counts
  for (int i = 0; i < 200000; ++i) {
    const Signal next = axis.tick();
    const auto step = static_cast<uint64_t>(wrapping_difference(next, last));
    fraction += step & UINT64_C(0xFFFFFFFF);
    whole = (whole + (step >> 32) + (fraction >> 32)) % static_cast<uint64_t>(kTurn);
    fraction &= UINT64_C(0xFFFFFFFF);
    last = next;
    if (i % 997 != 0) continue;
    const uint64_t rounded = (whole + (fraction >> 31)) % static_cast<uint64_t>(kTurn);
    TEST_ASSERT_EQUAL_INT64(rounded, axis.reading_counts());
  }
  TEST_ASSERT_OK(axis.command(Move{7, ProfileKind::kSCurve, config.maximum, 0.0, false}, nullptr));
  run_to_rest();
  TEST_ASSERT_EQUAL_INT32(7, axis.reading_counts());
}
