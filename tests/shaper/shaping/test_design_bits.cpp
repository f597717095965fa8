// SPDX-License-Identifier: Apache-2.0
// The same bits everywhere: a hash over the taps of one design of every kind at a few modes, the same for every
// compiler and on the chip. It changes only with the designs themselves; say why in the commit.
#include "shaper/shaping/design.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

class Hash {  // FNV-1a, 64 bits
 public:
  void add(uint32_t word) {
    for (int i = 0; i < 4; ++i) state_ = (state_ ^ ((word >> (8 * i)) & 0xFFU)) * UINT64_C(0x100000001B3);
  }
  uint64_t value() const { return state_; }

 private:
  uint64_t state_ = UINT64_C(0xCBF29CE484222325);
};

constexpr ImpulseTrain kTrain = {4, {{0.0, 0.4}, {0.0123, 0.3}, {0.0301, -0.1}, {0.0456, 0.4}}};

uint64_t hash_of_every_kind(const Mode& mode, double tolerance) {
  Hash hash;
  for (uint32_t kind = 0; kind < kShaperKinds; ++kind) {
    TEST_INFO("kind", kind);
    ShaperDesign design{};
    const ShaperSpec spec{static_cast<ShaperKind>(kind), mode, tolerance, 0.0, &kTrain};
    TEST_ASSERT_OK(add_shaper(spec, 1e-3, design));
    hash.add(design.stage_count);
    for (uint32_t i = 0; i < design.stage_count; ++i) hash.add(design.stages[i].tap_count);
    for (uint32_t i = 0; i < design.tap_count; ++i) {
      hash.add(design.taps[i].delay_ticks);
      hash.add(static_cast<uint32_t>(design.taps[i].gain));
    }
  }
  return hash.value();
}

}  // namespace

TEST(every_kind_has_the_same_bits_at_the_papers_mode) {
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0xB31FF84693A93A4A), hash_of_every_kind(Mode{11.0, 0.11}, 0.05));
}

TEST(every_kind_has_the_same_bits_undamped) {
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0x5FB28CB91CECB797), hash_of_every_kind(Mode{4.0, 0.0}, 0.02));
}

TEST(every_kind_has_the_same_bits_where_the_band_is_fitted) {
  TEST_ASSERT_EQUAL_UINT64(UINT64_C(0xC1CF3E507C34E0D6), hash_of_every_kind(Mode{83.0, 0.05}, 0.03));
}
