// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/ring_buffer.hpp"

#include "tests/support/test.hpp"

using stillpoint::RingBuffer;
using stillpoint::testing::Random;

TEST(a_peek_shows_the_oldest_and_leaves_it) {
  RingBuffer<int, 2> ring;
  int element = 7;
  TEST_ASSERT_FALSE(ring.peek(element));
  TEST_ASSERT_EQUAL_INT32(7, element);
  TEST_ASSERT_TRUE(ring.push(1) && ring.push(2));
  TEST_ASSERT_TRUE(ring.peek(element) && ring.size() == 2);
  TEST_ASSERT_EQUAL_INT32(1, element);
  TEST_ASSERT_TRUE(ring.pop(element) && ring.peek(element));
  TEST_ASSERT_EQUAL_INT32(2, element);
}

TEST(a_new_ring_buffer_is_empty_and_gives_nothing) {
  RingBuffer<int32_t, 3> ring;
  int32_t value = 7;
  TEST_ASSERT_TRUE(ring.empty());
  TEST_ASSERT_FALSE(ring.pop(value));
  TEST_ASSERT_EQUAL_INT32(7, value);
}

TEST(a_full_ring_buffer_refuses_and_keeps_what_it_has) {
  RingBuffer<int32_t, 2> ring;
  TEST_ASSERT_TRUE(ring.push(1));
  TEST_ASSERT_TRUE(ring.push(2));
  TEST_ASSERT_TRUE(ring.full());
  TEST_ASSERT_FALSE(ring.push(3));
  int32_t value = 0;
  TEST_ASSERT_TRUE(ring.pop(value));
  TEST_ASSERT_EQUAL_INT32(1, value);
  TEST_ASSERT_TRUE(ring.pop(value));
  TEST_ASSERT_EQUAL_INT32(2, value);
  TEST_ASSERT_FALSE(ring.pop(value));
}

TEST(clearing_forgets_everything) {
  RingBuffer<int32_t, 2> ring;
  TEST_ASSERT_TRUE(ring.push(1));
  ring.clear();
  TEST_ASSERT_TRUE(ring.empty());
  TEST_ASSERT_TRUE(ring.push(2));
  TEST_ASSERT_TRUE(ring.push(3));
}

TEST(elements_come_out_in_the_order_they_went_in_whatever_the_interleaving) {
  const uint64_t seed = 11;
  TEST_INFO("seed", seed);
  Random random(seed);
  RingBuffer<uint32_t, 5> ring;
  uint32_t pushed = 0;
  uint32_t popped = 0;
  for (int i = 0; i < 5000; ++i) {
    if (random.next() % 2 == 0) {
      const bool has_room = pushed - popped < 5;
      TEST_ASSERT_TRUE(ring.push(pushed) == has_room);
      if (has_room) ++pushed;
    } else {
      uint32_t value = 0;
      const bool has_element = pushed != popped;
      TEST_ASSERT_TRUE(ring.pop(value) == has_element);
      if (has_element) TEST_ASSERT_EQUAL_UINT32(popped++, value);
    }
    TEST_ASSERT_EQUAL_UINT32(pushed - popped, ring.size());
  }
}
