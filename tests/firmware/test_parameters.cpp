// SPDX-License-Identifier: Apache-2.0
#include "firmware/parameters.hpp"

#include "firmware/default_axis.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::firmware;

namespace {

struct Table {
  Parameters parameters = {};
  Table() { parameters.load_defaults(); }
};

TEST(every_address_finds_the_parameter_that_covers_it_and_no_other) {
  for (uint32_t address = 0; address <= UINT16_MAX; ++address) {
    size_t expected = kNoParameter;
    for (size_t i = 0; i < kParameterCount; ++i) {
      const uint32_t first = address_of(kParameters[i].name);
      if (address >= first && address < first + kParameters[i].words()) expected = i;
    }
    if (find_parameter(static_cast<uint16_t>(address)) != expected) TEST_INFO("address", address);
    TEST_ASSERT_EQUAL_UINT64(expected, find_parameter(static_cast<uint16_t>(address)));
  }
}

TEST(every_default_is_in_its_own_range_and_every_parameter_has_a_name) {
  for (const Parameter parameter : kParameters) {
    TEST_INFO("address", address_of(parameter.name));
    uint32_t accepted = 0;
    TEST_ASSERT_TRUE(text_of(parameter).text[0] != '\0');
    if (parameter.access == Access::kReadWrite) {
      TEST_ASSERT_TRUE(in_range(parameter, parameter.maximum, parameter.initial, accepted));
    }
  }
}

// From drive-map.md.
TEST_F(Table, the_maps_fixed_values_are_where_clients_expect_them) {
  TEST_ASSERT_EQUAL_UINT32(0x0100, parameters.get(static_cast<Register>(0x0000)));
  TEST_ASSERT_EQUAL_UINT32(0x12345678, parameters.get(static_cast<Register>(0x0006)));
  TEST_ASSERT_EQUAL_UINT32(0xA5, parameters.get(static_cast<Register>(0x0008)));  // pp, pv, homing, stream
  TEST_ASSERT_EQUAL_UINT32(1, parameters.get(static_cast<Register>(0x0042)));
  TEST_ASSERT_EQUAL_UINT32(3, parameters.get(static_cast<Register>(0x006A)));
  TEST_ASSERT_EQUAL_UINT32(20, parameters.get(static_cast<Register>(0x0072)));
}

// Li's move, 1.7 units of 1e6 counts: 1.2, 20, 600 in SI.
TEST_F(Table, the_default_profile_is_the_reference_moves) {
  TEST_ASSERT_EQUAL_UINT32(1200000, parameters.get(Register::kProfileVelocity));
  TEST_ASSERT_EQUAL_UINT32(20000000, parameters.get(Register::kProfileAcceleration));
  TEST_ASSERT_EQUAL_UINT32(20000000, parameters.get(Register::kProfileDeceleration));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 600e6, parameters.get(Register::kProfileJerk) * kJerkUnit);
}

TEST_F(Table, the_axis_puts_its_limits_over_the_defaults_and_lowers_the_profile_to_them) {
  parameters.adopt({0.001, {1000.7, 5e6, 4e6, 2500.0}, 0.3, 1e15});
  TEST_ASSERT_EQUAL_UINT32(1000, parameters.get(Register::kMaximumVelocity));
  TEST_ASSERT_EQUAL_UINT32(4000000, parameters.get(Register::kMaximumAcceleration));
  TEST_ASSERT_EQUAL_UINT32(2, parameters.get(Register::kMaximumJerk));
  TEST_ASSERT_EQUAL_UINT32(1, parameters.get(Register::kQuickStopDeceleration));  // no register holds less
  TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, parameters.get(Register::kQuickStopJerk));
  TEST_ASSERT_EQUAL_UINT32(1000, parameters.get(Register::kProfileVelocity));
  TEST_ASSERT_EQUAL_UINT32(4000000, parameters.get(Register::kProfileDeceleration));
  TEST_ASSERT_EQUAL_UINT32(2, parameters.get(Register::kProfileJerk));
}

TEST_F(Table, the_delivered_axis_and_the_table_agree) {
  const Parameters before = parameters;
  parameters.adopt(kDefaultAxis);
  for (size_t i = 0; i < kParameterCount; ++i) TEST_ASSERT_EQUAL_UINT32(before.value(i), parameters.value(i));
}

TEST(a_value_out_of_range_names_the_nearest_accepted) {
  Parameter parameter = kParameters[find_parameter(0x0044)];
  parameter.minimum = static_cast<uint32_t>(-10);
  uint32_t accepted = 0;
  TEST_ASSERT_TRUE(in_range(parameter, 20, static_cast<uint32_t>(-10), accepted));
  TEST_ASSERT_TRUE(in_range(parameter, 20, 20, accepted));
  TEST_ASSERT_FALSE(in_range(parameter, 20, static_cast<uint32_t>(-11), accepted));
  TEST_ASSERT_EQUAL_INT32(-10, accepted);
  TEST_ASSERT_FALSE(in_range(parameter, 20, 21, accepted));
  TEST_ASSERT_EQUAL_INT32(20, accepted);
}

}  // namespace
