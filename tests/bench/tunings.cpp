// SPDX-License-Identifier: Apache-2.0
// Instructions, stack and memory of a tuning, from an unknown arm to a still one, on the chip. See counting.hpp.
#include "shaper/axis/axis.hpp"
#include "shaper/base/complex.hpp"
#include "shaper/identify/quadrature.hpp"
#include "shaper/tune/auto_tune.hpp"
#include "tests/bench/background.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::bench;

constexpr double kTick = 1e-3;
constexpr AxisLimits kLimits{1.2e6, 20e6, 20e6, 600e6};
constexpr Mode kArm{11.0, 0.11};  // the paper's
constexpr uint32_t kMostTickInstructions = 400;
constexpr uint32_t kMostSineInstructions = 1600;
constexpr uint32_t kMostChirpInstructions = 6000;
constexpr uint32_t kMostStartInstructions = 50000000;  // 0.3 s
constexpr uint32_t kMostStackBytes = 12 * 1024;
constexpr uint32_t kLongestGap = 50000000;

Axis<2048> axis;
TuneMemory memory;
AutoTune tune;

// A mode as its complex swing: an increment of the setpoint adds to it, a tick turns it by the pole. Steps of 16 g in
// 16 bits, for an axis of a million counts a metre.
class Arm {
 public:
  explicit Arm(const Mode& mode)
      : pole_(math::exp(Complex{
            -6.283185307179586 * mode.frequency_hz * mode.damping_ratio * kTick,
            6.283185307179586 * mode.frequency_hz * kTick * math::sqrt(1.0 - math::square(mode.damping_ratio))})),
        steps_(math::square(6.283185307179586 * mode.frequency_hz) * 1e-6 / 4.8e-3) {}

  TuneSample tick(Signal setpoint) {
    swing_ = swing_ * pole_ + Complex{static_cast<double>(setpoint - last_) / 4294967296.0, 0.0};
    last_ = setpoint;
    const double noise = random_.between(-6.0, 6.0);
    return {setpoint, setpoint, math::nearest_integer(-swing_.re * steps_ + noise), true};
  }

 private:
  Complex pole_;
  double steps_;
  Complex swing_{};
  Signal last_ = 0;
  testing::Random random_{1};
};

TEST_F(Counting, a_tuning_is_counted) {
  TEST_ASSERT_OK(axis.configure({kTick, kLimits, kLimits.acceleration, kLimits.jerk}));
  tune.begin(axis, memory);
  TuneConfig config{};
  config.move = Move{700000, ProfileKind::kSCurve, kLimits, 0.0, false};
  config.travel_counts = 1e6;
  config.low_hz = 2.0;
  config.high_hz = 250.0;
  config.tolerance = 0.02;
  config.accept_by_itself = true;
  Arm arm(kArm);
  TEST_ASSERT_OK(tune.start(config, nullptr));
  Count ticks, quick;
  uint32_t identifying = 0, verifying = 0;
  Paint::lay();
  Watch watch;
  for (int i = 0; i < 20000 && tune.busy(); ++i) {
    const TuneSample sample = arm.tick(axis.tick());
    measure(ticks, [&] { tune.tick(sample); });
    const TuneState before = tune.report().state;
    watch.last = instructions_now();
    const uint64_t total = watch.total;
    tune.service({Watch::look_at, &watch});
    watch.look();
    const auto took = static_cast<uint32_t>(watch.total - total);
    if (before == TuneState::kIdentifying) {
      identifying = took;
    } else if (took > 1000000) {
      verifying += took;
    } else {
      quick.add(took);
    }
  }
  const uint32_t stack = Paint::bytes_used();
  print("\ninstructions of a tuning of the paper's arm\n");
  print_left("", 16), print("     least      mean      most\n");
  print_row("AutoTune::tick", ticks);
  print_row("service", quick);
  print("identification and choice, millions: "), print(value_of(identifying / 1000000));
  print("; design, and what is left: "), print(value_of(verifying / 1000000));
  print("; most between two calls of Meanwhile: "), print(value_of(watch.gap / 1000000));
  print("\nbytes: tuner "), print(value_of(static_cast<uint32_t>(sizeof(tune))));
  print(", memory "), print(value_of(static_cast<uint32_t>(sizeof(memory))));
  print(", stack "), print(value_of(stack)), print("\n");
  const TuneReport& report = tune.report();
  TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, report.state);
  TEST_ASSERT_EQUAL_UINT64(1, report.identification.mode_count);
  TEST_ASSERT_DOUBLE_RELATIVE(0.005, kArm.frequency_hz, report.identification.mode[0].frequency_hz);
  TEST_ASSERT_DOUBLE_RELATIVE(0.1, kArm.damping_ratio, report.identification.mode[0].damping_ratio);
  TEST_ASSERT_AT_MOST_INT64(kMostTickInstructions, ticks.most());
  TEST_ASSERT_AT_MOST_INT64(kLongestGap, watch.gap);
  TEST_ASSERT_AT_MOST_INT64(kMostStackBytes, stack);
}

// Generator and bins: one of a stepped sine, 32 of a chirp. Aborted once all kinds of ticks were seen, but for the time
// of the sine's preparation.
TEST_F(Counting, the_ticks_of_a_sine_and_of_a_chirp_are_counted) {
  static AutoTune tuner;
  TEST_ASSERT_OK(axis.configure({kTick, kLimits, kLimits.acceleration, kLimits.jerk}));
  axis.reset(0);
  tuner.begin(axis, memory);
  print("\ninstructions of AutoTune::tick, and of starting\n");
  print_left("", 16), print("     least      mean      most\n");
  constexpr TuneExcitation kKinds[] = {TuneExcitation::kSteppedSine, TuneExcitation::kChirp};
  for (const TuneExcitation kind : kKinds) {
    const bool is_sine = kind == TuneExcitation::kSteppedSine;
    TuneConfig config{};
    config.excitation = kind;
    config.source = TuneSource::kAccelerometer;
    config.move = Move{700000, ProfileKind::kSCurve, kLimits, 0.0, false};
    config.amplitude_counts = 1000.0;
    config.travel_counts = 1e6;
    config.low_hz = 8.0;
    config.high_hz = 40.0;
    config.tolerance = 0.02;
    Arm arm(kArm);
    Count start, ticks;
    measure(start, [&] { TEST_ASSERT_OK(tuner.start(config, nullptr)); });
    for (int i = 0; i < 2300; ++i) {
      const TuneSample sample = arm.tick(axis.tick());
      tuner.service({});
      measure(ticks, [&] { tuner.tick(sample); });
    }
    TEST_ASSERT_EQUAL_ENUM(TuneState::kExciting, tuner.report().state);
    print_row(is_sine ? "stepped sine" : "chirp", ticks);
    print_row("start", start);
    TEST_ASSERT_AT_MOST_INT64(is_sine ? kMostSineInstructions : kMostChirpInstructions, ticks.most());
    tuner.abort();
    for (int i = 0; i < 1000 && tuner.busy(); ++i) {
      static_cast<void>(axis.tick());
      tuner.service({});
    }
    TEST_ASSERT_EQUAL_ENUM(TuneState::kFailed, tuner.report().state);
  }
}

// The whole of a start, which the client waits for and in which the watchdog is not fed.
TEST_F(Counting, starting_a_sine_and_a_chirp_is_counted_by_band) {
  static AutoTune tuner;
  constexpr AxisLimits kWide{1e7, 1e9, 1e9, 1e12};
  TEST_ASSERT_OK(axis.configure({kTick, kWide, kWide.acceleration, kWide.jerk}));
  axis.reset(0);
  constexpr double kBands[][2] = {{0.1, 1.0}, {0.2, 20.0}, {1.0, 10.0}, {1.0, 200.0}, {8.0, 40.0}, {20.0, 400.0}};
  print("\nthousand instructions of starting, by band\n    0.1 Hz    0.1 Hz        sine       chirp\n");
  for (const auto& band : kBands) {
    print_right(static_cast<uint32_t>(band[0] * 10.0), 10), print_right(static_cast<uint32_t>(band[1] * 10.0), 10);
    constexpr TuneExcitation kKinds[] = {TuneExcitation::kSteppedSine, TuneExcitation::kChirp};
    for (const TuneExcitation kind : kKinds) {
      tuner.begin(axis, memory);
      TuneConfig config{};
      config.excitation = kind;
      config.source = TuneSource::kAccelerometer;
      config.move = Move{700000, ProfileKind::kSCurve, kWide, 0.0, false};
      config.amplitude_counts = 20000.0;
      config.travel_counts = 1e6;
      config.low_hz = band[0];
      config.high_hz = band[1];
      config.tolerance = 0.02;
      Count start;
      Status status = kOk;
      measure(start, [&] { status = tuner.start(config, nullptr); });
      TEST_ASSERT_OK(status);
      TEST_ASSERT_AT_MOST_INT64(kMostStartInstructions, start.most());
      print_right(start.most() / 1000, 12);
      tuner = {};
    }
    print("\n");
  }
}

TEST_F(Counting, what_a_tick_of_a_sine_is_made_of_is_counted) {
  SineMemory& sine = memory.sine;
  Announcement announced{};
  const ExcitationConfig config{ExcitationKind::kSteppedSine, kTick, 1e3, 1e6, 1e6, 2e7, 6e8, 20.0, 40.0, 4};
  sine.excitation = Excitation{};
  TEST_ASSERT_OK(sine.excitation.prepare(config, announced));
  sine.bins.start();
  sine.excitation.start();
  Count bin, generator, pair;
  while (!sine.excitation.over()) {
    const uint32_t phase = sine.excitation.phase();
    measure(pair, [phase] { static_cast<void>(quadrature_of(phase)); });
    measure(bin, [&sine] { sine.bins.tick(sine.excitation, 12345); });
    measure(generator, [&sine] { static_cast<void>(sine.excitation.tick()); });
  }
  print_row("Excitation::tick", generator);
  print_row("SteppedBins", bin);
  print_row("quadrature_of", pair);
}

}  // namespace
