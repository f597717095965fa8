// SPDX-License-Identifier: Apache-2.0
// Every refusal of add_shaper: by name, with a value that is accepted, the design untouched.
#include "shaper/shaping/design.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

constexpr double kTick = 1e-3;
constexpr double kNan = __builtin_nan("");
constexpr double kInfinity = __builtin_inf();
constexpr double kHopeless[] = {kNan, kInfinity, -kInfinity};

ShaperSpec spec_of(ShaperKind kind) { return ShaperSpec{kind, Mode{20.0, 0.1}, 0.05, 0.375, nullptr}; }

bool is_same(const ShaperDesign& a, const ShaperDesign& b) {
  bool same = a.stage_count == b.stage_count && a.tap_count == b.tap_count;
  for (uint32_t i = 0; same && i < a.stage_count; ++i) {
    same = a.stages[i].first_tap == b.stages[i].first_tap && a.stages[i].tap_count == b.stages[i].tap_count;
  }
  for (uint32_t i = 0; same && i < a.tap_count; ++i) {
    same = a.taps[i].delay_ticks == b.taps[i].delay_ticks && a.taps[i].gain == b.taps[i].gain;
  }
  return same;
}

// A design with a mode in it already, which a refusal must leave as it is.
struct OneModeDesigned {
  ShaperDesign design = {};
  ShaperDesign before = {};

  OneModeDesigned() {
    TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, Mode{11.0, 0.11}, kTick, design));
    before = design;
  }
  Status refused(const ShaperSpec& spec, double tick_s = kTick) {
    const Status status = add_shaper(spec, tick_s, design);
    TEST_ASSERT_FALSE(status.ok());
    TEST_ASSERT_TRUE(is_same(before, design));
    return status;
  }
  void accept(const ShaperSpec& spec, double tick_s = kTick) {
    ShaperDesign other{};
    TEST_ASSERT_OK(add_shaper(spec, tick_s, other));
  }
  // Refused with this value of the custom train.
  Status refused_train(const ImpulseTrain& train) {
    ShaperSpec spec = spec_of(ShaperKind::kCustom);
    spec.train = &train;
    return refused(spec);
  }
  void accept_train(const ImpulseTrain& train) {
    ShaperSpec spec = spec_of(ShaperKind::kCustom);
    spec.train = &train;
    accept(spec);
  }
};

// ZV, one of each other way onto the ticks.
constexpr ShaperKind kKinds[] = {ShaperKind::kZv, ShaperKind::kZvddd, ShaperKind::kMzv,
                                 ShaperKind::kEi, ShaperKind::kCv2,   ShaperKind::kUmZv};

}  // namespace

TEST_F(OneModeDesigned, what_is_not_finite_is_refused_by_name) {
  for (const double hopeless : kHopeless) {
    ShaperSpec spec = spec_of(ShaperKind::kEi);
    spec.mode.frequency_hz = hopeless;
    TEST_ASSERT_REFUSED(kNotFinite, kFrequency, refused(spec));
    spec = spec_of(ShaperKind::kCv1);
    spec.mode.damping_ratio = hopeless;
    TEST_ASSERT_REFUSED(kNotFinite, kDampingRatio, refused(spec));
    spec = spec_of(ShaperKind::kEi2);
    spec.tolerance = hopeless;
    TEST_ASSERT_REFUSED(kNotFinite, kTolerance, refused(spec));
    spec = spec_of(ShaperKind::kMzv);
    spec.spacing = hopeless;
    TEST_ASSERT_REFUSED(kNotFinite, kSpacing, refused(spec));
    TEST_ASSERT_REFUSED(kNotFinite, kTick, refused(spec_of(ShaperKind::kZv), hopeless));
    TEST_ASSERT_REFUSED(kNotFinite, kImpulseTime, refused_train(ImpulseTrain{2, {{0.0, 0.5}, {hopeless, 0.5}}}));
    TEST_ASSERT_REFUSED(kNotFinite, kImpulseAmplitude, refused_train(ImpulseTrain{2, {{0.0, hopeless}, {0.1, 0.5}}}));
  }
}

TEST_F(OneModeDesigned, a_value_out_of_its_range_is_refused_with_the_end_of_the_range) {
  struct Row {
    double ShaperSpec::*value;
    double low;
    double high;
    Quantity quantity;
  };
  constexpr Row kRows[] = {{&ShaperSpec::tolerance, kMinTolerance, kMaxTolerance, Quantity::kTolerance},
                           {&ShaperSpec::spacing, kMinSpacing, kMaxSpacing, Quantity::kSpacing}};
  for (const Row& row : kRows) {
    ShaperSpec spec = spec_of(ShaperKind::kMzv);
    constexpr double kSigns[] = {-1.0, 1.0};
    for (const double sign : kSigns) {
      spec.*row.value = sign < 0.0 ? row.low * 0.999 : row.high * 1.001;
      const Status status = refused(spec);
      TEST_ASSERT_EQUAL_ENUM(sign < 0.0 ? Error::kBelowMinimum : Error::kAboveMaximum, status.error);
      TEST_ASSERT_EQUAL_ENUM(row.quantity, status.quantity);
      TEST_ASSERT_DOUBLE_WITHIN(0.0, spec.*row.value, status.value);
      TEST_ASSERT_DOUBLE_WITHIN(0.0, sign < 0.0 ? row.low : row.high, status.accepted);
      spec.*row.value = status.accepted;
      accept(spec);
    }
  }
  constexpr double kDampings[] = {-0.001, 0.301, 1.0, 1e300};
  for (const double damping : kDampings) {
    ShaperSpec spec = spec_of(ShaperKind::kZv);
    spec.mode.damping_ratio = damping;
    const Status status = refused(spec);
    TEST_ASSERT_EQUAL_ENUM(Quantity::kDampingRatio, status.quantity);
    spec.mode.damping_ratio = status.accepted;
    accept(spec);
  }
}

TEST_F(OneModeDesigned, an_unknown_kind_is_refused) {
  TEST_ASSERT_REFUSED(kAboveMaximum, kKind, refused(spec_of(static_cast<ShaperKind>(kShaperKinds))));
  TEST_ASSERT_REFUSED(kAboveMaximum, kKind, refused(spec_of(static_cast<ShaperKind>(255))));
}

TEST_F(OneModeDesigned, a_frequency_too_high_names_one_that_is_accepted) {
  for (const ShaperKind kind : kKinds) {
    TEST_INFO("kind", static_cast<uint32_t>(kind));
    constexpr double kTooHigh[] = {499.0, 1e4, 1e300};
    for (const double high : kTooHigh) {
      ShaperSpec spec = spec_of(kind);
      spec.mode.frequency_hz = high;
      const Status status = refused(spec);
      TEST_ASSERT_EQUAL_ENUM(Error::kAboveMaximum, status.error);
      TEST_ASSERT_EQUAL_ENUM(Quantity::kFrequency, status.quantity);
      TEST_ASSERT_AT_LEAST_DOUBLE(100.0, status.accepted);
      TEST_ASSERT_AT_MOST_DOUBLE(490.0 * (1 + 1e-12), status.accepted);
      spec.mode.frequency_hz = status.accepted;
      accept(spec);
    }
  }
}

// 0.490 a tick through the highest zero: 5.2824/4 of the mode.
TEST_F(OneModeDesigned, the_highest_zero_sets_the_highest_frequency) {
  ShaperSpec spec = spec_of(ShaperKind::kCv2);
  spec.mode = Mode{400.0, 0.0};
  const Status status = refused(spec);
  TEST_ASSERT_DOUBLE_RELATIVE(1e-5, 490.0 * 4.0 / 5.2824, status.accepted);
}

TEST_F(OneModeDesigned, a_frequency_too_low_names_one_that_is_accepted) {
  for (const ShaperKind kind : kKinds) {
    TEST_INFO("kind", static_cast<uint32_t>(kind));
    constexpr double kTooLow[] = {1e-4, 1e-12, 5e-324};
    for (const double low : kTooLow) {
      ShaperSpec spec = spec_of(kind);
      spec.mode.frequency_hz = low;
      const Status status = refused(spec);
      TEST_ASSERT_EQUAL_ENUM(Error::kBelowMinimum, status.error);
      TEST_ASSERT_EQUAL_ENUM(Quantity::kFrequency, status.quantity);
      spec.mode.frequency_hz = status.accepted;
      ShaperDesign longest{};
      TEST_ASSERT_OK(add_shaper(spec, kTick, longest));
      for (uint32_t i = 0; i < longest.stage_count; ++i) {
        const Stage& stage = longest.stages[i];
        TEST_ASSERT_AT_MOST_INT64(kMaxStageTicks, longest.taps[stage.first_tap + stage.tap_count - 1].delay_ticks);
      }
    }
    ShaperSpec spec = spec_of(kind);
    constexpr double kNotPositive[] = {0.0, -3.0};
    for (const double low : kNotPositive) {
      spec.mode.frequency_hz = low;
      TEST_ASSERT_REFUSED(kNotPositive, kFrequency, refused(spec));
    }
  }
}

TEST_F(OneModeDesigned, a_tolerance_without_a_damped_shaper_names_one_that_has) {
  ShaperSpec spec = spec_of(ShaperKind::kEi3);
  spec.mode.damping_ratio = 0.3;
  const Status status = refused(spec);
  TEST_ASSERT_EQUAL_ENUM(Error::kAboveMaximum, status.error);
  TEST_ASSERT_EQUAL_ENUM(Quantity::kTolerance, status.quantity);
  spec.tolerance = status.accepted;
  accept(spec);
}

TEST_F(OneModeDesigned, a_tick_must_be_above_zero) {
  constexpr double kBadTicks[] = {0.0, -1e-3};
  for (const double tick_s : kBadTicks) {
    TEST_ASSERT_REFUSED(kNotPositive, kTick, refused(spec_of(ShaperKind::kZv), tick_s));
  }
}

TEST_F(OneModeDesigned, bad_trains_are_refused_by_name_with_what_would_do) {
  TEST_ASSERT_REFUSED(kNotAvailable, kImpulses, refused(spec_of(ShaperKind::kCustom)));
  TEST_ASSERT_REFUSED(kBelowMinimum, kImpulses, refused_train(ImpulseTrain{0, {}}));
  TEST_ASSERT_REFUSED(kAboveMaximum, kImpulses, refused_train(ImpulseTrain{ImpulseTrain::kMaxImpulses + 1, {}}));
  TEST_ASSERT_REFUSED(kAboveMaximum, kImpulseTime, refused_train(ImpulseTrain{2, {{0.01, 0.5}, {0.02, 0.5}}}));
  TEST_ASSERT_REFUSED(kBelowMinimum, kImpulseTime, refused_train(ImpulseTrain{2, {{-0.01, 0.5}, {0.02, 0.5}}}));
  ImpulseTrain train{3, {{0.0, 0.5}, {0.02, 0.25}, {0.02, 0.25}}};
  const Status unsorted = refused_train(train);
  TEST_ASSERT_REFUSED(kBelowMinimum, kImpulseTime, unsorted);
  train.impulses[2].time = unsorted.accepted;
  accept_train(train);
  TEST_ASSERT_REFUSED(kBelowMinimum, kImpulseSum, refused_train(ImpulseTrain{2, {{0.0, 0.5}, {0.02, 0.498}}}));
  TEST_ASSERT_REFUSED(kAboveMaximum, kImpulseSum, refused_train(ImpulseTrain{2, {{0.0, 0.5}, {0.02, 0.502}}}));
  TEST_ASSERT_REFUSED(kAboveMaximum, kImpulseAmplitude, refused_train(ImpulseTrain{2, {{0.0, 2.1}, {0.02, -1.1}}}));
  TEST_ASSERT_REFUSED(kAboveMaximum, kImpulseAmplitude,
                      refused_train(ImpulseTrain{3, {{0.0, 1.3}, {0.02, -1.5}, {0.04, 1.2}}}));
}

TEST_F(OneModeDesigned, a_train_longer_than_a_stage_names_the_longest) {
  ImpulseTrain train{2, {{0.0, 0.5}, {1e300, 0.5}}};
  TEST_ASSERT_REFUSED(kAboveMaximum, kImpulseTime, refused_train(train));
  train.impulses[1].time = 2000.0;
  const Status status = refused_train(train);
  TEST_ASSERT_REFUSED(kAboveMaximum, kImpulseTime, status);
  train.impulses[1].time = status.accepted;
  accept_train(train);
}

TEST(a_full_design_has_no_room_for_stages_or_taps) {
  ShaperDesign design{};
  ShaperSpec spec = spec_of(ShaperKind::kCv4);
  for (int i = 0; i < 4; ++i) TEST_ASSERT_OK(add_shaper(spec, kTick, design));
  ShaperDesign before = design;
  const Status stages = add_shaper(spec_of(ShaperKind::kZv), kTick, design);
  TEST_ASSERT_REFUSED(kTooManyStages, kStages, stages);
  TEST_ASSERT_TRUE(is_same(before, design));
  design = ShaperDesign{};
  ImpulseTrain train{31, {}};
  for (int i = 0; i < 31; ++i) train.impulses[i] = Impulse{0.0025 * i, 1.0 / 31.0};
  spec = spec_of(ShaperKind::kCustom);
  spec.train = &train;
  TEST_ASSERT_OK(add_shaper(spec, kTick, design));
  before = design;
  const Status taps = add_shaper(spec, kTick, design);
  TEST_ASSERT_REFUSED(kTooManyStages, kTaps, taps);
  TEST_ASSERT_DOUBLE_WITHIN(0.0, ShaperDesign::kMaxTaps, taps.accepted);
  TEST_ASSERT_TRUE(is_same(before, design));
}
