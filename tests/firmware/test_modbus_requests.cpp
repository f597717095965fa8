// SPDX-License-Identifier: Apache-2.0
// What a client gets for its requests, through the whole drive: exceptions in the specification's order, quantities,
// the register map's promises.
#include "tests/firmware/rig.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr uint32_t kIllegalAddress = 2;
constexpr uint32_t kIllegalValue = 3;
constexpr uint32_t kBusy = 6;

TEST_F(Rig, functions_3_and_4_read_the_same_space) {
  for (const uint8_t function : Bytes{3, 4}) {
    const Bytes response = exchange(read_request(0x0006, 2, function));
    TEST_ASSERT_TRUE(response == Bytes({function, 4, 0x12, 0x34, 0x56, 0x78}));
  }
}

TEST_F(Rig, a_read_takes_1_to_125_registers) {
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, exception_in(exchange(read_request(0x0100, 0))));
  TEST_ASSERT_EQUAL_UINT32(0, exception_in(exchange(read_request(0x0100, 1))));
  TEST_ASSERT_EQUAL_UINT32(0, exception_in(exchange(read_request(0x0100, 34))));  // the longest run that is mapped
  TEST_ASSERT_EQUAL_UINT32(kIllegalAddress, exception_in(exchange(read_request(0x0100, 125))));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, exception_in(exchange(read_request(0x0100, 126))));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, exception_in(exchange(read_request(0x0100, 65535))));
}

TEST_F(Rig, a_write_takes_1_to_123_registers) {
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, exception_in(exchange({16, 0x01, 0x00, 0, 0, 0})));
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0100, {0}));
  TEST_ASSERT_EQUAL_UINT32(kIllegalAddress, write(0x0100, std::vector<uint16_t>(123, 0)));
  Bytes too_many{16, 0x01, 0x00, 0, 124, 248};
  too_many.resize(6 + 246);  // what fits into a frame
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, exception_in(exchange(too_many)));
}

TEST_F(Rig, a_byte_count_or_length_that_does_not_fit_is_exception_3) {
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, exception_in(exchange({16, 0x01, 0x00, 0, 1, 3, 0, 0})));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, exception_in(exchange({16, 0x01, 0x00, 0, 1, 2, 0})));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, exception_in(exchange({16, 0x01, 0x00, 0, 1, 2, 0, 0, 0})));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, exception_in(exchange({16, 0x01})));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, exception_in(exchange({3, 0x00, 0x00, 0})));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, exception_in(exchange({6, 0x01, 0x00, 0, 1, 0})));
}

// Quantity before address, address before value, value before state.
TEST_F(Rig, exceptions_come_in_the_specifications_order) {
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, exception_in(exchange(read_request(0xFFFF, 0))));
  TEST_ASSERT_EQUAL_UINT32(kIllegalAddress, exception_in(exchange(read_request(0xFFFF, 1))));
  TEST_ASSERT_EQUAL_UINT32(kIllegalAddress, exception_in(exchange(read_request(0xFFFF, 2))));
  TEST_ASSERT_EQUAL_UINT32(kIllegalAddress, write(0x0042, {99, 0}));  // 0043 is read-only, 99 no mode
  // 0058 is locked and 0 out of its range; with a good value the lock shows.
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write(0x0058, {0, 0}));
  TEST_ASSERT_EQUAL_UINT32(kBusy, write(0x0058, {0, 5}));
  TEST_ASSERT_EQUAL_UINT32(0x8000, get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(0x0058, get(0x0013));
}

TEST_F(Rig, unmapped_is_exception_2_wherever_it_lies_in_the_request) {
  TEST_ASSERT_EQUAL_UINT32(kIllegalAddress, exception_in(exchange(read_request(0x0009, 2))));
  TEST_ASSERT_EQUAL_UINT32(kIllegalAddress, exception_in(exchange(read_request(0x000A, 1))));
  TEST_ASSERT_EQUAL_UINT32(kIllegalAddress, write_single(0x000A, 0));
  TEST_ASSERT_EQUAL_UINT32(kIllegalAddress, write_single(0x0041, 0));
  TEST_ASSERT_EQUAL_UINT32(kIllegalAddress, write(0x006A, {3, 0}));
}

TEST_F(Rig, half_of_a_32_bit_value_is_exception_3_with_6_and_with_16) {
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, 0x11223344));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write_single(0x0044, 1));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write_single(0x0045, 1));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write(0x0042, {1}) == 0 ? write(0x0045, {1}) : 0);
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write(0x0060, {0, 5, 0}));
  TEST_ASSERT_EQUAL_UINT32(0x11223344, get_wide(0x0044));
  TEST_ASSERT_EQUAL_UINT32(1200000, get_wide(0x0060));
}

TEST_F(Rig, a_write_of_several_registers_is_all_or_nothing) {
  // 0060 velocity is good, 0062 acceleration is not.
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write(0x0060, {0, 5, 0, 0}));
  TEST_ASSERT_EQUAL_UINT32(1200000, get_wide(0x0060));
  TEST_ASSERT_EQUAL_UINT32(0x8500, get(0x0012));
  TEST_ASSERT_EQUAL_UINT32(0x0062, get(0x0013));
  TEST_ASSERT_EQUAL_UINT32(1, get_wide(0x0016));
  // 0064 is good, 0066 is locked.
  TEST_ASSERT_EQUAL_UINT32(kBusy, write(0x0064, {0, 7, 0, 7}));
  TEST_ASSERT_EQUAL_UINT32(20000000, get_wide(0x0064));
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0060, {0, 5, 0, 6, 0, 7}));
  TEST_ASSERT_EQUAL_UINT32(5, get_wide(0x0060));
  TEST_ASSERT_EQUAL_UINT32(6, get_wide(0x0062));
  TEST_ASSERT_EQUAL_UINT32(7, get_wide(0x0064));
}

TEST_F(Rig, signed_values_keep_their_sign) {
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, -5));
  TEST_ASSERT_EQUAL_INT32(-5, get_wide(0x0044));
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0044, INT32_MIN));
  TEST_ASSERT_EQUAL_INT32(INT32_MIN, get_wide(0x0044));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write_single(0x006A, 0xFFFF));  // -1 is no profile type
}

TEST_F(Rig, what_this_firmware_cannot_do_is_refused_as_a_value) {
  struct Row {
    uint32_t address;
    uint32_t good;
    uint32_t bad;
  };
  constexpr Row kRows[] = {
      {0x0042, 3, 2},       {0x0042, 6, 7},       {0x0042, 8, 9},   {0x006A, 1, 2}, {0x006A, 3, 2},  {0x0106, 3, 14},
      {0x0106, 12, 14},     {0x011E, 2, 14},      {0x0106, 13, 15}, {0x0100, 4, 5}, {0x0101, 7, 8},  {0x0104, 0, 30001},
      {0x0105, 2000, 2001}, {0x0107, 3750, 5001}, {0x0108, 0, 1},   {0x0137, 1, 2}, {0x0080, 37, 36}};
  for (const Row& row : kRows) {
    TEST_INFO("address", row.address);
    TEST_INFO("value", row.bad);
    TEST_ASSERT_EQUAL_UINT32(0, write_single(row.address, row.good));
    TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write_single(row.address, row.bad));
    TEST_ASSERT_EQUAL_UINT32(row.good, get(row.address));
  }
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write_single(0x0130, 4));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write_single(0x0130, 0));
}

TEST_F(Rig, a_mode_is_unused_or_of_half_a_hertz_and_more) {
  for (const uint32_t address : {0x0102U, 0x011AU}) {
    for (const uint32_t good : {5000U, 3000000U, 0U, 110000U}) {
      TEST_ASSERT_EQUAL_UINT32(0, write_wide(address, good));
      TEST_ASSERT_EQUAL_UINT32(good, get_wide(address));
    }
    for (const uint32_t bad : {1U, 4999U}) {
      TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write_wide(address, bad));
      expect_refused(0x8500, address);
      TEST_ASSERT_EQUAL_UINT32(5000, get_wide(0x0016));
      TEST_ASSERT_EQUAL_UINT32(110000, get_wide(address));
    }
  }
}

TEST_F(Rig, a_maximum_is_the_range_of_what_follows_it) {
  const uint32_t maximum = get_wide(0x0058);
  TEST_ASSERT_EQUAL_UINT32(10000000, maximum);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0060, maximum));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write_wide(0x0060, int64_t{maximum} + 1));
  TEST_ASSERT_EQUAL_UINT32(maximum, get_wide(0x0016));
  unlock();
  // Raised and used in the same request.
  std::vector<uint16_t> words = {0x00B7, 0x1B00, 0x3B9A, 0xCA00, 0x3B9A, 0xCA00};  // 12e6, 1e9, 1e9
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0058, words));
  TEST_ASSERT_EQUAL_UINT32(12000000, get_wide(0x0058));
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0060, int64_t{maximum} + 1));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 12e6, axis.config().maximum.velocity);
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 1e12, axis.config().maximum.jerk);
}

TEST_F(Rig, the_key_opens_the_locked_registers_for_a_minute) {
  TEST_ASSERT_EQUAL_UINT32(kBusy, write_wide(0x0058, 5000000));
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write_single(0x0014, 0x1234));
  TEST_ASSERT_EQUAL_UINT32(kBusy, write_wide(0x0058, 5000000));
  unlock();
  TEST_ASSERT_EQUAL_UINT32(2, get(0x0015));
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0058, 5000000));
  step(59000);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x0058, 6000000));
  step(1000);
  TEST_ASSERT_EQUAL_UINT32(kBusy, write_wide(0x0058, 7000000));
  TEST_ASSERT_EQUAL_UINT32(6000000, get_wide(0x0058));
}

TEST_F(Rig, save_defaults_and_reset_need_the_key) {
  for (const uint32_t key : {0x5341U, 0x4C44U, 0x5253U}) {
    TEST_INFO("key", key);
    TEST_ASSERT_EQUAL_UINT32(kBusy, write_single(0x0014, key));
    TEST_ASSERT_EQUAL_UINT32(0x8000, get(0x0012));
    TEST_ASSERT_EQUAL_UINT32(0x0014, get(0x0013));
  }
}

TEST_F(Rig, write_only_registers_read_0_and_reads_change_nothing) {
  TEST_ASSERT_TRUE(read(0x0010, 6) == std::vector<uint16_t>({0, 0, 0, 0, 0, 0}));
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0130));
  TEST_ASSERT_EQUAL_UINT32(0x0240 | 0x10, status());
}

TEST_F(Rig, a_broadcast_is_executed_in_silence) {
  send(framed({0, 6, 0x01, 0x00, 0x00, 0x03}));
  step(20);
  TEST_ASSERT_TRUE(line.from_drive.empty());
  TEST_ASSERT_EQUAL_UINT32(3, get(0x0100));
  send(framed({0, 6, 0x01, 0x00, 0x00, 0x09}));  // refused, in silence too
  step(20);
  TEST_ASSERT_TRUE(line.from_drive.empty());
  TEST_ASSERT_EQUAL_UINT32(3, get(0x0100));
}

TEST_F(Rig, the_client_is_heard_before_the_servo_link_is_up) {
  send(framed({1, 3, 0x00, 0x00, 0x00, 0x01}));
  step_silent(10);
  TEST_ASSERT_TRUE(answer() == Bytes({3, 2, 0x01, 0x00}));
}

TEST_F(Rig, noise_never_moves_or_enables_anything) {
  Random random(11);
  for (int burst = 0; burst < 3000; ++burst) {
    Bytes noise;
    for (int64_t n = random.integer(1, 20); n > 0; --n) noise.push_back(static_cast<uint8_t>(random.next()));
    if (random.integer(0, 1) == 0) noise[0] = 1;
    send(random.integer(0, 1) == 0 ? noise : framed(noise));
    step(5);
  }
  for (const hal::ServoCommand& command : servo.commands) {
    TEST_ASSERT_FALSE(command.enabled);
    TEST_ASSERT_EQUAL_INT64(0, command.setpoint);
  }
}

TEST_F(Rig, the_watchdog_is_fed_while_ticks_or_the_own_timer_come_and_starves_without_both) {
  uint32_t meals = dog.meals;
  step(10);
  TEST_ASSERT_AT_LEAST_INT64(meals + 10, dog.meals);
  meals = dog.meals;
  step_silent(10);
  TEST_ASSERT_AT_LEAST_INT64(meals + 9, dog.meals);
  drive.poll();
  meals = dog.meals;
  for (int i = 0; i < 1000; ++i) drive.poll();
  TEST_ASSERT_EQUAL_UINT32(meals, dog.meals);
}

TEST_F(Rig, a_quick_stop_comes_down_with_the_axiss_limits) {
  unlock();
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x005C, 1000));
  TEST_ASSERT_EQUAL_UINT32(1000, get_wide(0x0056));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 1e6, axis.config().quick_stop_jerk);
  TEST_ASSERT_EQUAL_UINT32(0, write_wide(0x005A, 5000));
  TEST_ASSERT_EQUAL_UINT32(5000, get_wide(0x0066));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 5000.0, axis.config().quick_stop_deceleration);
  TEST_ASSERT_EQUAL_UINT32(kIllegalValue, write_wide(0x0056, 1001));
  // One request may raise it and what it is under.
  TEST_ASSERT_EQUAL_UINT32(0, write(0x0056, {0, 7000, 0, 9000, 0, 6000, 0, 8000}));
  TEST_ASSERT_EQUAL_UINT32(7000, get_wide(0x0056));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 7e6, axis.config().quick_stop_jerk);
  TEST_ASSERT_EQUAL_UINT32(5000, get_wide(0x0066));
}

}  // namespace
