// SPDX-License-Identifier: Apache-2.0
// A whole axis moves a drive by pulses: axis, control loop, pulse port, a model of the timer, and a drive that counts.
// The drive itself holds every edge against its width, set-up and hold times (ModelDrive).
#include "firmware/control_loop.hpp"
#include "firmware/default_axis.hpp"
#include "shaper/axis/axis.hpp"
#include "tests/firmware/pulse_model.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shapers.hpp"

using namespace stillpoint;
using namespace stillpoint::firmware;
using namespace stillpoint::testing;

namespace {

// Between the loop and the port: keeps what was commanded.
struct Spy final : hal::ServoPort {
  Board& board;
  hal::ServoCommand newest{};

  explicit Spy(Board& hardware) : board(hardware) {}
  hal::ServoFeedback exchange(const hal::ServoCommand& command) override {
    newest = command;
    return board.exchange(command);
  }
  void disable() override { board.port.disable(); }
};

struct Machine : Board {
  Axis<2048> axis;
  ControlLoop loop;
  Spy spy{*this};
  Random random{1};
  PulseConfig config = kBoardConfig;
  hal::ServoCommand before{};  // the tick before the newest
  Signal enabled_at = 0;
  int64_t enabled_count = 0;
  uint32_t in_the_gap = 0, moving = 0;

  void enable(const PulseConfig& how, uint32_t position) {
    config = how;
    counts = how.counts;
    pulses = how.pulses;
    encoder_zero = position;
    begin(how);
    TEST_ASSERT_OK(axis.configure(kDefaultAxis));
    loop.begin(axis, spy);
    for (int ticks = 0; ticks < 2; ++ticks) step();
    loop.request_enabled(true);
    step();
    TEST_ASSERT_TRUE(gpio.enabled);
    enabled_at = spy.newest.setpoint;
    enabled_count = drive.count;
    TEST_ASSERT_EQUAL_INT64(static_cast<int32_t>(position) * kSignalPerCount, enabled_at);
  }

  void step() {
    const bool forward = drive.forward;  // of the newest pulses of the setpoint before the newest
    start_tick(random.integer(0, static_cast<int64_t>(kBoardJitter)));
    // All pulses of the setpoint before the newest have been sent, and none of the newest.
    if (before.enabled) check_count(before.setpoint, forward);
    before = spy.newest;
    loop.tick();
  }

  void check_count(Signal setpoint, bool forward) {
    __extension__ using Exact = __int128;
    const Exact one = Exact{config.counts} << 32;
    const Exact wanted = Exact{wrapping_difference(setpoint, enabled_at)} * config.pulses;
    const Exact sent = drive.count - enabled_count;
    const Exact error = wanted - sent * one;
    const bool rounded = error >= -one / 2 && error < one / 2;
    if (config.without_reversal_gap) TEST_ASSERT_TRUE(rounded);
    if (!rounded) ++in_the_gap;
    TEST_ASSERT_TRUE(error > -one && error < one);
    TEST_ASSERT_TRUE(rounded || (error > 0) != forward);
    if (axis.state().phase != AxisPhase::kAtRest) ++moving;
  }

  void wander(int ticks) {
    for (int tick = 0; tick < ticks; ++tick) {
      if (tick % 64 == 0) act();
      step();
    }
  }
  // Another target, at rest or in flight; now and then a quick stop. What is refused leaves what was.
  void act() {
    if (random.unit() < 0.1) return axis.request_stop();
    const double velocity = 1e7 * random.between(0.001, 1.0);
    const double acceleration = 1e9 * random.between(0.01, 1.0);
    const double jerk = 1e12 * random.between(0.01, 1.0);
    const auto target = static_cast<int32_t>(random.integer(-2000000000, 2000000000) >> random.integer(0, 20));
    const Move move = {target, ProfileKind::kSCurve, {velocity, acceleration, acceleration, jerk}, 0.0, false};
    static_cast<void>(axis.command(move, nullptr));
  }
  // At full speed 190 pulses a tick and fewer.
  PulseConfig random_ratio() {
    PulseConfig how = kBoardConfig;
    how.pulses = static_cast<uint32_t>(random.unit() < 0.5 ? 1 : random.integer(1, 5000));
    how.counts = static_cast<uint32_t>(how.pulses * random.integer(53, 2000) + random.integer(0, how.pulses - 1));
    return how;
  }
};

uint32_t run_machine(uint64_t seed, bool with_gap, bool shaped) {
  TEST_INFO("seed", seed);
  Machine machine;
  machine.random = Random(seed);
  PulseConfig how = machine.random_ratio();
  how.without_reversal_gap = !with_gap;
  machine.enable(how, static_cast<uint32_t>(machine.random.integer(-1000000, 1000000)));
  if (shaped) {
    TEST_ASSERT_OK(
        machine.axis.set_shaper(shaper_of(ShaperKind::kZvd, machine.random.between(5.0, 40.0), 0.05, 0.001)));
  }
  machine.wander(4000);
  TEST_ASSERT_EQUAL_UINT32(0, machine.port.limited_ticks());
  TEST_ASSERT_EQUAL_UINT32(0, machine.port.late_bursts());
  TEST_ASSERT_AT_LEAST_INT64(500, machine.moving);
  TEST_ASSERT_AT_LEAST_INT64(100, machine.drive.rises);
  return machine.in_the_gap;
}

}  // namespace

TEST(the_drive_has_counted_the_rounded_setpoint_at_every_ticks_end) {
  for (uint64_t seed = 1; seed <= 30; ++seed) TEST_ASSERT_EQUAL_UINT32(0, run_machine(seed, false, seed % 2 == 0));
}

TEST(with_the_reversal_gap_it_is_less_than_a_pulse_off_and_only_after_a_reversal) {
  uint32_t in_the_gap = 0;
  for (uint64_t seed = 101; seed <= 130; ++seed) in_the_gap += run_machine(seed, true, seed % 2 == 0);
  TEST_ASSERT_AT_LEAST_INT64(100, in_the_gap);
}
