// SPDX-License-Identifier: Apache-2.0
#include "firmware/fault_log.hpp"

#include <string.h>

#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::firmware;

namespace {

struct Logging {
  FaultMemory memory = {};
  FaultLog log = {};
  LoopSnapshot loop = {};

  Logging() {
    memset(&memory, 0xA7, sizeof memory);  // what a chip wakes up with
    log.begin(&memory);
  }

  void fault(FaultCode code, uint32_t uptime_ms, int32_t position = 0, int32_t demand = 0) {
    loop.fault = code;
    ++loop.fault_count;
    loop.position = signal_from_counts(position);
    loop.axis.setpoint = signal_from_counts(demand);
    log.follow(loop, uptime_ms);
    log.follow(loop, uptime_ms + 1);  // seen again: the same one
  }
  uint32_t wide(uint32_t age, uint32_t offset) const {
    return (uint32_t{log.word(age, offset)} << 16) | log.word(age, offset + 1);
  }
};

TEST_F(Logging, begins_empty_in_memory_that_is_none) {
  for (uint32_t age = 0; age < kFaultEntries; ++age) {
    for (uint32_t offset = 0; offset < 16; ++offset) TEST_ASSERT_EQUAL_UINT32(0, log.word(age, offset));
  }
}

TEST_F(Logging, keeps_what_where_and_when_the_newest_first) {
  fault(FaultCode::kLinkSilent, 70000, -5, 6);
  fault(FaultCode::kFollowingError, 0x12345678, 100000, -100000);
  TEST_ASSERT_EQUAL_UINT32(0x8611, log.word(0, 0));
  TEST_ASSERT_EQUAL_UINT32(1, log.word(0, 1));
  TEST_ASSERT_EQUAL_UINT32(0x12345678, wide(0, 2));
  TEST_ASSERT_EQUAL_INT32(100000, wide(0, 4));
  TEST_ASSERT_EQUAL_INT32(-100000, wide(0, 6));
  TEST_ASSERT_EQUAL_UINT32(0, log.word(0, 8));
  TEST_ASSERT_EQUAL_UINT32(0x8130, log.word(1, 0));
  TEST_ASSERT_EQUAL_UINT32(70000, wide(1, 2));
  TEST_ASSERT_EQUAL_INT32(-5, wide(1, 4));
  TEST_ASSERT_EQUAL_UINT32(0, log.word(2, 0));
}

TEST_F(Logging, counts_each_fault_and_forgets_the_oldest_of_seventeen) {
  for (uint32_t i = 0; i < 17; ++i) fault(i % 2 == 0 ? FaultCode::kLinkSilent : FaultCode::kFeedbackMissing, i);
  for (uint32_t age = 0; age < kFaultEntries; ++age) {
    const uint32_t i = 16 - age;
    TEST_ASSERT_EQUAL_UINT32(i, wide(age, 2));
    TEST_ASSERT_EQUAL_UINT32(i % 2 == 0 ? 0x8130 : 0x7300, log.word(age, 0));
    TEST_ASSERT_EQUAL_UINT32(i / 2 + 1, log.word(age, 1));
  }
}

TEST_F(Logging, outlasts_a_reset_but_not_a_flipped_bit) {
  fault(FaultCode::kLinkSilent, 1);
  FaultLog after = {};
  after.begin(&memory);
  TEST_ASSERT_EQUAL_UINT32(0x8130, after.word(0, 0));
  loop = {};
  ++loop.fault_count;
  loop.fault = FaultCode::kLinkSilent;
  after.follow(loop, 7);
  TEST_ASSERT_EQUAL_UINT32(2, after.word(0, 1));
  auto* const bytes = reinterpret_cast<uint8_t*>(&memory);
  for (size_t bit = 0; bit < 8 * sizeof memory; bit += 5) {
    FaultMemory flipped = memory;
    reinterpret_cast<uint8_t*>(&flipped)[bit / 8] ^= static_cast<uint8_t>(1U << bit % 8);
    FaultLog none = {};
    none.begin(&flipped);
    TEST_ASSERT_EQUAL_UINT32(0, none.word(0, 0));
  }
  memset(bytes, 0, sizeof memory);
  FaultLog zeros = {};
  zeros.begin(&memory);
  TEST_ASSERT_EQUAL_UINT32(0, zeros.word(0, 0));
  TEST_ASSERT_TRUE(memory.crc != 0);
}

TEST(a_drive_without_memory_for_it_has_no_history) {
  FaultLog log = {};
  log.begin(nullptr);
  LoopSnapshot loop = {};
  loop.fault = FaultCode::kLinkSilent;
  loop.fault_count = 1;
  log.follow(loop, 1);
  TEST_ASSERT_EQUAL_UINT32(0, log.word(0, 0));
}

}  // namespace
