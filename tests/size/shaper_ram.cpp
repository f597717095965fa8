// SPDX-License-Identifier: Apache-2.0
// Bytes of RAM that a running shaper takes: its object, what the tick walks, its delay lines.
#include "shaper/shaping/shaper.hpp"
#include "tests/support/table.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr double kFrequenciesHz[] = {4.0, 11.0, 40.0};
constexpr double kDampingRatios[] = {0.0, 0.1};
constexpr size_t kMostBytes = 3072;  // at 11 Hz and above

static_assert(sizeof(Shaper) <= 16, "the rest is as large as the design needs");

// The parts of the sum that grow with the design, so that the table can be worked out by hand.
size_t bytes_of(ShaperKind kind, const Mode& mode) {
  ShaperDesign design{};
  TEST_ASSERT_OK(add_shaper(kind, mode, 1e-3, design));
  TEST_ASSERT_EQUAL_UINT32(design.stage_count + design.tap_count + design.line_length(), Shaper::memory_needed(design));
  return sizeof(Shaper) + Shaper::memory_needed(design) * sizeof(LineSample);
}

TEST(every_type_takes_at_most_3_kb_from_11_hz_on) {
  print("\nbytes of RAM of a running shaper, tick 1 ms, tolerance 5 %\n");
  print_left("", 8), print("4 Hz: zeta 0     0.1 11 Hz: zeta 0    0.1 40 Hz: zeta 0    0.1\n");
  for (uint32_t kind = 1; kind < static_cast<uint32_t>(ShaperKind::kCustom); ++kind) {
    print_left(text(static_cast<ShaperKind>(kind)), 4);
    for (const double frequency : kFrequenciesHz) {
      for (const double damping : kDampingRatios) {
        const size_t bytes = bytes_of(static_cast<ShaperKind>(kind), Mode{frequency, damping});
        print_right(static_cast<uint32_t>(bytes), damping == 0.0 ? 14 : 8);
        if (frequency >= 11.0) TEST_ASSERT_AT_MOST_INT64(kMostBytes, bytes);
      }
    }
    print("\n");
  }
}

}  // namespace
