// SPDX-License-Identifier: Apache-2.0
#include "firmware/crc16.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint::firmware;

namespace {

constexpr uint8_t kDigits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};

// The published check value of CRC-16/MODBUS, at compile time and at run time.
static_assert(crc16(kDigits, sizeof kDigits) == 0x4B37);

TEST(crc16_has_the_published_check_value) { TEST_ASSERT_EQUAL_UINT32(0x4B37, crc16(kDigits, sizeof kDigits)); }

TEST(crc16_of_nothing_is_the_initial_value) { TEST_ASSERT_EQUAL_UINT32(0xFFFF, crc16(kDigits, 0)); }

TEST(crc16_goes_on_where_it_stopped) {
  for (size_t split = 0; split <= sizeof kDigits; ++split) {
    TEST_INFO("split", split);
    const uint16_t head = crc16(kDigits, split);
    TEST_ASSERT_EQUAL_UINT32(0x4B37, crc16(kDigits + split, sizeof kDigits - split, head));
  }
}

// The serial line guide's own example: 02 07 goes out with the CRC 41 12.
TEST(crc16_matches_the_serial_line_guide) {
  constexpr uint8_t kExample[] = {0x02, 0x07};
  TEST_ASSERT_EQUAL_UINT32(0x1241, crc16(kExample, sizeof kExample));
}

TEST(crc16_over_a_frame_with_its_crc_is_zero) {
  constexpr uint8_t kFrame[] = {0x02, 0x07, 0x41, 0x12};
  TEST_ASSERT_EQUAL_UINT32(0, crc16(kFrame, sizeof kFrame));
}

}  // namespace
