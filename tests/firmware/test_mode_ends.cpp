// SPDX-License-Identifier: Apache-2.0
// What a stop, a fault or a change of mode ends, it ends: nothing of it comes back by itself.
#include "tests/firmware/modes402.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::testing;

TEST_F(Streamed, a_fault_of_the_stream_is_over_once_it_is_reset) {
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0089, 1));
  TEST_ASSERT_EQUAL_UINT32(0, send_positions({0, 2000000}));
  control(0x1F);
  step(200);
  TEST_ASSERT_EQUAL_UINT32(0xFF01, get(0x0010));
  for (const uint32_t policy : std::initializer_list<uint32_t>{0, 1}) {
    TEST_INFO("policy", policy);
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0089, policy));
    control(0x80);
    enable();
    const auto stands = static_cast<int32_t>(get_wide(0x004A));
    TEST_ASSERT_EQUAL_UINT32(0, send_positions({stands, stands, stands, stands + 10, stands + 20, stands + 20}));
    control(0x1F);
    step(200);
    TEST_ASSERT_EQUAL_UINT32(0, get(0x0010));
    TEST_ASSERT_EQUAL_INT32(stands + 20, get_wide(0x004A));
    control(0x0F);
    step(50);
    control(0x00);
  }
}

}  // namespace
