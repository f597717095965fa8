// SPDX-License-Identifier: Apache-2.0
// Instructions, stack and memory of one identification from 2048 samples. See counting.hpp.
#include "shaper/identify/identify.hpp"
#include "tests/bench/background.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::bench;

constexpr size_t kSamples = 2048;
constexpr double kRateHz = 1000.0;

// Memory for capture and identification, and the stack beside it. Between two calls of Meanwhile: see designs.cpp.
constexpr size_t kMostBytes = 32 * 1024;
constexpr uint32_t kMostStackBytes = 6 * 1024;
constexpr uint32_t kLongestGap = 50000000;

float samples[kSamples];
IdentifyMemory<kSamples> memory;
static_assert(sizeof(samples) + sizeof(memory) <= kMostBytes, "what a chip has to spare");

struct Truth {
  double frequency_hz;
  double damping_ratio;
  double amplitude;
};

struct Scenario {
  const char* name;
  size_t modes;
  Truth mode[3];
  Finding finding;
};

constexpr Scenario kScenarios[] = {
    {"the paper's arm", 1, {{11.0, 0.11, 1.0}}, Finding::kFound},
    {"one mode", 1, {{37.3, 0.01, 1.0}}, Finding::kFound},
    {"two modes", 2, {{11.0, 0.03, 1.0}, {33.0, 0.02, 0.5}}, Finding::kFound},
    {"three modes", 3, {{11.0, 0.03, 1.0}, {33.0, 0.02, 0.5}, {80.0, 0.01, 0.3}}, Finding::kFound},
    {"noise", 0, {}, Finding::kNoMode},
};

void fill(const Scenario& scenario) {
  testing::Random random(1);
  for (size_t n = 0; n < kSamples; ++n) {
    double sum = 0.02 * random.between(-1.0, 1.0);
    for (size_t k = 0; k < scenario.modes; ++k) {
      const Truth& truth = scenario.mode[k];
      const double phase = 6.283185307179586 * truth.frequency_hz * static_cast<double>(n) / kRateHz;
      sum += truth.amplitude * math::exp(-truth.damping_ratio * phase) *
             math::cos(phase * math::sqrt(1.0 - math::square(truth.damping_ratio)));
    }
    samples[n] = static_cast<float>(sum);
  }
}

TEST_F(Counting, one_identification_of_every_kind) {
  print("\nmillions of instructions of identify() from 2048 samples, the most between two calls of Meanwhile; stack\n");
  print_left("record", 18), print("     total       gap     stack  modes\n");
  for (const Scenario& scenario : kScenarios) {
    fill(scenario);
    IdentifyConfig config;
    config.rate_hz = kRateHz;
    Identification found{};
    Paint::lay();
    Watch watch;
    watch.last = instructions_now();
    TEST_ASSERT_OK(identify({samples, kSamples}, config, IdentifyScratch(memory), found, {Watch::look_at, &watch}));
    watch.look();
    const uint32_t stack = Paint::bytes_used();
    print_left(scenario.name, 18);
    print_right(static_cast<uint32_t>(watch.total / 1000000), 10), print_right(watch.gap / 1000000, 10);
    print_right(stack, 10), print_right(static_cast<uint32_t>(found.mode_count), 7), print("\n");
    TEST_ASSERT_EQUAL_ENUM(scenario.finding, found.finding);
    TEST_ASSERT_EQUAL_UINT64(scenario.modes, found.mode_count);
    TEST_ASSERT_AT_MOST_INT64(kLongestGap, watch.gap);
    TEST_ASSERT_AT_MOST_INT64(kMostStackBytes, stack);
  }
  print("bytes: record "), print(value_of(static_cast<uint32_t>(sizeof(samples))));
  print(", working memory "), print(value_of(static_cast<uint32_t>(sizeof(memory)))), print("\n");
}

}  // namespace
