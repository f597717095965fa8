// SPDX-License-Identifier: Apache-2.0
// `stillpoint drive` against `stillpoint emulate`, over a serial port as a person would.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/sim/cli_checks.hpp"

using stillpoint::testing::check_keys;
using stillpoint::testing::check_refused;
using stillpoint::testing::Json;
using stillpoint::testing::json_of;
using stillpoint::testing::Outcome;
using stillpoint::testing::read_text;
using stillpoint::testing::run_program;
using stillpoint::testing::scratch_file;

namespace {

// The firmware on this host behind a serial port, for as long as this lives, and a minute at most.
class Emulated {
 public:
  explicit Emulated(const std::string& options = "") : port_(scratch_file("port")) {
    const std::string pid = scratch_file("emulate.pid");
    const std::string command = std::string(STILLPOINT_PROGRAM) + " emulate --seconds 60 --link " + port_ + " " +
                                options + " > " + scratch_file("emulate.log") + " 2>&1 & echo $! > " + pid;
    TEST_ASSERT_EQUAL_INT32(0, std::system(command.c_str()));
    std::ifstream(pid) >> pid_;
    for (int i = 0; i < 500 && !std::filesystem::exists(port_); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    TEST_ASSERT_TRUE(std::filesystem::exists(port_));
  }
  ~Emulated() { end(); }
  Emulated(const Emulated&) = delete;
  Emulated& operator=(const Emulated&) = delete;

  void end() {
    if (pid_ > 0) ::kill(pid_, SIGTERM);
    pid_ = 0;
    for (int i = 0; i < 500 && std::filesystem::exists(port_); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::string drive(const std::string& what) const { return "drive " + port_ + " " + what + " --parity none"; }

 private:
  std::string port_;
  int pid_ = 0;
};

TEST(a_drive_is_enabled_moved_stopped_and_switched_off) {
  const Emulated emulated;
  const Json before = json_of(emulated.drive("status"));
  check_keys(before,
             {"state", "statusword", "error_code", "position_counts", "following_error_counts", "mode", "uptime_ms"});
  TEST_ASSERT_TRUE(before["state"] == "switch on disabled");
  TEST_ASSERT_TRUE(json_of(emulated.drive("enable"))["state"] == "operation enabled");
  const Json there = json_of(emulated.drive("move --target 200000"));
  TEST_ASSERT_TRUE(there["position_counts"] == 200000);
  TEST_ASSERT_TRUE(json_of(emulated.drive("move --by=-50000"))["position_counts"] == 150000);
  TEST_ASSERT_TRUE(json_of(emulated.drive("status"))["target_reached"] == true);
  TEST_ASSERT_TRUE(json_of(emulated.drive("disable"))["state"] == "switch on disabled");
}

TEST(a_scope_captures_the_move_that_it_makes_and_its_file_can_be_drawn) {
  const Emulated emulated;
  const std::string file = scratch_file("scope.csv");
  const Json there =
      json_of(emulated.drive("scope --target 200000 --channels setpoint,position --pre 25 --csv " + file));
  TEST_ASSERT_TRUE(there["channels"][0]["name"] == "setpoint");
  TEST_ASSERT_TRUE(there["channels"][0]["least"] == 0);
  TEST_ASSERT_TRUE(there["channels"][1]["last"] == 200000);
  TEST_ASSERT_AT_LEAST_INT64(1024 - 256, there["samples"].get<int64_t>());
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.767, there["last_s"].get<double>());
  const Json again = json_of("scope " + file);
  TEST_ASSERT_TRUE(again == there);
  check_refused(2, "--channels: speed: not known, accepted: demand setpoint", emulated.drive("scope --channels speed"));
  check_refused(1, "scope: not triggered: ", emulated.drive("scope --trigger fault --timeout 0.2"));
  TEST_ASSERT_TRUE(json_of(emulated.drive("get scope-state"))["scope-state"] == 0);
}

TEST(a_drive_is_tuned_from_the_host_and_an_interrupt_puts_its_shaper_back) {
  const Emulated emulated;
  const std::string tune = emulated.drive("tune --by host --band 5:200 --amplitude 50000");
  check_refused(2, "--by: me: ", emulated.drive("tune --by me"));
  check_refused(2, "--excitation: bump: ", emulated.drive("tune --by host --excitation bump"));
  const Outcome tuned = run_program(tune + " --json");
  TEST_INFO(errors, tuned.errors);
  TEST_ASSERT_EQUAL_INT32(0, tuned.exit_code);
  TEST_ASSERT_TRUE(tuned.errors.rfind("will move at most 50000 counts", 0) == 0);
  const Json object = Json::parse(tuned.output);
  check_keys(object, {"result", "by", "identified", "source", "source_enough", "excited_by", "announced", "flaws",
                      "predicted", "verified", "first_announced", "shaper"});
  TEST_ASSERT_TRUE(object["by"] == "host");
  TEST_ASSERT_TRUE(object["flaws"] == Json({{"gaps", 0}, {"saturated", 0}}));
  const double frequency_hz = object["identified"]["modes"][0]["frequency_hz"].get<double>();
  TEST_ASSERT_DOUBLE_WITHIN(0.055, 11.0, frequency_hz);
  const Json in_force = json_of(emulated.drive("get 0100 0102 0131 0134"));
  TEST_ASSERT_TRUE(in_force["shaper-state"] == 1);

  const std::string log = scratch_file("interrupted.log");
  const std::string interrupted =
      std::string("timeout -s INT 1 '") + STILLPOINT_PROGRAM + "' " + tune + " > " + log + " 2>&1";
  TEST_ASSERT_FALSE(std::system(interrupted.c_str()) == 0);
  TEST_ASSERT_TRUE(read_text(log).find("tune: interrupted: ") != std::string::npos);
  TEST_ASSERT_TRUE(json_of(emulated.drive("get 0100 0102 0131 0134")) == in_force);
  TEST_ASSERT_TRUE(json_of(emulated.drive("status"))["state"] == "operation enabled");
}

TEST(registers_are_read_and_written_by_name_and_by_address) {
  const Emulated emulated;
  TEST_ASSERT_TRUE(json_of(emulated.drive("set profile-velocity 900000"))["profile-velocity"] == 900000);
  const Json both = json_of(emulated.drive("get 0060 word-order-probe"));
  TEST_ASSERT_TRUE(both["profile-velocity"] == 900000);
  TEST_ASSERT_TRUE(both["word-order-probe"] == 0x12345678);
  TEST_ASSERT_TRUE(json_of(emulated.drive("set maximum-velocity 800000"))["maximum-velocity"] == 800000);
  TEST_ASSERT_TRUE(json_of(emulated.drive("get profile-velocity"))["profile-velocity"] == 800000);
  check_refused(1, "drive: register 0060h: ", emulated.drive("set profile-velocity 900000"));
  check_refused(2, "register: velocidad: not known", emulated.drive("get velocidad"));
  check_refused(2, "position-window-time: 65536: outside the register",
                emulated.drive("set position-window-time 65536"));
  check_refused(2, "drive: dance: not known, accepted: status", emulated.drive("dance"));
  check_refused(2, "argument: missing: `set` needs", emulated.drive("set"));
  check_refused(2, "--target: missing", emulated.drive("move"));
}

TEST(settings_go_into_a_file_and_into_another_drive) {
  const std::string file = scratch_file("settings.json");
  Json exported;
  {
    const Emulated emulated;
    json_of(emulated.drive("set maximum-velocity 3000000"));
    json_of(emulated.drive("set soft-limit-low -70000"));
    json_of(emulated.drive("set soft-limit-high 5000000"));
    json_of(emulated.drive("set mode-0-frequency 110000"));
    json_of(emulated.drive("set shaper-set 5"));
    json_of(emulated.drive("set mode-0-damping-ratio 1234"));
    json_of(emulated.drive("export " + file));
    exported = Json::parse(read_text(file));
    TEST_ASSERT_TRUE(exported["settings"]["soft-limit-low"] == -70000);
    TEST_ASSERT_TRUE(exported["shaper_sets"].size() == 8);
    TEST_ASSERT_TRUE(exported["shaper_sets"][0]["mode-0-frequency"] == 110000);
    TEST_ASSERT_TRUE(exported["shaper_sets"][5]["mode-0-damping-ratio"] == 1234);
    TEST_ASSERT_TRUE(json_of(emulated.drive("get shaper-set"))["shaper-set"] == 5);
  }
  const Emulated other;
  TEST_ASSERT_TRUE(Json::parse(run_program(other.drive("export")).output) != exported);
  json_of(other.drive("import " + file));
  TEST_ASSERT_TRUE(Json::parse(run_program(other.drive("export")).output) == exported);

  std::ofstream(scratch_file("bad.json")) << R"({"settings": {"gravity": 10}, "shaper_sets": []})";
  check_refused(2, "register: gravity: not known", other.drive("import " + scratch_file("bad.json")));
  std::ofstream(scratch_file("bad.json")) << R"({"settings": {"statusword": 1}, "shaper_sets": []})";
  check_refused(2, "setting: statusword: not one of these", other.drive("import " + scratch_file("bad.json")));
  std::ofstream(scratch_file("bad.json")) << R"({"settings": {"jerk": 1.5}, "shaper_sets": []})";
  check_refused(2, "jerk: 1.5: not a whole number", other.drive("import " + scratch_file("bad.json")));
  check_refused(2, "file: ", other.drive("import " + scratch_file("none.json")));
}

TEST(what_was_saved_is_there_after_a_reset_and_in_the_next_process) {
  const std::string memory = scratch_file("memory.bin");
  std::filesystem::remove(memory);
  {
    const Emulated emulated("--memory " + memory);
    json_of(emulated.drive("set profile-velocity 777000"));
    json_of(emulated.drive("save"));
    json_of(emulated.drive("set profile-velocity 5"));
    json_of(emulated.drive("set command-key 21838"));  // unlock
    json_of(emulated.drive("set command-key 21075"));  // reset
    Json after;
    for (int i = 0; i < 50 && after["profile-velocity"] != 777000; ++i)
      after = json_of(emulated.drive("get profile-velocity uptime"));
    TEST_ASSERT_TRUE(after["profile-velocity"] == 777000);
  }
  TEST_ASSERT_EQUAL_UINT64(8192, std::filesystem::file_size(memory));
  {
    const Emulated again("--memory " + memory);
    TEST_ASSERT_TRUE(json_of(again.drive("get profile-velocity"))["profile-velocity"] == 777000);
  }
  {
    std::fstream file(memory, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(41);
    file.put('x');
  }
  {
    const Emulated bad("--memory " + memory);
    const Json status = json_of(bad.drive("status"));
    TEST_ASSERT_TRUE(status["fault"] == "no stored parameters are whole, the defaults are in force");
    check_refused(1, "drive: fault 6310h: no stored parameters are whole, the defaults are in force, a reset",
                  bad.drive("enable"));
    const Json faults = json_of(bad.drive("faults"))["faults"];
    TEST_ASSERT_EQUAL_UINT64(1, faults.size());
    check_keys(faults[0], {"code", "text", "count", "uptime_ms", "position_counts", "demand_counts"});
    TEST_ASSERT_TRUE(json_of(bad.drive("reset"))["state"] == "switch on disabled");
    check_refused(1, "drive: switch on disabled: no fault to reset", bad.drive("reset"));
  }
  std::ofstream(memory) << "short";
  check_refused(2, "--memory: " + memory + ": 5 bytes, a file of 8192, or none yet, is accepted",
                "emulate --memory " + memory);
  check_refused(2, "--memory: /nowhere/x: cannot be written", "emulate --memory /nowhere/x");
}

TEST(a_mode_does_not_make_another_thing_of_a_move) {
  const Emulated emulated;
  json_of(emulated.drive("set mode 6"));
  const Json there = json_of(emulated.drive("move --target 20000"));
  TEST_ASSERT_TRUE(there["position_counts"] == 20000);
  TEST_ASSERT_TRUE(json_of(emulated.drive("status"))["mode"] == 1);
  json_of(emulated.drive("disable"));
  check_refused(1, "drive: switch on disabled: nothing to halt", emulated.drive("halt"));
  check_refused(1, "register: 0041h: Modbus exception 2: no such register", emulated.drive("set statusword 1"));
  check_refused(2, "file: /tmp: a directory", emulated.drive("import /tmp"));
  json_of(emulated.drive("enable"));
  json_of(emulated.drive("set soft-limit-high 70000"));
  json_of(emulated.drive("set soft-limit-low -70000"));
  check_refused(1, "position: register 0044h: above the maximum, 70000 is accepted there",
                emulated.drive("scope --target 80000"));
  TEST_ASSERT_TRUE(json_of(emulated.drive("get scope-state"))["scope-state"] == 0);
}

TEST(a_port_that_is_none_or_silent_is_refused_by_name) {
  check_refused(2, "PORT: /nowhere: cannot be opened", "drive /nowhere status");
  check_refused(2, "PORT: missing", "drive");
  check_refused(2, "--parity: maybe: not known", "drive /nowhere status --parity maybe");
  const Emulated emulated;
  check_refused(1, "register: 0041h: no answer", emulated.drive("status --unit 9"));
}

}  // namespace
