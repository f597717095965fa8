// SPDX-License-Identifier: Apache-2.0
// What the commands make of the drive's codes, and of which refusal they are.
#include "sim/cli/drive_texts.hpp"

#include <fstream>
#include <regex>
#include <set>
#include <string>

#include "sim/cli/drive_commands.hpp"
#include "sim/cli/drive_registers.hpp"
#include "sim/cli/drive_scope.hpp"
#include "sim/cli/drive_status.hpp"
#include "sim/refusal.hpp"
#include "tests/firmware/drive402.hpp"
#include "tests/sim/refusals.hpp"
#include "tests/sim/rig_port.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

struct Asked : Enabled402 {
  RigPort port{*this};

  std::string said_of_set(const std::string& name, int64_t value) {
    return refusal_of([&] { cli::write_parameter(port, cli::parameter_named(name), value); }).said;
  }
};

// From the header itself, so that a code without a text does not go unseen.
std::set<int> codes_in_header(const std::string& pattern) {
  std::ifstream header(STILLPOINT_REGISTERS);
  const std::regex code(pattern);
  std::set<int> codes;
  for (std::string line; std::getline(header, line);) {
    std::smatch found;
    if (std::regex_search(line, found, code)) codes.insert(std::stoi(found[1], nullptr, 16));
  }
  return codes;
}

TEST(every_reason_and_every_fault_of_the_register_map_has_words_of_its_own) {
  const std::set<int> reasons = codes_in_header("kReason\\w+ = 0x([0-9A-F]{4});");
  TEST_ASSERT_AT_LEAST_INT64(16, reasons.size());
  std::set<std::string> texts;
  for (const int reason : reasons) {
    const std::string text = cli::text_of_reason(static_cast<uint16_t>(reason));
    TEST_INFO("reason", text);
    TEST_ASSERT_TRUE(text.find("not known here") == std::string::npos);
    const bool says = text.find("accepted") != std::string::npos;
    TEST_ASSERT_TRUE(says || cli::names_a_value(static_cast<uint16_t>(reason)));
    texts.insert(text);
  }
  TEST_ASSERT_EQUAL_UINT64(reasons.size(), texts.size());
  const std::set<int> faults = codes_in_header("k\\w+ = 0x([0-9A-F]{4}), +// ");
  TEST_ASSERT_AT_LEAST_INT64(11, faults.size());
  for (const int fault : {0x8130, 0x8611, 0xFF01}) TEST_ASSERT_TRUE(faults.count(fault) == 1);
}

TEST(a_refusal_is_not_told_by_the_reason_of_one_before_it) {
  Asked drive;
  const uint32_t most = drive.get_wide(0x0058);
  check_says("drive: register 0060h: out of range, " + std::to_string(most) + " is accepted there",
             drive.said_of_set("profile-velocity", int64_t{most} + 1));
  check_says("register: 0041h: Modbus exception 2: no such register", drive.said_of_set("statusword", 1));
  check_says("register: 0014h: Modbus exception 3: not a value", drive.said_of_set("command-key", 5));
  check_says("drive: register 0014h: locked, accepted after", drive.said_of_set("command-key", 0x5341));
  check_says("register: 0014h: Modbus exception 3: not a value", drive.said_of_set("command-key", 5));
  check_says("drive: register 0042h: this firmware cannot do it", drive.said_of_set("mode", 2));
  check_says("drive: register 0042h: out of range, 1 is accepted there", drive.said_of_set("mode", -2));
  check_says("drive: register 005Ah: locked", drive.said_of_set("maximum-acceleration", 10));
}

TEST(what_is_refused_for_the_state_names_the_state) {
  Asked drive;
  cli::unlock(drive.port);
  cli::start_move(drive.port, {2000000, false});
  check_says("drive: register 0058h: the axis moves, or something waits to take effect, accepted at rest",
             drive.said_of_set("maximum-velocity", 1000000));
  check_says("drive: register 0014h: the drive is enabled", drive.said_of_set("command-key", 0x5341));
}

TEST(a_fault_is_told_by_its_code_and_words_with_what_is_accepted) {
  Asked drive;
  drive.drive.note_fault(firmware::FaultCode::kTickOverrun);
  drive.step(500);
  check_says("drive: fault 6100h: a tick had not ended when the next was due, a reset of the fault is accepted first",
             refusal_of([&] { cli::enable_drive(drive.port); }).said);
}

TEST(the_history_has_each_fault_with_its_count_the_newest_first) {
  Asked drive;
  TEST_ASSERT_TRUE(cli::fault_history(drive.port).empty());
  cli::start_move(drive.port, {12345, false});
  drive.step(2000);
  for (const auto fault :
       {firmware::FaultCode::kTickOverrun, firmware::FaultCode::kStackOverflow, firmware::FaultCode::kTickOverrun}) {
    drive.drive.note_fault(fault);
    drive.step(500);
    cli::reset_drive(drive.port);
  }
  const std::vector<cli::FaultRecord> history = cli::fault_history(drive.port);
  TEST_ASSERT_EQUAL_UINT64(3, history.size());
  const uint16_t codes[] = {0x6100, 0x6101, 0x6100};
  const uint16_t counts[] = {2, 1, 1};
  for (size_t i = 0; i < 3; ++i) {
    TEST_ASSERT_EQUAL_UINT32(codes[i], history[i].code);
    TEST_ASSERT_EQUAL_UINT32(counts[i], history[i].count);
    TEST_ASSERT_EQUAL_INT64(12345, history[i].position_counts);
  }
  TEST_ASSERT_TRUE(history[0].uptime_ms > history[1].uptime_ms && history[1].uptime_ms > history[2].uptime_ms);
}

TEST(a_scope_whose_move_is_refused_is_stopped) {
  Asked drive;
  drive.unlock();
  TEST_ASSERT_EQUAL_UINT32(0, drive.write(0x0074, {0xFFFF, 0, 1, 0}));
  cli::ScopeRequest request;
  check_says("accepted",
             refusal_of([&] {
               cli::capture_scope(drive.port, request, [&] { cli::start_move(drive.port, {1000000, false}); });
             }).said);
  TEST_ASSERT_EQUAL_UINT32(0, drive.get(0x0301));
  // And one during whose waiting something goes wrong.
  check_says("fault 6100h", refusal_of([&] {
                              cli::capture_scope(
                                  drive.port, request, [] {},
                                  [&] {
                                    TEST_ASSERT_EQUAL_UINT32(1, drive.get(0x0301));
                                    throw sim::bad_argument("fault 6100h", "", "");
                                  });
                            }).said);
  TEST_ASSERT_EQUAL_UINT32(0, drive.get(0x0301));
}

}  // namespace
