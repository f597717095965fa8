// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/chirp_bins.hpp"

#include "shaper/base/complex.hpp"
#include "shaper/base/shared.hpp"
#include "shaper/identify/quadrature.hpp"

namespace stillpoint {

namespace {

constexpr double kOne = 32768.0;  // of a quadrature pair
constexpr double kTurn = 4294967296.0;
constexpr double kRestPeriods = 2.0;

Complex complex_of(const BinSums& sums) { return {static_cast<double>(sums.sine), static_cast<double>(sums.cosine)}; }

}  // namespace

void ParallelBins::start(double low, double high, uint32_t ticks) {
  const double all = ticks;
  const int32_t first = math::nearest_integer(math::greater(low * all, 1.0));
  const int32_t last = math::nearest_integer(high * all);
  const double span = math::log(high / low) / (kMostBins - 1);
  count_ = 0;
  int32_t before = first - 1;
  for (uint32_t k = 0; k < kMostBins && before < last; ++k) {
    const int32_t wanted = math::nearest_integer(low * all * math::exp(span * k));
    before = wanted > before ? wanted : before + 1;
    Bin& bin = bin_[count_++];
    bin = {};
    bin.increment = static_cast<uint32_t>(before / all * kTurn + 0.5);
  }
}

void ParallelBins::tick(int32_t value) {
  for (uint32_t k = 0; k < count_; ++k) {
    Bin& bin = bin_[k];
    const Quadrature pair = quadrature_of(bin.phase);
    bin.sums.sine += int64_t{value} * pair.sine;
    bin.sums.cosine += int64_t{value} * pair.cosine;
    bin.phase += bin.increment;
  }
}

void ChirpBins::start(const Excitation& chirp, double low, double high) {
  low_ = low;
  high_ = high;
  ticks_ = chirp.ticks() + static_cast<uint32_t>(kRestPeriods / low) + kQuiet;
  at_ = 0;
  before_ = 0;
  squares_ = 0;
  after_ = 0;
  heard_.start(low, high, ticks_);
}

void ChirpBins::tick(int32_t value) {
  if (value > kMost) value = kMost;
  if (value < -kMost) value = -kMost;
  const uint32_t at = at_;
  store(at_, at + 1);
  if (at < kQuiet) {
    before_ += value;
    squares_ += int64_t{value} * value;
    return;
  }
  if (at >= ticks_) after_ += value;
  heard_.tick(value);
}

uint32_t ChirpBins::answers(Excitation& chirp, double tick_s, BinAnswer* answers, const Meanwhile& meanwhile) {
  int shift = 0;
  while (math::ldexp(chirp.amplitude(0), kSignalFractionBits - shift) > kMost) ++shift;
  asked_.start(low_, high_, ticks_);
  chirp.start();
  for (uint32_t n = 0; n < ticks_; ++n) {
    if (n % 64 == 0) meanwhile();
    asked_.tick(static_cast<int32_t>(chirp.tick() >> shift));
  }
  const double mean = static_cast<double>(before_) / kQuiet;
  const double variance = (static_cast<double>(squares_) / kQuiet - mean * mean) * kQuiet / (kQuiet - 1.0);
  const double noise = kOne * math::sqrt(math::greater(variance, 0.0) * 0.5 * ticks_);
  // Both means lie `ticks_` apart, so over all ticks it drifts by their difference.
  const double drift = kOne * (static_cast<double>(after_) / kQuiet - mean);
  const double unit = math::ldexp(1.0, kSignalFractionBits - shift);
  for (uint32_t k = 0; k < heard_.count(); ++k) {
    const double cycles = heard_.cycles_a_tick(k);
    const Complex turned = math::exp(Complex{0.0, -2.0 * math::kPi * cycles}) - Complex{1.0, 0.0};
    const Complex heard = complex_of(heard_.sums(k)) - Complex{0.0, drift} / turned;
    const Complex asked = complex_of(asked_.sums(k));
    const Complex answer = unit * (heard / asked);
    answers[k] = {cycles / tick_s, answer.re, answer.im, unit * noise / math::sqrt(square_of(asked))};
  }
  return heard_.count();
}

}  // namespace stillpoint
