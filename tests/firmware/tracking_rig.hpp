// SPDX-License-Identifier: Apache-2.0
// A drive that follows its arm from move to move, and an arm that changes between them.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "sim/simulated_drive.hpp"
#include "tests/firmware/drive402.hpp"

namespace stillpoint::testing {

constexpr double kArmHz = 11.0;
constexpr double kArmDamping = 0.04;

// Servo link and arm; the arm is another one when it is told so, where it stands.
struct ChangingArm final : hal::ServoPort {
  sim::SimulatedDriveConfig config;
  std::unique_ptr<sim::SimulatedDrive> drive;
  std::vector<int64_t> setpoints;
  double largest = 0.0;  // deflection since the setpoint last changed, units
  int64_t last = 0;
  uint16_t sequence = 0;
  uint16_t lost_every = 0;  // so many feedbacks one is no good

  ChangingArm() {
    config.accelerometer = {0.02, 1e6, 0.05, 1};
    become({kArmHz, kArmDamping});
  }

  // `share` of the displacement: a rigid one has next to none.
  void become(const Mode& mode, double share = 1.0) {
    config.modes = {{mode, share}};
    change();
  }
  void change() {
    config.start = drive ? drive->motor() : 0;
    config.encoder.seed += 2;
    config.accelerometer.seed += 2;
    drive = std::make_unique<sim::SimulatedDrive>(config);
  }

  void disable() override {}
  hal::ServoFeedback exchange(const hal::ServoCommand& command) override {
    setpoints.push_back(command.setpoint);
    hal::ServoFeedback feedback = drive->exchange(command);
    if (command.setpoint != last) largest = 0.0;
    last = command.setpoint;
    largest = std::fmax(largest, std::fabs(drive->arm().deflection()));
    feedback.sequence = ++sequence;
    if (lost_every != 0 && sequence % lost_every == 0) feedback.valid = false;
    return feedback;
  }
};

struct ChangingArmHolder {
  ChangingArm arm;
};

enum TrackingSwitch : uint32_t { kOff, kShow, kApply };

struct TrackingRig : ChangingArmHolder, Drive402 {
  int32_t at = 0;

  explicit TrackingRig(hal::Nonvolatile* memory = nullptr) : Drive402(arm, memory) {
    enable();
    apply_zv(kArmHz, kArmDamping);
  }

  // What a client stages and applies.
  void apply_zv(double hz, double damping, uint32_t set = 0) {
    const auto frequency = static_cast<uint32_t>(hz * 1e4 + 0.5);
    TEST_ASSERT_EQUAL_UINT32(
        0, write(0x0100, {1, static_cast<uint16_t>(set), static_cast<uint16_t>(frequency >> 16),
                          static_cast<uint16_t>(frequency), static_cast<uint16_t>(damping * 1e5 + 0.5), 0, 1}));
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
    step(50);
    TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  }

  void track(uint32_t how) { TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0250, how)); }
  void command(int32_t target) {
    at = target;
    start_move(target);
    control(0x0F);
  }
  // There, and `ms` from its command on; the ringing, in units. 1,600 ms are enough for a whole record.
  double move(int32_t target, uint32_t ms = 1600) {
    command(target);
    step(ms - 60);
    return arm.largest;
  }
  // Of a random length to a random side.
  double move_somewhere(Random& random, uint32_t ms = 1600) {
    const auto distance = static_cast<int32_t>(random.integer(150000, 400000));
    return move(at > 0 ? at - distance : at + distance, ms);
  }

  double tracked_hz() { return 1e-4 * get_wide(0x0260); }
  double tracked_damping() { return 1e-5 * get(0x0262); }
  uint32_t used() { return get_wide(0x0252); }
  uint32_t left_out() { return get_wide(0x0254); }
  uint32_t heard() { return used() + left_out(); }
  uint32_t unheard() { return get_wide(0x0256); }
};

}  // namespace stillpoint::testing
