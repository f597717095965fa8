// SPDX-License-Identifier: Apache-2.0
// A drive with an arm behind its motor, and a client that tunes it.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/simulated_drive.hpp"
#include "tests/firmware/drive402.hpp"

namespace stillpoint::testing {

// Servo link and arm, with what was seen on the way.
struct ArmServo final : hal::ServoPort {
  sim::SimulatedDrive drive;
  std::vector<int64_t> setpoints;
  std::vector<bool> enabled_at;
  std::vector<double> deflections;  // units
  bool enabled = false;

  explicit ArmServo(const sim::SimulatedDriveConfig& config) : drive(config) {}
  void disable() override { enabled = false; }
  hal::ServoFeedback exchange(const hal::ServoCommand& command) override {
    enabled = command.enabled;
    setpoints.push_back(command.setpoint);
    enabled_at.push_back(command.enabled);
    const hal::ServoFeedback feedback = drive.exchange(command);
    deflections.push_back(drive.arm().deflection());
    return feedback;
  }
  void forget() {
    setpoints.clear();
    enabled_at.clear();
    deflections.clear();
  }
};

// The paper's arm, 11 Hz and 0.11, with a tip accelerometer of a little noise.
inline sim::SimulatedDriveConfig papers_arm() {
  sim::SimulatedDriveConfig config;
  config.modes = {{{11.0, 0.11}, 1.0}};
  config.accelerometer.resolution = 0.02;
  config.accelerometer.noise = 0.05;
  return config;
}

struct ArmServoHolder {
  ArmServo arm;
  explicit ArmServoHolder(const sim::SimulatedDriveConfig& config) : arm(config) {}
};

constexpr uint32_t kStart = 1, kAbort = 2, kAccept = 3, kUndo = 4;

struct TuneRig : ArmServoHolder, Drive402 {
  explicit TuneRig(const sim::SimulatedDriveConfig& config = papers_arm()) : ArmServoHolder(config), Drive402(arm) {}

  TuneState tune_state() const { return drive.tuning().state; }
  uint32_t tune(uint32_t command) { return write_single(0x0200, command); }

  // Until the tuner is in `state`, at most 20 s.
  void reach(TuneState state) {
    for (int i = 0; i < 20000 && tune_state() != state; ++i) step();
    TEST_ASSERT_EQUAL_ENUM(state, tune_state());
  }
  // Until it is at an end of its own.
  void reach_end() {
    for (int i = 0; i < 20000 && !ended(); ++i) step();
    TEST_ASSERT_TRUE(ended());
  }
  bool ended() const { return tune_state() == TuneState::kIdle || tune_state() >= TuneState::kKept; }

  void run_to_kept() {
    TEST_ASSERT_EQUAL_UINT32(0, tune(kStart));
    reach(TuneState::kProposed);
    TEST_ASSERT_EQUAL_UINT32(0, tune(kAccept));
    reach(TuneState::kKept);
  }

  // Nothing has moved since `forget`.
  bool still() const {
    return std::all_of(arm.setpoints.begin(), arm.setpoints.end(),
                       [&](int64_t setpoint) { return setpoint == arm.setpoints.front(); });
  }

  // The furthest of the setpoint from `counts` since `forget`, in counts.
  double reach_from(int32_t counts) const {
    double furthest = 0.0;
    for (const int64_t setpoint : arm.setpoints) {
      const double counts_off = static_cast<double>(setpoint) / static_cast<double>(kCount) - counts;
      furthest = std::fmax(furthest, std::fabs(counts_off));
    }
    return furthest;
  }

  // A move of the paper's, and the arm's largest deflection once its setpoint stands; units.
  double ringing_after_move(int32_t target) {
    arm.forget();
    start_move(target);
    control(0x0F);
    step(4000);
    size_t last_change = 0;
    for (size_t i = 1; i < arm.setpoints.size(); ++i) {
      if (arm.setpoints[i] != arm.setpoints[i - 1]) last_change = i;
    }
    TEST_ASSERT_EQUAL_INT64(target * kCount, arm.setpoints.back());
    double largest = 0.0;
    for (size_t i = last_change; i < arm.deflections.size(); ++i) {
      largest = std::fmax(largest, std::fabs(arm.deflections[i]));
    }
    return largest;
  }
};

struct Tunable : TuneRig {
  Tunable() {
    enable();
    arm.forget();
  }
};

}  // namespace stillpoint::testing
