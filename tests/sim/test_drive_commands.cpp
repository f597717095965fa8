// SPDX-License-Identifier: Apache-2.0
// What each verb of `stillpoint drive` does to a drive in each state and mode: the firmware in this process.
#include "sim/cli/drive_commands.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "sim/cli/chip_client.hpp"
#include "sim/cli/drive_files.hpp"
#include "sim/cli/drive_status.hpp"
#include "sim/cli/drive_tune.hpp"
#include "sim/refusal.hpp"
#include "tests/firmware/drive402.hpp"
#include "tests/firmware/stored_drive.hpp"
#include "tests/sim/refusals.hpp"
#include "tests/sim/rig_port.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr int32_t kTarget = 60000;

struct Commanded : Drive402 {
  RigPort port{*this};

  void set_mode(uint32_t mode) {
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0042, mode));
    step(2);
    TEST_ASSERT_EQUAL_UINT32(mode, get(0x0043));
  }
  bool torque_since(size_t tick) const {
    return std::any_of(servo.commands.begin() + static_cast<std::ptrdiff_t>(tick), servo.commands.end(),
                       [](const hal::ServoCommand& command) { return command.enabled; });
  }
  bool torque_lost_since(size_t tick) const {
    return std::any_of(servo.commands.begin() + static_cast<std::ptrdiff_t>(tick), servo.commands.end(),
                       [](const hal::ServoCommand& command) { return !command.enabled; });
  }
  bool moves() {
    const int64_t before = servo.setpoint();
    step(5);
    return servo.setpoint() != before;
  }
};

// --- where the drive is when it is told ----------------------------------------------------------------------------

void off(Commanded&) {}
void ready(Commanded& rig) { rig.control(0x06); }
void switched_on(Commanded& rig) {
  rig.control(0x06);
  rig.control(0x07);
}
void enabled(Commanded& rig) { rig.enable(); }
template <uint32_t kMode, void (*kState)(Commanded&)>
void in_mode(Commanded& rig) {
  rig.set_mode(kMode);
  kState(rig);
}
void moving(Commanded& rig) {
  rig.enable();
  rig.start_move(2000000);
  rig.control(0x0F);
  rig.step(200);
}
void jogging(Commanded& rig) {
  in_mode<3, enabled>(rig);
  TEST_ASSERT_EQUAL_UINT32(0, rig.write_wide(0x0052, 100000));
  rig.step(300);
}
void jog_halted(Commanded& rig) {
  jogging(rig);
  rig.control(0x10F);
  rig.step(500);
}
void streaming(Commanded& rig) {
  in_mode<8, enabled>(rig);
  TEST_ASSERT_EQUAL_UINT32(0, rig.write(0x0090, {0, 0, 0, 0, 0, 0, 0, 0}));
  rig.control(0x1F);
  rig.step(5);
}
// Disable operation, its ramp under way.
void slowing(Commanded& rig) {
  TEST_ASSERT_EQUAL_UINT32(0, rig.write_wide(0x0064, 500000));
  moving(rig);
  rig.control(0x07);
}
void stopped(Commanded& rig) {
  rig.unlock();
  TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0078, 6));
  moving(rig);
  rig.control(0x02);
  rig.step(500);
}
void fault(Commanded& rig) {
  rig.enable();
  rig.drive.note_fault(firmware::FaultCode::kTickOverrun);
  rig.step(500);
}
// A ramp that takes longer than the requests.
void fault_reaction(Commanded& rig) {
  rig.unlock();
  TEST_ASSERT_EQUAL_UINT32(0, rig.write_single(0x0079, 1));
  TEST_ASSERT_EQUAL_UINT32(0, rig.write_wide(0x0064, 500000));
  moving(rig);
  rig.drive.note_fault(firmware::FaultCode::kTickOverrun);
  rig.step(5);
}

// --- what it is told -----------------------------------------------------------------------------------------------

using Verb = void (*)(sim::RegisterPort&);
constexpr size_t kVerbs = 7;
constexpr const char* kNames[kVerbs] = {"enable", "disable", "halt", "stop", "reset", "move", "tune"};

void move(sim::RegisterPort& port) {
  cli::ChipClient(port).finish(cli::start_move(port, {kTarget, false}).total_ticks);
}
// As far as its travel, which is refused once the drive is on; a tuning itself is tests/sim/test_host_tune.cpp's.
void tune(sim::RegisterPort& port) {
  cli::DriveTuneOptions options;
  options.by = "host";
  options.travel = "1";
  static_cast<void>(tune_drive(port, options, {}));
}
constexpr Verb kDo[kVerbs] = {
    cli::enable_drive, cli::disable_drive, cli::halt_drive, cli::stop_drive, cli::reset_drive, move, tune};

// What comes of each verb: "ok" or the refusal's result, and the state once all has settled.
struct Row {
  const char* name;
  void (*situation)(Commanded&);
  const char* outcome[kVerbs];
};

constexpr const char kOn[] = "ok 27", kOff[] = "ok 40", kDead[] = "ok 8";

const Row kRows[] = {
    {"off", off, {kOn, kOff, "not_enabled 40", kOff, "no_fault 40", kOn, "bad_argument 27"}},
    {"off, 3", in_mode<3, off>, {kOn, kOff, "not_enabled 40", kOff, "no_fault 40", kOn, "bad_argument 27"}},
    {"off, 6", in_mode<6, off>, {kOn, kOff, "not_enabled 40", kOff, "no_fault 40", kOn, "bad_argument 27"}},
    {"off, 8", in_mode<8, off>, {kOn, kOff, "not_enabled 40", kOff, "no_fault 40", kOn, "bad_argument 27"}},
    {"ready", ready, {kOn, kOff, "not_enabled 21", kOff, "no_fault 21", kOn, "bad_argument 27"}},
    {"ready, 6", in_mode<6, ready>, {kOn, kOff, "not_enabled 21", kOff, "no_fault 21", kOn, "bad_argument 27"}},
    {"switched on", switched_on, {kOn, kOff, "not_enabled 23", kOff, "no_fault 23", kOn, "bad_argument 27"}},
    {"on, 3", in_mode<3, switched_on>, {kOn, kOff, "not_enabled 23", kOff, "no_fault 23", kOn, "bad_argument 27"}},
    {"enabled", enabled, {kOn, kOff, kOn, kOff, "no_fault 27", kOn, "bad_argument 27"}},
    {"enabled, 3", in_mode<3, enabled>, {kOn, kOff, kOn, kOff, "no_fault 27", kOn, "bad_argument 27"}},
    {"enabled, 6", in_mode<6, enabled>, {kOn, kOff, kOn, kOff, "no_fault 27", kOn, "bad_argument 27"}},
    {"enabled, 8", in_mode<8, enabled>, {kOn, kOff, kOn, kOff, "no_fault 27", kOn, "bad_argument 27"}},
    {"moving", moving, {kOn, kOff, kOn, kOff, "no_fault 27", kOn, "bad_argument 27"}},
    {"jogging", jogging, {kOn, kOff, kOn, kOff, "no_fault 27", "mode_in_force 27", "bad_argument 27"}},
    {"jog halted", jog_halted, {kOn, kOff, kOn, kOff, "no_fault 27", kOn, "bad_argument 27"}},
    {"streaming", streaming, {kOn, kOff, kOn, kOff, "no_fault 27", "mode_in_force 27", "bad_argument 27"}},
    {"slowing", slowing, {kOn, kOff, "ok 23", kOff, "no_fault 23", kOn, "bad_argument 27"}},
    {"stopped", stopped, {kOn, kOff, "quick_stop 7", "ok 7", "no_fault 7", "quick_stop 7", "quick_stop 7"}},
    {"fault", fault, {"drive_fault 8", kDead, "drive_fault 8", kDead, kOff, "drive_fault 8", "drive_fault 8"}},
    {"fault reaction",
     fault_reaction,
     {"drive_fault 8", kDead, "drive_fault 8", kDead, kOff, "drive_fault 8", "drive_fault 8"}},
};

template <typename Check>
void for_each_case(const Check& check) {
  for (const Row& row : kRows) {
    for (size_t verb = 0; verb < kVerbs; ++verb) {
      TEST_INFO("situation", row.name);
      TEST_INFO("verb", kNames[verb]);
      Commanded rig;
      row.situation(rig);
      check(rig, row, verb);
    }
  }
}

std::string outcome_of(Commanded& rig, size_t verb) {
  const auto refused = refusal_of([&] { kDo[verb](rig.port); });
  if (refused.said.empty()) return "ok";
  check_says("accepted", refused.said);
  return refused.result;
}

std::string hexadecimal(uint32_t value) {
  char text[9];
  std::snprintf(text, sizeof text, "%X", static_cast<unsigned>(value));
  return text;
}

TEST(each_verb_from_each_state_and_mode_ends_where_its_name_says) {
  for_each_case([](Commanded& rig, const Row& row, size_t verb) {
    const std::string said = outcome_of(rig, verb);
    rig.step(3000);
    const std::string outcome = said + " " + hexadecimal(rig.state());
    TEST_INFO("outcome", outcome);
    TEST_INFO("expected", row.outcome[verb]);
    TEST_ASSERT_TRUE(outcome == row.outcome[verb]);
  });
}

TEST(what_is_refused_has_written_no_controlword_and_asked_for_no_mode) {
  for_each_case([](Commanded& rig, const Row& row, size_t verb) {
    if (std::string(row.outcome[verb]).rfind("ok", 0) == 0 || kDo[verb] == tune) return;
    const uint32_t controlword = rig.get(0x0040);
    const uint32_t mode = rig.get(0x0042);
    static_cast<void>(outcome_of(rig, verb));
    TEST_ASSERT_EQUAL_UINT32(controlword, rig.get(0x0040));
    TEST_ASSERT_EQUAL_UINT32(mode, rig.get(0x0042));
    TEST_ASSERT_EQUAL_UINT32(mode, rig.get(0x0043));
  });
}

TEST(only_enable_move_and_tune_give_torque_and_only_move_moves) {
  for_each_case([](Commanded& rig, const Row&, size_t verb) {
    const bool had_torque = rig.servo.enabled();
    const bool moved = rig.moves();
    const size_t from = rig.servo.commands.size();
    static_cast<void>(outcome_of(rig, verb));
    const bool to_enable = kDo[verb] == cli::enable_drive || kDo[verb] == move || kDo[verb] == tune;
    if (!had_torque && !to_enable) TEST_ASSERT_FALSE(rig.torque_since(from));
    if (!moved && kDo[verb] != move) TEST_ASSERT_FALSE(rig.moves());
  });
}

TEST(a_drive_that_is_enabled_loses_its_torque_by_disable_and_stop_alone) {
  for_each_case([](Commanded& rig, const Row& row, size_t verb) {
    const bool stays = rig.state() == 0x27 && row.situation != slowing;
    const size_t from = rig.servo.commands.size();
    static_cast<void>(outcome_of(rig, verb));
    if (stays && kDo[verb] != cli::disable_drive && kDo[verb] != cli::stop_drive)
      TEST_ASSERT_FALSE(rig.torque_lost_since(from));
  });
}

TEST(what_only_asks_changes_nothing_in_any_state) {
  for (const Row& row : kRows) {
    TEST_INFO("situation", row.name);
    Commanded rig;
    row.situation(rig);
    const uint32_t controlword = rig.get(0x0040);
    const bool had_torque = rig.servo.enabled();
    const bool moved = rig.moves();
    const uint32_t state = rig.state();
    static_cast<void>(cli::exported(rig.port));
    static_cast<void>(cli::fault_history(rig.port));
    TEST_ASSERT_EQUAL_UINT32(controlword, rig.get(0x0040));
    if (row.situation == moving || row.situation == slowing || row.situation == fault_reaction)
      continue;  // may be over
    TEST_ASSERT_EQUAL_UINT32(state, rig.state());
    TEST_ASSERT_TRUE(had_torque == rig.servo.enabled());
    TEST_ASSERT_TRUE(moved == rig.moves());
  }
}

TEST(a_jog_goes_on_through_what_is_refused_and_stands_after_a_halt) {
  for (size_t verb = 0; verb < kVerbs; ++verb) {
    TEST_INFO("verb", kNames[verb]);
    Commanded rig;
    jogging(rig);
    static_cast<void>(outcome_of(rig, verb));
    rig.step(500);
    const bool ends = kDo[verb] == cli::disable_drive || kDo[verb] == cli::halt_drive || kDo[verb] == cli::stop_drive;
    TEST_ASSERT_EQUAL_INT32(ends ? 0 : 1, rig.moves() ? 1 : 0);
    if (kDo[verb] != cli::halt_drive) continue;
    cli::enable_drive(rig.port);  // is enabled, and does not end the halt
    rig.step(100);
    TEST_ASSERT_FALSE(rig.moves());
  }
}

TEST(a_move_arrives_whatever_the_mode_was_and_reports_its_own_ticks) {
  for (const Row& row : kRows) {
    if (std::string(row.outcome[5]) != kOn) continue;
    TEST_INFO("situation", row.name);
    Commanded rig;
    row.situation(rig);
    const MoveReport report = cli::start_move(rig.port, {kTarget, false});
    TEST_ASSERT_AT_LEAST_INT64(100, report.total_ticks);
    cli::ChipClient(rig.port).finish(report.total_ticks);
    TEST_ASSERT_EQUAL_INT64(kTarget, rig.demand());
    TEST_ASSERT_EQUAL_UINT32(1, rig.get(0x0043));
  }
}

TEST(a_set_point_that_was_refused_does_not_stand_in_the_next_ones_way) {
  Commanded rig;
  rig.enable();
  rig.unlock();
  TEST_ASSERT_EQUAL_UINT32(0, rig.write(0x0074, {0xFFFF, 0, 1, 0}));  // soft limits
  const auto beyond = [&] { static_cast<void>(cli::start_move(rig.port, {1000000, false})); };
  TEST_ASSERT_TRUE(refusal_of(beyond).result == "drive_refused");
  TEST_ASSERT_EQUAL_UINT32(0x0F, rig.get(0x0040));
  move(rig.port);
  TEST_ASSERT_EQUAL_INT64(kTarget, rig.demand());
}

TEST(a_move_that_is_halted_or_stopped_on_its_way_is_no_success) {
  for (const uint32_t word : {0x10FU, 0x02U, 0x00U}) {
    TEST_INFO("controlword", word);
    Commanded rig;
    const MoveReport report = cli::start_move(rig.port, {2000000, false});
    rig.control(word);
    const std::string result = refusal_of([&] { cli::ChipClient(rig.port).finish(report.total_ticks); }).result;
    TEST_ASSERT_TRUE(result == (word == 0x10F ? "halted" : "not_enabled"));
  }
}

TEST(a_tuning_leaves_an_axis_that_moves_in_another_mode_to_it) {
  for (void (*const situation)(Commanded&) : {jogging, streaming}) {
    Commanded rig;
    situation(rig);
    const bool moved = rig.moves();
    const uint32_t controlword = rig.get(0x0040);
    cli::DriveTuneOptions options;
    options.by = "host";
    const std::string result = refusal_of([&] { static_cast<void>(tune_drive(rig.port, options, {})); }).result;
    TEST_INFO("result", result);
    TEST_ASSERT_TRUE(result == "mode_in_force");
    TEST_ASSERT_EQUAL_INT32(moved ? 1 : 0, rig.moves() ? 1 : 0);
    TEST_ASSERT_EQUAL_UINT32(controlword, rig.get(0x0040));
    TEST_ASSERT_EQUAL_UINT32(rig.get(0x0043), rig.get(0x0042));
  }
}

TEST(a_tuning_that_cannot_be_asked_for_switches_nothing_on) {
  Commanded rig;
  cli::DriveTuneOptions options;
  options.by = "host";
  options.excitation = "bump";
  const auto ask = [&] { static_cast<void>(tune_drive(rig.port, options, {})); };
  TEST_ASSERT_TRUE(refusal_of(ask).result == "bad_argument");
  TEST_ASSERT_FALSE(rig.torque_since(0));
}

TEST(settings_are_saved_while_the_drive_is_off_a_fault_included) {
  FlashModel flash;
  Stored rig(&flash);
  RigPort port(rig);
  rig.step(5);
  rig.enable();
  const std::string said = refusal_of([&] { cli::save_settings(port); }).said;
  TEST_INFO("said", said);
  TEST_ASSERT_TRUE(said.find("drive: register 0014h: ") == 0);
  rig.drive.note_fault(firmware::FaultCode::kTickOverrun);
  rig.step(500);
  TEST_ASSERT_EQUAL_UINT32(0x08, rig.state());
  cli::save_settings(port);
  TEST_ASSERT_EQUAL_UINT32(2, rig.get(0x0015));
  TEST_ASSERT_EQUAL_UINT32(0x50495053, flash.pages[0][0]);
}

TEST(a_drive_without_feedback_is_refused_by_name_and_stays_off) {
  Commanded rig;
  rig.servo.valid = false;
  rig.step(10);
  TEST_ASSERT_TRUE(refusal_of([&] { cli::enable_drive(rig.port); }).result == "no_feedback");
  const size_t from = rig.servo.commands.size();
  rig.servo.valid = true;
  rig.step(500);
  TEST_ASSERT_FALSE(rig.torque_since(from));
  TEST_ASSERT_EQUAL_UINT32(0x40, rig.state());
}

}  // namespace
