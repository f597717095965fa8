// SPDX-License-Identifier: Apache-2.0
#include "firmware/servo_link.hpp"

#include <vector>

#include "tests/support/random.hpp"
#include "tests/support/test.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::servo_link;
using Bytes = std::vector<uint8_t>;

Bytes bytes_of(const hal::ServoFeedback& sync) {
  Bytes bytes(kSyncBytes);
  encode_sync(sync, bytes.data());
  return bytes;
}

Bytes bytes_of(const Reply& reply) {
  Bytes bytes(kReplyBytes);
  encode_reply(reply, bytes.data());
  return bytes;
}

void check_same(const hal::ServoFeedback& expected, const hal::ServoFeedback& actual) {
  TEST_ASSERT_EQUAL_INT64(expected.position, actual.position);
  TEST_ASSERT_EQUAL_INT32(expected.acceleration, actual.acceleration);
  TEST_ASSERT_EQUAL_UINT32(expected.sequence, actual.sequence);
  TEST_ASSERT_TRUE(expected.valid == actual.valid);
  TEST_ASSERT_TRUE(expected.commit == actual.commit);
}

hal::ServoFeedback random_sync(testing::Random& random) {
  return {static_cast<int64_t>(random.next()), static_cast<int32_t>(random.next()),
          static_cast<uint16_t>(random.next()), random.next() % 2 == 0, random.next() % 2 == 0};
}

// Every sync that a reader finds in the bytes.
std::vector<hal::ServoFeedback> read_all(SyncReader& reader, const Bytes& bytes) {
  std::vector<hal::ServoFeedback> found;
  hal::ServoFeedback sync{};
  for (const uint8_t byte : bytes) {
    if (reader.push(byte, sync)) found.push_back(sync);
  }
  return found;
}

// One in 65,536 of the pieces that begin with a header has the CRC of a frame.
bool holds_a_frame_before(size_t end, const Bytes& line) {
  hal::ServoFeedback unused{};
  for (size_t i = 0; i < end; ++i) {
    if (decode_sync(&line[i], unused)) return true;
  }
  return false;
}

void append(Bytes& to, const Bytes& more) { to.insert(to.end(), more.begin(), more.end()); }

}  // namespace

TEST(a_sync_lies_on_the_wire_as_written_down) {
  const Bytes bytes = bytes_of(hal::ServoFeedback{INT64_C(0x0807060504030201), 0x0C0B0A09, 0x1234, true, true});
  const Bytes expected = {0xA5, 0x03, 0x34, 0x12, 0x01, 0x02, 0x03, 0x04, 0x05,
                          0x06, 0x07, 0x08, 0x09, 0x0A, 0x0B, 0x0C, 0x1C, 0xAA};
  for (size_t i = 0; i < kSyncBytes; ++i) TEST_ASSERT_EQUAL_UINT32(expected[i], bytes[i]);
}

TEST(a_reply_lies_on_the_wire_as_written_down) {
  const Bytes bytes = bytes_of(Reply{{INT64_C(-2), true}, 0xBEEF});
  const Bytes expected = {0x5A, 0x01, 0xEF, 0xBE, 0xFE, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x75, 0xAF};
  for (size_t i = 0; i < kReplyBytes; ++i) TEST_ASSERT_EQUAL_UINT32(expected[i], bytes[i]);
}

TEST(every_field_survives_the_way_there) {
  testing::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const hal::ServoFeedback sent = random_sync(random);
    hal::ServoFeedback got{};
    TEST_ASSERT_TRUE(decode_sync(bytes_of(sent).data(), got));
    check_same(sent, got);
  }
}

TEST(every_field_survives_the_way_back_ends_of_the_range_included) {
  const int64_t setpoints[] = {INT64_MIN, INT64_MAX, 0, -1, 1, INT64_C(1700000) << 32};
  for (const int64_t setpoint : setpoints) {
    for (const bool enabled : {false, true}) {
      Reply got{};
      TEST_ASSERT_TRUE(decode_reply(bytes_of(Reply{{setpoint, enabled}, 65535}).data(), got));
      TEST_ASSERT_EQUAL_INT64(setpoint, got.command.setpoint);
      TEST_ASSERT_TRUE(got.command.enabled == enabled);
      TEST_ASSERT_EQUAL_UINT32(65535, got.sequence);
    }
  }
}

TEST(any_wrong_bit_is_found_and_nothing_taken) {
  const Bytes right = bytes_of(hal::ServoFeedback{INT64_C(123456789012), -7, 99, true, false});
  for (size_t bit = 0; bit < 8 * kSyncBytes; ++bit) {
    Bytes wrong = right;
    wrong[bit / 8] = static_cast<uint8_t>(wrong[bit / 8] ^ (1u << (bit % 8)));
    hal::ServoFeedback untouched{42, 43, 44, false, true};
    TEST_INFO("bit", bit);
    TEST_ASSERT_FALSE(decode_sync(wrong.data(), untouched));
    check_same({42, 43, 44, false, true}, untouched);
  }
}

TEST(a_reply_is_not_taken_for_a_sync_nor_the_other_way_round) {
  SyncReader syncs;
  hal::ServoFeedback sync{};
  for (const uint8_t byte : bytes_of(Reply{{1, true}, 1})) TEST_ASSERT_FALSE(syncs.push(byte, sync));
  ReplyReader replies;
  Reply reply{};
  for (const uint8_t byte : bytes_of(hal::ServoFeedback{1, 1, 1, true, true})) {
    TEST_ASSERT_FALSE(replies.push(byte, reply));
  }
}

TEST(a_frame_is_found_after_any_garbage_even_of_headers) {
  testing::Random random(2);
  int rounds_looked_at = 0;
  for (int round = 0; round < 500; ++round) {
    Bytes line;
    for (int64_t i = random.integer(0, 60); i > 0; --i) {
      line.push_back(random.next() % 3 == 0 ? kSyncHeader : static_cast<uint8_t>(random.next()));
    }
    const size_t garbage = line.size();
    const hal::ServoFeedback first = random_sync(random);
    const hal::ServoFeedback second = random_sync(random);
    append(line, bytes_of(first));
    append(line, bytes_of(second));
    if (holds_a_frame_before(garbage, line)) continue;
    ++rounds_looked_at;
    SyncReader reader;
    const std::vector<hal::ServoFeedback> found = read_all(reader, line);
    TEST_INFO("round", round);
    TEST_ASSERT_EQUAL_UINT32(2, found.size());
    check_same(first, found[0]);
    check_same(second, found[1]);
    TEST_ASSERT_EQUAL_UINT32(garbage, reader.bytes_dropped());
  }
  TEST_ASSERT_AT_LEAST_INT64(495, rounds_looked_at);
}

TEST(a_lost_byte_costs_its_own_frame_only) {
  testing::Random random(3);
  for (size_t lost = 0; lost < kSyncBytes; ++lost) {
    const hal::ServoFeedback syncs[] = {random_sync(random), random_sync(random), random_sync(random)};
    Bytes line = bytes_of(syncs[0]);
    line.erase(line.begin() + static_cast<std::ptrdiff_t>(lost));
    append(line, bytes_of(syncs[1]));
    append(line, bytes_of(syncs[2]));
    SyncReader reader;
    const std::vector<hal::ServoFeedback> found = read_all(reader, line);
    TEST_INFO("lost", lost);
    TEST_ASSERT_EQUAL_UINT32(2, found.size());
    check_same(syncs[1], found[0]);
    check_same(syncs[2], found[1]);
  }
}

TEST(a_frame_ends_with_its_last_byte_not_with_the_next_frame) {
  SyncReader reader;
  hal::ServoFeedback sync{};
  const Bytes bytes = bytes_of(hal::ServoFeedback{5, 6, 7, true, true});
  for (size_t i = 0; i + 1 < kSyncBytes; ++i) TEST_ASSERT_FALSE(reader.push(bytes[i], sync));
  TEST_ASSERT_TRUE(reader.push(bytes.back(), sync));
}
