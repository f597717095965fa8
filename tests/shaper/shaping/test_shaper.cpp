// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/shaper.hpp"

#include "tests/support/test.hpp"

#ifndef STILLPOINT_CHIP_TESTS
#include <vector>
#endif

using namespace stillpoint;
using stillpoint::testing::Random;

namespace {

struct Line {
  Shaper shaper = {};
  LineSample memory[4096] = {};

  void configure(const ShaperDesign& design, Signal position) {
    TEST_ASSERT_OK(shaper.configure(design, memory, 4096, position));
  }
};

// One for all cases: a chip has room for one.
Line line = {};

ShaperDesign designed(ShaperKind kind, double frequency_hz, double damping_ratio) {
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(kind, Mode{frequency_hz, damping_ratio}, 1e-3, design));
  return design;
}

}  // namespace

TEST(without_stages_the_input_passes) {
  Shaper shaper = {};
  TEST_ASSERT_EQUAL_INT64(-17, shaper.tick(-17));
  TEST_ASSERT_EQUAL_INT64(INT64_MAX, shaper.tick(INT64_MAX));
}

TEST(a_filled_line_hands_on_any_standing_position_exactly) {
  const Signal positions[] = {0, 1, -1, INT64_MIN, signal_from_counts(INT32_MAX), signal_from_counts(-1) + 12345};
  for (unsigned i = 0; i < 6; ++i) {
    line.configure(designed(ShaperKind::kZvd, 11.0, 0.11), positions[i]);
    for (int tick = 0; tick < 100; ++tick) TEST_ASSERT_EQUAL_INT64(positions[i], line.shaper.tick(positions[i]));
  }
}

TEST(a_step_comes_out_as_the_taps_and_ends_on_itself) {
  const ShaperDesign design = designed(ShaperKind::kZv, 11.0, 0.11);
  line.configure(design, 0);
  const Signal step = INT64_C(1) << kGainFractionBits;
  for (uint32_t tick = 0; tick < 60; ++tick) {
    int64_t expected = 0;
    for (uint32_t k = 0; k < 3; ++k) expected += design.taps[k].delay_ticks <= tick ? design.taps[k].gain : 0;
    TEST_ASSERT_EQUAL_INT64(expected, line.shaper.tick(step));
  }
}

TEST(a_line_too_short_is_refused_and_the_shaper_before_it_runs_on) {
  line.configure(designed(ShaperKind::kZv, 11.0, 0.0), 5);
  const ShaperDesign longer = designed(ShaperKind::kZv, 1.0, 0.0);
  const Status status = line.shaper.configure(longer, line.memory, 100, 9);
  TEST_ASSERT_REFUSED(kLineTooShort, kDelay, status);
  TEST_ASSERT_DOUBLE_WITHIN(0, static_cast<double>(Shaper::memory_needed(longer)), status.value);
  TEST_ASSERT_DOUBLE_WITHIN(0, 100, status.accepted);
  TEST_ASSERT_EQUAL_INT64(5, line.shaper.tick(5));
  TEST_ASSERT_EQUAL_UINT32(46 + 1, line.shaper.design().line_length());
}

TEST(any_stream_with_the_largest_steps_ends_on_its_last_value_exactly) {
  const uint64_t seed = 31;
  TEST_INFO("seed", seed);
  Random random(seed);
  for (int i = 0; i < 20; ++i) {
    TEST_INFO("case", i);
    ShaperDesign design = designed(random.next() % 2 == 0 ? ShaperKind::kZv : ShaperKind::kZvd,
                                   random.between(5.0, 300.0), random.between(0.0, 0.3));
    TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, Mode{random.between(5.0, 300.0), 0.1}, 1e-3, design));
    line.configure(design, 0);
    int64_t counts = 0;
    for (int tick = 0; tick < 300; ++tick) {
      const int64_t low = counts - INT32_MAX < INT32_MIN ? INT32_MIN : counts - INT32_MAX;
      const int64_t high = counts + INT32_MAX > INT32_MAX ? INT32_MAX : counts + INT32_MAX;
      counts = random.next() % 4 == 0 ? (random.next() % 2 == 0 ? low : high) : random.integer(low, high);
      line.shaper.tick(signal_from_counts(static_cast<int32_t>(counts)));
    }
    const Signal last = signal_from_counts(static_cast<int32_t>(counts));
    for (uint32_t tick = 0; tick + 1 < design.length_ticks(); ++tick) line.shaper.tick(last);
    for (int tick = 0; tick < 5; ++tick) TEST_ASSERT_EQUAL_INT64(last, line.shaper.tick(last));
  }
}

TEST(a_signal_that_wraps_is_shaped_like_any_other) {
  // GIVEN the same motion twice, once across the end of the position range WHEN both are shaped THEN the outputs stay
  // apart by what the inputs are apart, to the last bit
  const uint64_t seed = 8;
  TEST_INFO("seed", seed);
  Random random(seed);
  const ShaperDesign design = designed(ShaperKind::kCv2, 37.3, 0.05);
  const auto moved = [](Signal signal, uint64_t by) { return static_cast<Signal>(static_cast<uint64_t>(signal) + by); };
  const uint64_t offsets[] = {UINT64_C(1) << 63, (UINT64_C(1) << 63) - 12345, random.next()};
  for (const uint64_t offset : offsets) {
    Shaper other = {};
    TEST_ASSERT_OK(line.shaper.configure(design, line.memory, 2048, 0));
    TEST_ASSERT_OK(other.configure(design, line.memory + 2048, 2048, moved(0, offset)));
    Signal input = 0;
    for (int tick = 0; tick < 300; ++tick) {
      input += random.integer(-1000, 2000000) << 32;
      TEST_ASSERT_EQUAL_INT64(moved(line.shaper.tick(input), offset), other.tick(moved(input, offset)));
    }
  }
}

#ifndef STILLPOINT_CHIP_TESTS

TEST_HOST(each_output_is_the_exact_convolution_rounded_once_a_stage) {
  const uint64_t seed = 6;
  TEST_INFO("seed", seed);
  Random random(seed);
  __extension__ using Exact = __int128;
  const ShaperDesign design = designed(ShaperKind::kZv, 37.3, 0.05);
  line.configure(design, 0);
  std::vector<Signal> inputs;
  for (int tick = 0; tick < 20000; ++tick) {
    inputs.push_back(static_cast<Signal>(random.next()) >> (1 + random.next() % 40));
    const Signal output = line.shaper.tick(inputs.back());
    Exact sum = Exact{1} << (kGainFractionBits - 1);
    for (uint32_t k = 0; k < design.tap_count; ++k) {
      const int at = tick - static_cast<int>(design.taps[k].delay_ticks);
      if (at >= 0) sum += static_cast<Exact>(inputs[static_cast<size_t>(at)]) * design.taps[k].gain;
    }
    TEST_ASSERT_EQUAL_INT64(static_cast<int64_t>(sum >> kGainFractionBits), output);
  }
}

#endif
