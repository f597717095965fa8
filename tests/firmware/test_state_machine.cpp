// SPDX-License-Identifier: Apache-2.0
#include "firmware/state_machine.hpp"

#include <stddef.h>

#include "tests/support/test.hpp"

using namespace stillpoint::firmware;

namespace {

constexpr DriveState kStates[] = {
    DriveState::kNotReady,         DriveState::kSwitchOnDisabled, DriveState::kReady,         DriveState::kSwitchedOn,
    DriveState::kOperationEnabled, DriveState::kQuickStopActive,  DriveState::kFaultReaction, DriveState::kFault};

// IEC 61800-7-201, a row a state: what shutdown, switch on, enable operation, disable voltage, quick stop lead to.
// N not ready, D switch-on disabled, R ready, S switched on, O operation enabled, Q quick stop, r fault reaction,
// F fault.
constexpr char kLetters[] = "NDRSOQrF";
constexpr const char* kRows[] = {"NNNNN", "RDDDD", "RSSDD", "RSODD", "RSODQ", "QQQDQ", "rrrrr", "FFFFF"};
constexpr uint16_t kWords[] = {0x06, 0x07, 0x0F, 0x00, 0x02};

TEST(every_command_in_every_state_leads_where_the_standard_says) {
  for (size_t state = 0; state < 8; ++state) {
    for (size_t command = 0; command < 5; ++command) {
      TEST_INFO("state", state);
      TEST_INFO("command", command);
      const DriveState next = next_state(kStates[state], command_of(kWords[command]));
      TEST_ASSERT_EQUAL_INT32(kRows[state][command], kLetters[static_cast<size_t>(next)]);
    }
  }
}

// Masks and values of the register map, and of 6041h.
TEST(every_state_reads_as_the_standard_says) {
  struct Row {
    uint16_t mask;
    uint16_t value;
  };
  constexpr Row kStatus[] = {{0x4F, 0x00}, {0x4F, 0x40}, {0x6F, 0x21}, {0x6F, 0x23},
                             {0x6F, 0x27}, {0x6F, 0x07}, {0x4F, 0x0F}, {0x4F, 0x08}};
  for (size_t is = 0; is < 8; ++is) {
    for (size_t as = 0; as < 8; ++as) {
      TEST_INFO("state", is);
      TEST_INFO("read as", as);
      const bool matches = (status_bits(kStates[is]) & kStatus[as].mask) == kStatus[as].value;
      TEST_ASSERT_EQUAL_INT32(is == as, matches);
    }
  }
}

// 6040h: disable voltage xx0x, quick stop x01x, shutdown x110, switch on 0111, enable operation 1111.
TEST(every_pattern_of_the_low_bits_is_one_command) {
  for (uint32_t word = 0; word < 0x10000; ++word) {
    DriveCommand expected = DriveCommand::kDisableVoltage;
    if ((word & 0x6) == 0x2) expected = DriveCommand::kQuickStop;
    if ((word & 0x7) == 0x6) expected = DriveCommand::kShutdown;
    if ((word & 0xF) == 0x7) expected = DriveCommand::kSwitchOn;
    if ((word & 0xF) == 0xF) expected = DriveCommand::kEnableOperation;
    if (command_of(static_cast<uint16_t>(word)) != expected) TEST_INFO("word", word);
    TEST_ASSERT_TRUE(command_of(static_cast<uint16_t>(word)) == expected);
  }
}

}  // namespace
