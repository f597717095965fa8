// SPDX-License-Identifier: Apache-2.0
#include "firmware/position_stream.hpp"

#include <cmath>
#include <vector>

#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::firmware;
using stillpoint::testing::Random;

namespace {

constexpr uint32_t kIntervals[] = {2, 3, 7, 10, 16, 100, 799, 800};

// The cubic B-spline by de Boor's recursion over uniform knots: `points` at 0, 1, 2 ..., the value at `t` >= 3 where
// the four around it are those from floor(t) - 3 on.
long double de_boor(const std::vector<int32_t>& points, long double t) {
  const auto knot = static_cast<size_t>(std::floor(t));
  long double d[4];
  for (size_t i = 0; i < 4; ++i) d[i] = points[knot - 3 + i];
  for (size_t level = 1; level <= 3; ++level) {
    for (size_t i = 3; i >= level; --i) {
      const long double left = static_cast<long double>(knot + i) - 3.0L;
      const long double alpha = (t - left) / static_cast<long double>(4 - level);
      d[i] = (1.0L - alpha) * d[i - 1] + alpha * d[i];
    }
  }
  return d[3];
}

struct Streaming {
  PositionStream stream = {};
};

TEST_F(Streaming, is_the_cubic_b_spline_of_its_positions) {
  const uint64_t seed = 20261125;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (const uint32_t interval : kIntervals) {
    TEST_INFO("interval", interval);
    PositionStream one = {};
    std::vector<int32_t> points(4, static_cast<int32_t>(random.integer(-1000000, 1000000)));
    one.start(points[0], interval);
    for (int i = 0; i < 60; ++i) {
      const auto next = static_cast<int32_t>(points.back() + random.integer(-(1 << 24), 1 << 24));
      points.push_back(next);
      TEST_ASSERT_TRUE(one.accept(&next, 1));
    }
    for (uint32_t n = 0; n < 60 * interval; ++n) {
      // Four points of the start are there already; the first tick has the fifth.
      const long double t = 4.0L + static_cast<long double>(n) / interval;
      const long double expected = de_boor(points, t);
      const long double got = static_cast<long double>(one.tick()) / 4294967296.0L;
      TEST_ASSERT_AT_MOST_DOUBLE(1e-9, static_cast<double>(std::fabs(got - expected)));
    }
  }
}

TEST_F(Streaming, an_interval_of_one_passes_what_came) {
  const int32_t positions[] = {5, 7, -3, 1000000};
  TEST_ASSERT_TRUE(stream.accept(positions, 4));
  stream.start(5, 1);
  for (const int32_t position : positions) TEST_ASSERT_EQUAL_INT64(signal_from_counts(position), stream.tick());
  TEST_ASSERT_EQUAL_INT64(signal_from_counts(1000000), stream.tick());
}

TEST_F(Streaming, ends_on_the_last_position_to_the_last_bit) {
  for (const uint32_t interval : kIntervals) {
    PositionStream one = {};
    const int32_t positions[] = {-100, -90, 2000, 777};
    TEST_ASSERT_TRUE(one.accept(positions, 4));
    one.start(-100, interval);
    Signal last = 0;
    for (uint32_t n = 0; n < 8 * interval; ++n) last = one.tick();
    TEST_ASSERT_EQUAL_INT64(signal_from_counts(777), last);
    TEST_ASSERT_AT_LEAST_INT64(1, one.underruns());
  }
}

TEST_F(Streaming, standing_positions_are_no_underrun) {
  stream.start(40, 5);
  for (int n = 0; n < 100; ++n) TEST_ASSERT_EQUAL_INT64(signal_from_counts(40), stream.tick());
  TEST_ASSERT_EQUAL_UINT32(0, stream.underruns());
}

TEST_F(Streaming, takes_all_of_a_write_or_nothing) {
  int32_t many[kStreamPositions + 1] = {};
  TEST_ASSERT_FALSE(stream.accept(many, kStreamPositions + 1));
  TEST_ASSERT_EQUAL_UINT64(0, stream.buffered());
  many[5] = 1 << 28;
  TEST_ASSERT_TRUE(stream.accept(many, 100));
  many[5] = (1 << 28) + 1;
  TEST_ASSERT_FALSE(stream.accept(many, 10));
  TEST_ASSERT_EQUAL_UINT64(100, stream.buffered());
  many[5] = 0;
  TEST_ASSERT_FALSE(stream.accept(many, 29));
  TEST_ASSERT_TRUE(stream.accept(many, 28));
  int32_t first = 1;
  TEST_ASSERT_TRUE(stream.first(first) && first == 0);
  stream.stop();
  TEST_ASSERT_FALSE(stream.first(first));
  const int32_t far[] = {INT32_MAX};
  TEST_ASSERT_TRUE(stream.accept(far, 1));  // where it begins is another's business
}

}  // namespace
