// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/decrement.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kBandPassQ = 3.0;
constexpr double kEnd = 0.05;  // of the first extremum

// Two poles, two zeros, transposed direct form II (Bristow-Johnson's cookbook).
class Biquad {
 public:
  static Biquad low_pass(double turns, double q) {
    const double cosine = math::cos(2.0 * kPi * turns), alpha = math::sin(2.0 * kPi * turns) / (2.0 * q);
    return Biquad(0.5 * (1.0 - cosine), 1.0 - cosine, 0.5 * (1.0 - cosine), cosine, alpha);
  }
  static Biquad band_pass(double turns, double q) {
    const double cosine = math::cos(2.0 * kPi * turns), alpha = math::sin(2.0 * kPi * turns) / (2.0 * q);
    return Biquad(alpha, 0.0, -alpha, cosine, alpha);
  }

  double next(double x) {
    const double y = b0_ * x + first_;
    first_ = b1_ * x - a1_ * y + second_;
    second_ = b2_ * x - a2_ * y;
    return y;
  }

 private:
  Biquad(double b0, double b1, double b2, double cosine, double alpha)
      : b0_(b0 / (1.0 + alpha)),
        b1_(b1 / (1.0 + alpha)),
        b2_(b2 / (1.0 + alpha)),
        a1_(-2.0 * cosine / (1.0 + alpha)),
        a2_((1.0 - alpha) / (1.0 + alpha)) {}

  double b0_, b1_, b2_, a1_, a2_;
  double first_ = 0.0;
  double second_ = 0.0;
};

// The record about its straight line, low-passed.
class Source {
 public:
  Source(const Record& record, double turns) : record_(record), filter_(Biquad::low_pass(turns, math::sqrt(0.5))) {
    const auto count = static_cast<double>(record.count);
    middle_ = 0.5 * (count - 1.0);
    double moment = 0.0;
    for (size_t n = 0; n < record.count; ++n) {
      mean_ += static_cast<double>(record.samples[n]);
      moment += static_cast<double>(record.samples[n]) * (static_cast<double>(n) - middle_);
    }
    mean_ /= count;
    slope_ = 12.0 * moment / (count * (count * count - 1.0));
  }
  double next() {
    const double line = mean_ + slope_ * (static_cast<double>(n_) - middle_);
    return filter_.next(static_cast<double>(record_.samples[n_++]) - line);
  }

 private:
  const Record& record_;
  Biquad filter_;
  double middle_ = 0.0;
  double mean_ = 0.0;
  double slope_ = 0.0;
  size_t n_ = 0;
};

// Mean logarithmic decrement of successive extrema of one sign, taken as they come.
class Decrement {
 public:
  void see(double extremum) {
    ++seen_;
    if (seen_ < 2 || ended_) return;
    if (first_ == 0.0) first_ = last_ = extremum;
    ended_ = !(extremum > kEnd * first_);
    if (ended_ || seen_ == 2) return;
    sum_ += math::log(last_ / extremum);
    last_ = extremum;
    ++count_;
  }
  bool any() const { return count_ > 0; }
  double mean() const { return sum_ / static_cast<double>(count_); }

 private:
  size_t seen_ = 0;
  size_t count_ = 0;
  double first_ = 0.0;
  double last_ = 0.0;
  double sum_ = 0.0;
  bool ended_ = false;
};

// -1 where there were too few extrema.
double damping_ratio_of(Source source, size_t count, double turns) {
  Biquad filter = Biquad::band_pass(turns, kBandPassQ);
  Decrement maxima, minima;
  double extremum = 0.0;  // of the half-wave that goes on
  for (size_t n = 0; n < count; ++n) {
    const double here = filter.next(source.next());
    if (here * extremum < 0.0) {
      (extremum > 0.0 ? maxima : minima).see(math::magnitude(extremum));
      extremum = here;
    }
    if (math::magnitude(here) > math::magnitude(extremum)) extremum = here;
  }
  if (!maxima.any() || !minima.any()) return -1.0;
  const double delta = 0.5 * (maxima.mean() + minima.mean());
  return delta / math::sqrt(4.0 * kPi * kPi + delta * delta);
}

struct Peaks {
  size_t count = 0;
  size_t bin[kMostDecrementModes];
};

// The highest peaks first, none nearer to a higher one than `apart` bins.
Peaks peaks_of(const double* power, size_t size, double threshold, double apart, size_t most) {
  Peaks peaks;
  while (peaks.count < most) {
    size_t best = 0;
    for (size_t k = 1; k < size / 2; ++k) {
      if (power[k] < power[k - 1] || power[k] < power[k + 1] || (best != 0 && power[k] <= power[best])) continue;
      bool merged = false;
      for (size_t i = 0; i < peaks.count; ++i) {
        merged = merged || math::magnitude(static_cast<double>(k) - static_cast<double>(peaks.bin[i])) < apart;
      }
      if (!merged) best = k;
    }
    if (best == 0 || !(power[best] > 0.0)) break;
    if (peaks.count > 0 && power[best] < math::square(threshold) * power[peaks.bin[0]]) break;
    peaks.bin[peaks.count++] = best;
  }
  return peaks;
}

Status check(const Record& record, const DecrementConfig& config, size_t size) {
  if (!(config.rate_hz > 0.0)) return refuse(Error::kNotPositive, Quantity::kFrequency, config.rate_hz);
  if (!(config.threshold > 0.0)) return refuse(Error::kNotPositive, Quantity::kTolerance, config.threshold);
  if (config.low_pass_hz < 0.0 || config.low_pass_hz >= 0.5 * config.rate_hz) {
    return refuse(Error::kAboveMaximum, Quantity::kFrequency, config.low_pass_hz, 0.499 * config.rate_hz);
  }
  if (config.most_modes > kMostDecrementModes) {
    return refuse(Error::kAboveMaximum, Quantity::kStages, static_cast<double>(config.most_modes), kMostDecrementModes);
  }
  const size_t most = is_fft_size(size) ? size : 0;
  if (record.count > most || record.count < 4) {
    return refuse(record.count > most ? Error::kAboveMaximum : Error::kBelowMinimum, Quantity::kSamples,
                  static_cast<double>(record.count), record.count > most ? static_cast<double>(most) : 4.0);
  }
  return kOk;
}

}  // namespace

Status identify_by_decrement(const Record& record, const DecrementConfig& config, double* buffer, size_t size,
                             DecrementModes& modes) {
  const Status status = check(record, config, size);
  if (!status.ok()) return status;
  modes = DecrementModes{};
  const size_t used = fft_size_for(record.count);
  const Source source(record, (config.low_pass_hz > 0.0 ? config.low_pass_hz / config.rate_hz : 0.4));
  Source samples = source;
  for (size_t n = 0; n < used; ++n) buffer[n] = n < record.count ? samples.next() : 0.0;
  if (!real_fft(buffer, used)) return status;
  to_power(buffer, used);
  const double bin_hz = config.rate_hz / static_cast<double>(used);
  const double apart = config.merge_hz > 0.0 ? config.merge_hz / bin_hz : 3.0;
  const Peaks peaks = peaks_of(buffer, used, config.threshold, apart, config.most_modes);
  for (size_t i = 0; i < peaks.count; ++i) {
    const double turns = static_cast<double>(peaks.bin[i]) / static_cast<double>(used);
    const double zeta = damping_ratio_of(source, record.count, turns);
    if (!(zeta > 0.0)) continue;
    const double natural = config.rate_hz * turns / math::sqrt(1.0 - zeta * zeta);
    const double height = 2.0 * math::sqrt(buffer[peaks.bin[i]]) / static_cast<double>(record.count);
    modes.mode[modes.count++] = DecrementMode{natural, zeta, height};
  }
  return status;
}

}  // namespace stillpoint
