// SPDX-License-Identifier: Apache-2.0
// A whole drive between its two plugs, watched, with troubles that can be made.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include <cstdio>
#include <cstdlib>
#include <deque>

#include "firmware/application.hpp"
#include "firmware/default_axis.hpp"
#include "shaper/axis/axis.hpp"
#include "tests/fuzz/client_watch.hpp"
#include "tests/support/flash_model.hpp"

namespace stillpoint::testing {

struct Line final : hal::ByteStream {
  explicit Line(ClientWatch& watch) : watch_(watch) {}
  std::deque<uint8_t> to_drive;
  bool stuck = false;  // takes two bytes of an answer

  bool read(uint8_t& byte) override {
    const bool any = !to_drive.empty();
    if (any) {
      byte = to_drive.front();
      to_drive.pop_front();
    }
    if (went_) taken_ = 0;
    watch_.read(any, any ? byte : uint8_t{0});
    return any;
  }
  bool write(uint8_t byte) override {
    went_ = !stuck || taken_ < 2;
    if (went_) ++taken_;
    watch_.written(went_, byte);
    return went_;
  }

 private:
  ClientWatch& watch_;
  size_t taken_ = 0;
  bool went_ = true;
};

// Follows while enabled; loses feedbacks when told.
struct Servo final : hal::ServoPort {
  explicit Servo(ClientWatch& watch) : watch_(watch) {}
  int64_t position = 0;
  int64_t encoder_off = 0;
  uint16_t sequence = 0;
  bool valid = true;
  bool blocked = false;
  bool commit = true;

  void disable() override { watch_.disabled(); }
  hal::ServoFeedback exchange(const hal::ServoCommand& command) override {
    watch_.commanded(command, position + encoder_off, commit);
    if (command.enabled && !blocked) position = command.setpoint;
    return {position + encoder_off, 0, ++sequence, valid, commit};
  }

 private:
  ClientWatch& watch_;
};

struct Dog final : hal::Watchdog {
  void feed() override {}
};

inline void no_restart() {}

struct Rig {
  ClientWatch watch;
  Axis<firmware::kLineCapacity> axis = {};
  firmware::Application drive = {};
  TuneMemory tune_memory = {};
  firmware::FaultMemory faults = {};
  Servo servo{watch};
  Line line{watch};
  Dog dog;
  FlashModel flash;
  uint32_t ticks_left = 6000;  // a programme's length is bounded, or the fuzzer would only wait

  Rig() {
    if (!axis.configure(firmware::kDefaultAxis).ok()) std::abort();
    drive.begin(axis, {&servo, &line, &dog, &faults, &tune_memory, &flash, no_restart});
  }

  void step(uint32_t ticks, bool linked) {
    for (; ticks != 0 && ticks_left != 0; --ticks, --ticks_left) {
      if (linked) drive.tick();
      drive.own_timer_tick();
      drive.poll();
      drive.poll();
      if (watch.broken() == nullptr) continue;
      std::fprintf(stderr, "invariant broken: %s\n", watch.broken());
      std::abort();
    }
  }
};

}  // namespace stillpoint::testing
