// SPDX-License-Identifier: Apache-2.0
// The STM32F405's flash against registers in memory, which do what silicon does as far as plain memory can: they take
// what is written, and are busy or in error when the test says so. What does not take anything is the emulator (see
// tests/hil/test_stored_parameters.cpp).
#include "firmware/target/stm32f405/flash.hpp"

#include <initializer_list>

#include "tests/support/test.hpp"

namespace {

using namespace stillpoint::stm32f405;

constexpr uint32_t kCaches = Flash::kAcrLatency5 | Flash::kAcrInstructionCache | Flash::kAcrDataCache;

struct Controller {
  Flash flash{};
  Iwdg watchdog{};

  Controller() {
    flash.ACR = kCaches;
    flash.CR = Flash::kCrLock;
  }
};

}  // namespace

TEST_F(Controller, an_erase_unlocks_feeds_the_watchdog_and_leaves_the_flash_locked_and_the_caches_as_they_were) {
  TEST_ASSERT_TRUE(erase_sector(flash, watchdog, 11));
  TEST_ASSERT_EQUAL_UINT32(0xCDEF89AB, flash.KEYR);
  TEST_ASSERT_EQUAL_UINT32(0xAAAA, watchdog.KR);
  TEST_ASSERT_EQUAL_UINT32(0x80000000, flash.CR);
  TEST_ASSERT_EQUAL_UINT32(kCaches, flash.ACR);
}

TEST_F(Controller, a_flash_that_is_unlocked_is_not_given_its_keys) {
  flash.CR = 0;
  TEST_ASSERT_TRUE(erase_sector(flash, watchdog, 10));
  TEST_ASSERT_EQUAL_UINT32(0, flash.KEYR);
  TEST_ASSERT_EQUAL_UINT32(0x80000000, flash.CR);
}

TEST_F(Controller, a_word_is_programmed_and_read_back) {
  Register at = UINT32_MAX;
  TEST_ASSERT_TRUE(program_word(flash, at, 0x12345678));
  TEST_ASSERT_EQUAL_UINT32(0x12345678, at);
  TEST_ASSERT_EQUAL_UINT32(0x80000000, flash.CR);
}

TEST_F(Controller, a_flash_that_stays_busy_fails_in_bounded_time_and_nothing_is_written) {
  flash.SR = 1u << 16;
  Register at = UINT32_MAX;
  TEST_ASSERT_FALSE(program_word(flash, at, 0));
  TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, at);
  TEST_ASSERT_FALSE(erase_sector(flash, watchdog, 10));
  TEST_ASSERT_EQUAL_UINT32(0, flash.KEYR);
}

TEST_F(Controller, each_error_fails_the_operation) {
  for (const uint32_t bit : {1u, 4u, 5u, 6u, 7u}) {
    TEST_INFO("bit", bit);
    flash.SR = 1u << bit;
    Register at = UINT32_MAX;
    TEST_ASSERT_FALSE(program_word(flash, at, 0));
    TEST_ASSERT_FALSE(erase_sector(flash, watchdog, 10));
    TEST_ASSERT_EQUAL_UINT32(0x80000000, flash.CR);
    TEST_ASSERT_EQUAL_UINT32(kCaches, flash.ACR);
  }
}

// RM0090 3.9.7, bit by bit: SER, SNB, PSIZE, STRT, LOCK; table 5: sectors 10 and 11.
TEST(the_registers_fields_are_the_manuals) {
  TEST_ASSERT_EQUAL_UINT32(0x0000025A, Flash::kCrSectorErase | Flash::kCrWords | 11u << Flash::kCrSectorShift);
  TEST_ASSERT_EQUAL_UINT32(0x00010000, Flash::kCrStart);
  TEST_ASSERT_EQUAL_UINT32(0x00000201, Flash::kCrProgram | Flash::kCrWords);
  TEST_ASSERT_EQUAL_UINT32(0x080E0000, ParameterFlash::kBegin + ParameterFlash::kPageBytes);
}
