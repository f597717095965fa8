// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/excitation.hpp"

#include "shaper/base/math.hpp"
#include "shaper/base/shared.hpp"

namespace stillpoint {

namespace {

constexpr uint64_t kHalfTurn = UINT64_C(1) << 63;
constexpr int64_t kQuarterTurn = INT64_C(1) << 62;
constexpr int64_t kOne = INT64_C(1) << 62;  // of a sine or an envelope
constexpr double kTurn = 0x1p64;
constexpr double kMostTicks = 0x1p30;
constexpr double kMostAmplitude = 0x1p28;         // counts: eight of it, a third difference, fit 64 bits
constexpr double kLeastAmplitude = 1.0;           // counts; less shows nothing
constexpr uint32_t kTwoPeriods = 3;               // Step::fade_shift, four times the periods of a block being 2^shift
constexpr uint32_t kLongBlock = 128;              // ticks: a third difference has its peaks where a derivative has
constexpr uint32_t kRest = 3;                     // ticks at 0 that keep the differences of neighbours apart
constexpr double kRounding = 8.0 / 4294967296.0;  // counts: more than rounding adds to a third difference

// a b / 2^62, rounded down. In words of 32 bits, for a Cortex-M has no product of 128.
int64_t times(int64_t a, int64_t b) {
  const int64_t a_high = a >> 32;
  const int64_t b_high = b >> 32;
  const uint64_t a_low = static_cast<uint32_t>(a);
  const uint64_t b_low = static_cast<uint32_t>(b);
  const int64_t carry = static_cast<int64_t>((a_low * b_low) >> 32);
  const int64_t middle = a_high * static_cast<int64_t>(b_low) + carry;
  const int64_t other = static_cast<int64_t>(a_low) * b_high + static_cast<int64_t>(static_cast<uint32_t>(middle));
  const int64_t high = a_high * b_high + (middle >> 32) + (other >> 32);
  const uint64_t low = static_cast<uint64_t>(a) * static_cast<uint64_t>(b);
  return static_cast<int64_t>((static_cast<uint64_t>(high) << 2) | (low >> 62));
}

// Taylor's series of sin(pi/2 y), times 2^62; what is left out is below 2^-64 of 1.
constexpr int64_t kSine[] = {INT64_C(7244019458077122842),
                             INT64_C(-2978983596875621757),
                             INT64_C(367517370231208053),
                             INT64_C(-21590780087563799),
                             INT64_C(739904368663792),
                             INT64_C(-16596735030340),
                             INT64_C(262505142787),
                             INT64_C(-3084311801),
                             INT64_C(27978803),
                             INT64_C(-201857),
                             INT64_C(1186),
                             INT64_C(-6)};
constexpr size_t kSineTerms = sizeof(kSine) / sizeof(kSine[0]);

// Sine of phase / 2^64 turns, times 2^62. Finer than the third difference of the slowest sine needs.
int64_t sine(uint64_t phase) {
  int64_t y = static_cast<int64_t>(phase);
  if (y > kQuarterTurn || y < -kQuarterTurn) y = static_cast<int64_t>(kHalfTurn - phase);
  const int64_t square = times(y, y);
  int64_t sum = kSine[kSineTerms - 1];
  for (size_t k = kSineTerms - 1; k-- > 0;) sum = kSine[k] + times(sum, square);
  return times(sum, y);
}

double counts_of(Signal value) { return static_cast<double>(value) / static_cast<double>(kSignalPerCount); }

}  // namespace

Status ExcitationConfig::validate() const {
  if (kind > ExcitationKind::kChirp) return refuse(Error::kNotAvailable, Quantity::kKind, static_cast<double>(kind));
  const struct {
    Quantity quantity;
    double value;
  } positive[] = {{Quantity::kTick, tick_s},      {Quantity::kAmplitude, amplitude},
                  {Quantity::kTravel, travel},    {Quantity::kVelocity, velocity},
                  {Quantity::kJerk, jerk},        {Quantity::kAcceleration, acceleration},
                  {Quantity::kFrequency, low_hz}, {Quantity::kFrequency, high_hz}};
  for (size_t i = 0; i < sizeof(positive) / sizeof(positive[0]); ++i) {
    const Status status = check_positive(positive[i].quantity, positive[i].value);
    if (!status.ok()) return status;
  }
  const double most = math::lesser(travel, kMostAmplitude);
  if (amplitude > most) return refuse(Error::kAboveMaximum, Quantity::kAmplitude, amplitude, most);
  const double highest = 0.45 / tick_s;
  if (high_hz >= highest) return refuse(Error::kAboveMaximum, Quantity::kFrequency, high_hz, highest);
  if (low_hz >= high_hz) return refuse(Error::kAboveMaximum, Quantity::kFrequency, low_hz, high_hz);
  if (kind != ExcitationKind::kSteppedSine) return kOk;
  if (steps < 2) return refuse(Error::kBelowMinimum, Quantity::kStages, steps, 2.0);
  if (steps > kMostExcitationSteps) {
    return refuse(Error::kAboveMaximum, Quantity::kStages, steps, kMostExcitationSteps);
  }
  return kOk;
}

// The blocks of each step, and how far the phase goes a tick.
bool Excitation::lay_out(const ExcitationConfig& config) {
  kind_ = config.kind;
  steps_ = kind_ == ExcitationKind::kSteppedSine ? config.steps : 1;
  slope_ = 0;
  double total = 0.0;
  const double span = steps_ > 1 ? math::log(config.high_hz / config.low_hz) / (steps_ - 1) : 0.0;
  for (uint32_t k = 0; k < steps_; ++k) {
    const double per_tick = config.low_hz * math::exp(span * k) * config.tick_s;
    double periods = 2.0;
    if (periods / per_tick < 32.0) periods = 16.0;  // else whole ticks would shift the frequency
    double block = math::nearest_integer(math::lesser(periods / per_tick, kMostTicks));
    double held = kSteppedBlocks;
    if (kind_ == ExcitationKind::kBump) {
      // sin^4 has its first notch at three over its length
      block = math::nearest_integer(math::lesser(1.25 / (config.high_hz * config.tick_s), kMostTicks));
      block = math::greater(block, 2.0);
      held = 0.0;
      periods = 0.5;
    } else if (kind_ == ExcitationKind::kChirp) {
      held = kChirpBlocks;
    }
    held_blocks_ = static_cast<uint32_t>(held);
    total += block * (2.0 + held) + kRest;
    if (total > kMostTicks) return false;
    Step& step = step_[k];
    step.block = static_cast<uint32_t>(block);
    step.fade_shift = periods > 2.0 ? 6 : periods < 2.0 ? 1 : kTwoPeriods;  // a quarter turn a block
    step.increment = static_cast<uint64_t>(periods / block * kTurn);
    step.amplitude = kOne;
  }
  if (kind_ == ExcitationKind::kChirp) {
    const double way = (config.high_hz - config.low_hz) * config.tick_s * kTurn;
    slope_ = static_cast<uint64_t>(way / (held_blocks_ * static_cast<double>(step_[0].block)));
  }
  ticks_ = static_cast<uint32_t>(total);
  return true;
}

// To tick n of the step, as if it had been run so far.
void Excitation::seek(uint32_t n) {
  begin_step();
  const Step& step = step_[at_];
  const uint64_t held = n > step.block ? n - step.block : 0;
  in_step_ = n;
  phase_ = n * step.increment + held * (held + 1) / 2 * slope_;
  increment_ += held * slope_;
  fade_phase_ = n * (step.increment >> step.fade_shift);
}

// Ticks [from, to) of the step, run as the tick would.
void Excitation::measure(uint32_t from, uint32_t to, const Meanwhile& meanwhile, Peaks& peaks) {
  Signal before[3] = {};
  const uint32_t step = at_;
  seek(from == 0 ? 0 : from - 3);
  meanwhile();
  while (!over() && at_ == step && in_step_ < to) {
    if (in_step_ % 256 == 0) meanwhile();
    const bool counts = in_step_ >= from;
    const Signal now = tick();
    const Signal first = now - before[0];
    const Signal second = first - (before[0] - before[1]);
    const Signal third = second - (before[0] - 2 * before[1] + before[2]);
    const Signal differences[] = {now, first, second, third};
    for (size_t i = 0; i < 4 && counts; ++i) {
      const Signal size = differences[i] < 0 ? -differences[i] : differences[i];
      if (size > peaks.difference[i]) peaks.difference[i] = size;
    }
    before[2] = before[1];
    before[1] = before[0];
    before[0] = now;
  }
}

// What a step reaches. A sine fades out as it fades in, and what it holds repeats itself: two blocks are enough. With
// two periods a block its peaks are where those of sin^4(pi t / 2) sin(4 pi t) are, t being 1 at the end of the fade:
// the value's and the first derivative's in what is held; the second's at 0.89289, 1.0093 of that of what is held; the
// third's at 1, 1.1875 of it. The second half of what is held lies between the samples as the first does, mirrored.
Excitation::Peaks Excitation::peaks_of_step(const Meanwhile& meanwhile) {
  Peaks peaks = {};
  const Step& step = step_[at_];
  const uint32_t block = step.block;
  const bool is_long = step.fade_shift == kTwoPeriods && block >= kLongBlock;
  const uint32_t end = step_ticks(at_);
  if (!is_long) {
    measure(0, kind_ == ExcitationKind::kSteppedSine ? 2 * block + 3 : end, meanwhile, peaks);
    return peaks;
  }
  const bool rises = kind_ == ExcitationKind::kChirp;
  const uint32_t last = block * held_blocks_;
  if (rises) peaks = most_before(last);
  for (uint32_t k = 0; k < (rises ? 2 : 6); ++k) {
    const uint32_t at = k == 0 ? block * 25 / 28 : block * (7 + k) / 8;
    measure(at - 3, at + 6, meanwhile, peaks);
  }
  if (rises) measure(last, end, meanwhile, peaks);
  return peaks;
}

// Above what a chirp reaches before this tick of what it holds, but where its frequency begins to rise. A difference of
// z = e^(i phi) is z (1 - e^(-i w)), w being the difference of phi: at most g = 2 sin(w / 2). That of a product has one
// of w in it besides, s: (g^2 + s) and (g^3 + 3 g s + 4 s^2), and s is below 1 / 16 of g.
Excitation::Peaks Excitation::most_before(uint32_t tick) const {
  const Step& step = step_[at_];
  const int64_t g = 2 * sine((step.increment + (tick - step.block) * slope_) / 2);
  const Signal bent = times(step.amplitude, times(static_cast<int64_t>(slope_), kSine[0]) + 1);
  const Signal first = times(step.amplitude, g);
  const Signal second = times(first, g);
  return {{step.amplitude, first, second + bent, times(second, g) + times(bent, g) * 13 / 4}};
}

Status Excitation::prepare(const ExcitationConfig& config, Announcement& announcement, const Meanwhile& meanwhile) {
  const Status status = config.validate();
  if (!status.ok()) return status;
  if (!over()) return refuse(Error::kBusy, Quantity::kNone, 0.0);
  Excitation next = {};
  if (!next.lay_out(config)) return refuse(Error::kBelowMinimum, Quantity::kFrequency, config.low_hz);
  const double tick = config.tick_s;
  const Quantity names[] = {Quantity::kAmplitude, Quantity::kVelocity, Quantity::kAcceleration, Quantity::kJerk};
  const double limits[] = {config.amplitude, config.velocity, config.acceleration, config.jerk};
  const double scale[] = {1.0, tick, tick * tick, tick * tick * tick};
  // A run at an amplitude that leaves the third difference room in 64 bits says what each count of it costs.
  constexpr double kTrial = 0x1p26;
  double all[4] = {};
  next.start();
  for (uint32_t k = 0; k < next.steps_; ++k) {
    next.at_ = k;
    next.step_[k].amplitude = static_cast<Signal>(kTrial * static_cast<double>(kSignalPerCount));
    const Peaks peaks = next.peaks_of_step(meanwhile);
    double ratio = kMostAmplitude / kTrial;
    double reached[4];
    for (size_t i = 0; i < 4; ++i) {
      reached[i] = counts_of(peaks.difference[i]) + kRounding;
      const double room = limits[i] * scale[i] - kRounding;
      const double allowed = room / reached[i];
      if (!(allowed >= kLeastAmplitude / kTrial * 0.999)) {
        return refuse(Error::kBelowMinimum, names[i], limits[i],
                      limits[i] * (kLeastAmplitude / kTrial) / math::greater(allowed, 1e-300));
      }
      ratio = math::lesser(ratio, allowed);
    }
    next.step_[k].amplitude = static_cast<Signal>(ratio * (kTrial * static_cast<double>(kSignalPerCount)));
    for (size_t i = 0; i < 4; ++i) all[i] = math::greater(all[i], reached[i] * ratio + kRounding);
    store(next.running_, 1);
  }
  next.start();
  announcement = {all[0], all[1] / scale[1], all[2] / scale[2], all[3] / scale[3], next.ticks_ * tick};
  *this = next;
  return kOk;
}

uint32_t Excitation::step_ticks(uint32_t step) const { return step_[step].block * (2 + held_blocks_) + kRest; }

double Excitation::cycles_a_tick(uint32_t step) const { return static_cast<double>(step_[step].increment) / kTurn; }

double Excitation::amplitude(uint32_t step) const { return counts_of(step_[step].amplitude); }

void Excitation::start() {
  at_ = 0;
  begin_step();
  store(running_, steps_ != 0 ? 1 : 0);
}

void Excitation::begin_step() {
  in_step_ = 0;
  phase_ = 0;
  fade_phase_ = 0;
  increment_ = step_[at_].increment;
}

Signal Excitation::tick() {
  if (over()) return 0;
  const Step& step = step_[at_];
  const uint32_t out = step.block * (1 + held_blocks_);
  const uint32_t end = out + step.block;
  Signal offset = 0;
  if (in_step_ < end) {
    int64_t envelope = kOne;
    const bool held = in_step_ >= step.block && in_step_ < out;
    if (!held) {
      if (in_step_ == out) fade_phase_ = kHalfTurn / 2;
      const int64_t root = sine(fade_phase_);
      const int64_t square = times(root, root);
      envelope = times(square, square);
      fade_phase_ += step.increment >> step.fade_shift;
    } else {
      increment_ += slope_;
    }
    const int64_t wave = kind_ == ExcitationKind::kBump ? envelope : times(envelope, sine(phase_));
    offset = times(step.amplitude, wave);
    phase_ += increment_;
  }
  ++in_step_;
  if (in_step_ >= end + kRest) {
    if (++at_ < steps_) {
      begin_step();
    } else {
      store(running_, 0);
    }
  }
  return offset;
}

}  // namespace stillpoint
