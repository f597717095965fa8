// SPDX-License-Identifier: Apache-2.0
// Instructions and stack of one design of every shaper. See counting.hpp.
#include "shaper/shaping/design.hpp"
#include "tests/bench/background.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::bench;

constexpr double kTickS = 0.001;
constexpr double kFrequenciesHz[] = {11.0, 37.3, 90.0};
constexpr double kDampingRatios[] = {0.0, 0.1, 0.3};

// Between two calls of Meanwhile, in which the firmware feeds its watchdog (2 s) and hears its client: a third of a
// second at 168 MHz and two cycles an instruction. Stack: half of what linker.ld keeps.
constexpr uint32_t kLongestGap = 50000000;
constexpr uint32_t kMostStackBytes = 18 * 1024;

struct Row {
  uint32_t least = UINT32_MAX;
  uint32_t most = 0;
  uint32_t gap = 0;
  uint32_t stack = 0;
  uint32_t refused = 0;
};

constexpr uint32_t kUnit = 1000;  // of the table

void add(const ShaperSpec& spec, Row& row) {
  static ShaperDesign design;
  design = ShaperDesign{};
  Watch watch;
  watch.last = instructions_now();
  const Status status = add_shaper(spec, kTickS, design, nullptr, Meanwhile{Watch::look_at, &watch});
  watch.look();
  const auto thousands = static_cast<uint32_t>((watch.total + kUnit - 1) / kUnit);
  if (thousands < row.least) row.least = thousands;
  if (thousands > row.most) row.most = thousands;
  if (watch.gap > row.gap) row.gap = watch.gap;
  if (!status.ok()) ++row.refused;
}

Row measured(ShaperKind kind) {
  Row row;
  Paint::lay();
  for (const double frequency : kFrequenciesHz) {
    for (const double damping : kDampingRatios) add(ShaperSpec{kind, {frequency, damping}, 0.0, 0.0, nullptr}, row);
  }
  row.stack = Paint::bytes_used();
  return row;
}

TEST_F(Counting, one_design_of_every_type) {
  print(
      "\nthousands of instructions of add_shaper at 11, 37.3 and 90 Hz, damping 0, 0.1 and 0.3, tolerance 5 %;\n"
      "the most between two calls of Meanwhile; bytes of stack; how many of the nine are refused\n");
  print_left("shaper", 10), print("     least      most       gap     stack  refused\n");
  uint32_t gap = 0, stack = 0;
  for (uint32_t kind = 1; kind < static_cast<uint32_t>(ShaperKind::kCustom); ++kind) {
    const Row row = measured(static_cast<ShaperKind>(kind));
    print_left(text(static_cast<ShaperKind>(kind)), 10);
    print_right(row.least, 10), print_right(row.most, 10), print_right((row.gap + kUnit - 1) / kUnit, 10);
    print_right(row.stack, 10), print_right(row.refused, 9), print("\n");
    if (row.gap > gap) gap = row.gap;
    if (row.stack > stack) stack = row.stack;
  }
  TEST_ASSERT_AT_MOST_INT64(kLongestGap, gap);
  TEST_ASSERT_AT_MOST_INT64(kMostStackBytes, stack);
}

}  // namespace
