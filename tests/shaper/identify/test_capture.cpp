// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/capture.hpp"
#include "tests/support/test.hpp"

namespace {

using namespace stillpoint;

constexpr size_t kWords = 16;
constexpr bool kBoth[] = {false, true};

struct Rig {
  CaptureWord memory[kWords] = {};
  Capture capture = {};
  int32_t next = 0;

  void tick(uint32_t ticks, bool fresh = true) {
    for (uint32_t i = 0; i < ticks; ++i) {
      const int32_t values[] = {next, -next, 2 * next, 7};
      ++next;
      capture.tick(values, fresh);
    }
  }
};

TEST(begins_with_the_trigger_and_ends_full) {
  Rig rig;
  TEST_ASSERT_OK(rig.capture.start({}, rig.memory, kWords));
  rig.tick(5);
  TEST_ASSERT_EQUAL_ENUM(CaptureState::kWaiting, rig.capture.state());
  rig.capture.trigger();
  rig.tick(15);
  TEST_ASSERT_EQUAL_ENUM(CaptureState::kRunning, rig.capture.state());
  TEST_ASSERT_EQUAL_UINT64(0, rig.capture.record(1.0).count);
  rig.tick(9);
  TEST_ASSERT_EQUAL_ENUM(CaptureState::kFull, rig.capture.state());
  for (uint32_t n = 0; n < kWords; ++n) TEST_ASSERT_EQUAL_INT64(5 + n, rig.capture.value(0, n));
  const Record record = rig.capture.record(0.5);
  TEST_ASSERT_EQUAL_UINT64(kWords, record.count);
  for (uint32_t n = 0; n < kWords; ++n) TEST_ASSERT_TRUE(record.samples[n] == 0.5F * static_cast<float>(5 + n));
}

TEST(keeps_what_came_before_the_trigger) {
  Rig rig;
  CaptureConfig config;
  config.samples = 8;
  config.pre_trigger = 3;
  TEST_ASSERT_OK(rig.capture.start(config, rig.memory, kWords));
  rig.tick(21);
  rig.capture.trigger();
  rig.tick(5);
  TEST_ASSERT_EQUAL_ENUM(CaptureState::kFull, rig.capture.state());
  for (uint32_t n = 0; n < 8; ++n) TEST_ASSERT_EQUAL_INT64(18 + n, rig.capture.value(0, n));
  const Record record = rig.capture.record(1.0);
  for (uint32_t n = 0; n < 8; ++n) TEST_ASSERT_TRUE(record.samples[n] == static_cast<float>(18 + n));
}

// 16 samples, 3 of them before the trigger, and only 5 after it.
TEST(one_that_is_finished_has_what_there_was_from_the_pre_trigger_on) {
  constexpr uint32_t kBefore[] = {2, 3, 10, 40};
  for (const uint32_t before : kBefore) {
    TEST_INFO(before, before);
    Rig rig;
    CaptureConfig config;
    config.pre_trigger = 3;
    TEST_ASSERT_OK(rig.capture.start(config, rig.memory, kWords));
    rig.tick(before);
    rig.capture.finish();
    TEST_ASSERT_EQUAL_ENUM(CaptureState::kWaiting, rig.capture.state());
    rig.capture.trigger();
    rig.tick(5);
    rig.capture.finish();
    TEST_ASSERT_EQUAL_ENUM(CaptureState::kFull, rig.capture.state());
    rig.tick(9);
    const Record record = rig.capture.record(1.0);
    const uint32_t first = before < 3 ? 0 : before - 3;
    TEST_ASSERT_EQUAL_UINT64(before + 5 - first, record.count);
    for (uint32_t n = 0; n < record.count; ++n) TEST_ASSERT_TRUE(record.samples[n] == static_cast<float>(first + n));
  }
}

TEST(a_trigger_before_the_pre_trigger_is_full_makes_the_record_shorter) {
  Rig rig;
  CaptureConfig config;
  config.samples = 8;
  config.pre_trigger = 6;
  TEST_ASSERT_OK(rig.capture.start(config, rig.memory, kWords));
  rig.tick(2);
  rig.capture.trigger();
  rig.tick(2);
  TEST_ASSERT_EQUAL_ENUM(CaptureState::kFull, rig.capture.state());
  const Record record = rig.capture.record(1.0);
  TEST_ASSERT_EQUAL_UINT64(4, record.count);
  for (uint32_t n = 0; n < 4; ++n) TEST_ASSERT_TRUE(record.samples[n] == static_cast<float>(n));
}

TEST(takes_means_or_the_last_of_several_ticks) {
  for (const bool mean : kBoth) {
    Rig rig;
    CaptureConfig config;
    config.channels = 3;
    config.samples = 4;
    config.decimation = 4;
    config.mean = mean;
    TEST_ASSERT_OK(rig.capture.start(config, rig.memory, kWords));
    rig.tick(3);
    rig.capture.trigger();
    rig.tick(16);
    TEST_ASSERT_EQUAL_ENUM(CaptureState::kFull, rig.capture.state());
    // Samples of the ticks 3..6, 7..10 and so on: a mean of first + 1.5, which rounds up.
    for (uint32_t n = 0; n < 4; ++n) {
      const int64_t first = 3 + 4 * int64_t{n};
      TEST_ASSERT_EQUAL_INT64(mean ? first + 2 : first + 3, rig.capture.value(0, n));
      TEST_ASSERT_EQUAL_INT64(mean ? -(first + 1) : -(first + 3), rig.capture.value(1, n));
      TEST_ASSERT_EQUAL_INT64(mean ? 2 * first + 3 : 2 * first + 6, rig.capture.value(2, n));
    }
  }
}

TEST(reports_gaps_saturation_and_overruns) {
  Rig rig;
  CaptureConfig config;
  config.lowest = -1000;
  config.highest = 10;
  TEST_ASSERT_OK(rig.capture.start(config, rig.memory, kWords));
  rig.capture.trigger();
  rig.tick(3);
  rig.tick(2, false);
  rig.capture.trigger();
  rig.tick(11);
  TEST_ASSERT_EQUAL_ENUM(CaptureState::kFull, rig.capture.state());
  rig.capture.trigger();
  TEST_ASSERT_EQUAL_UINT32(2, rig.capture.flaws().gaps);
  TEST_ASSERT_EQUAL_UINT32(6, rig.capture.flaws().saturated);  // 10 to 15
  TEST_ASSERT_EQUAL_UINT32(2, rig.capture.flaws().overruns);
  TEST_ASSERT_EQUAL_INT64(2, rig.capture.value(0, 3));
  TEST_ASSERT_EQUAL_INT64(2, rig.capture.value(0, 4));
  TEST_ASSERT_EQUAL_INT64(5, rig.capture.value(0, 5));
  rig.capture.stop();
  rig.tick(1);
  TEST_ASSERT_EQUAL_ENUM(CaptureState::kIdle, rig.capture.state());
}

TEST(refuses_by_name) {
  Rig rig;
  const auto refusal = [&](auto change) {
    CaptureConfig config;
    change(config);
    return rig.capture.start(config, rig.memory, kWords);
  };
  Status status = refusal([](CaptureConfig& c) { c.channels = 5; });
  TEST_ASSERT_EQUAL_ENUM(Quantity::kChannels, status.quantity);
  TEST_ASSERT_EQUAL_ENUM(Error::kAboveMaximum, status.error);
  status = refusal([](CaptureConfig& c) { c.channels = 0; });
  TEST_ASSERT_EQUAL_ENUM(Error::kBelowMinimum, status.error);
  status = refusal([](CaptureConfig& c) { c.samples = 17; });
  TEST_ASSERT_EQUAL_ENUM(Quantity::kSamples, status.quantity);
  TEST_ASSERT_TRUE(status.accepted == 16.0);
  status = refusal([](CaptureConfig& c) { c.pre_trigger = 16; });
  TEST_ASSERT_EQUAL_ENUM(Quantity::kPreTrigger, status.quantity);
  TEST_ASSERT_TRUE(status.accepted == 15.0);
  status = refusal([](CaptureConfig& c) { c.decimation = 0; });
  TEST_ASSERT_EQUAL_ENUM(Quantity::kDecimation, status.quantity);
  status = refusal([](CaptureConfig& c) {
    c.decimation = 6;
    c.mean = true;
  });
  TEST_ASSERT_EQUAL_ENUM(Error::kNotAvailable, status.error);
  TEST_ASSERT_TRUE(status.accepted == 4.0);
  TEST_ASSERT_EQUAL_ENUM(CaptureState::kIdle, rig.capture.state());
}

}  // namespace
