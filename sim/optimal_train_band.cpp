// SPDX-License-Identifier: Apache-2.0
#include "sim/optimal_train_band.hpp"

#include <algorithm>
#include <cmath>

namespace stillpoint::sim {
namespace {

constexpr double kPi = 3.14159265358979323846;

// |F|^2 holds no faster wave along the outline than one a length of the train. At 32 samples a wave a peak is at most
// half a step, 0.1 rad of it, away from a sample. That costs a peak of that wave 0.25 %; low ripple beside a steep edge
// of the band can be sharper (1.1 % seen at 16 a wave), so there is room to spare.
constexpr double kSamplesPerWave = 32.0;
constexpr double kBetweenSamples = 0.97;

class EdgeScan {
 public:
  EdgeScan(const std::vector<ImpulseTap>& taps, uint32_t length, const BandEdge& edge)
      : taps_(taps), length_(length), edge_(edge) {
    const double waves = edge.length() * length / (2.0 * kPi);
    steps_ = std::max<size_t>(4, static_cast<size_t>(std::ceil(waves * kSamplesPerWave)));
    for (size_t i = 0; i <= steps_; ++i) samples_.push_back(modulus(part(i)));
  }

  // Every local maximum, refined where its sample reaches `least`.
  void collect(double least, std::vector<ResponsePeak>& found) const {
    for (size_t i = 0; i <= steps_; ++i) {
      const bool falls_before = i == 0 || samples_[i - 1] <= samples_[i];
      const bool falls_after = i == steps_ || samples_[i + 1] <= samples_[i];
      if (!falls_before || !falls_after || samples_[i] < kBetweenSamples * least) continue;
      const double at = refined(part(i == 0 ? 0 : i - 1), part(std::min(i + 1, steps_)));
      const TickPole pole = edge_.at(modulus(at) > samples_[i] ? at : part(i));
      found.push_back({pole, response(taps_, length_, pole)});
    }
  }

  double highest_sample() const { return *std::max_element(samples_.begin(), samples_.end()); }

 private:
  double part(size_t i) const { return static_cast<double>(i) / static_cast<double>(steps_); }
  double modulus(double part) const { return std::abs(response(taps_, length_, edge_.at(part))); }

  // Golden section. The modulus is flat at the peak: a place to 1e-4 of the step gives it to 1e-9.
  double refined(double low, double high) const {
    constexpr double kGolden = 0.6180339887498949;
    double left = high - kGolden * (high - low);
    double right = low + kGolden * (high - low);
    double at_left = modulus(left);
    double at_right = modulus(right);
    for (int i = 0; i < 20; ++i) {
      const bool go_right = at_left < at_right;
      (go_right ? low : high) = go_right ? left : right;
      (go_right ? left : right) = go_right ? right : left;
      (go_right ? at_left : at_right) = go_right ? at_right : at_left;
      double& fresh = go_right ? right : left;
      fresh = go_right ? low + kGolden * (high - low) : high - kGolden * (high - low);
      (go_right ? at_right : at_left) = modulus(fresh);
    }
    return at_left > at_right ? left : right;
  }

  const std::vector<ImpulseTap>& taps_;
  uint32_t length_;
  BandEdge edge_;
  size_t steps_;
  std::vector<double> samples_;
};

}  // namespace

TickPole BandEdge::at(double part) const {
  const double angle = low_angle + part * (high_angle - low_angle);
  const double damping = low_damping + part * (high_damping - low_damping);
  return {damping * angle, angle * std::sqrt((1.0 - damping) * (1.0 + damping))};
}

double BandEdge::length() const {
  return (high_angle - low_angle) + low_angle * (std::asin(high_damping) - std::asin(low_damping));
}

std::vector<BandEdge> edges_of(const ModeBand& band, double tick_s) {
  const double low = 2.0 * kPi * band.low_hz * tick_s;
  const double high = 2.0 * kPi * band.high_hz * tick_s;
  std::vector<BandEdge> edges = {{low, high, band.low_damping, band.low_damping}};
  if (band.low_damping < band.high_damping) {
    edges.push_back({low, high, band.high_damping, band.high_damping});
    edges.push_back({low, low, band.low_damping, band.high_damping});
    edges.push_back({high, high, band.low_damping, band.high_damping});
  }
  return edges;
}

std::complex<double> response(const std::vector<ImpulseTap>& taps, uint32_t length, const TickPole& pole) {
  std::complex<double> sum = 0.0;
  for (const ImpulseTap& tap : taps) {
    const double before_end = static_cast<double>(length) - tap.delay_ticks;
    const double amplitude = static_cast<double>(tap.gain) * std::exp(-pole.decay * before_end);
    sum += std::polar(amplitude, pole.angle * (tap.delay_ticks - 0.5 * length));
  }
  return sum;
}

std::vector<ResponsePeak> peaks(const std::vector<ImpulseTap>& taps, uint32_t length,
                                const std::vector<BandEdge>& edges, double least) {
  std::vector<EdgeScan> scans;
  double highest = 0.0;
  for (const BandEdge& edge : edges) {
    scans.emplace_back(taps, length, edge);
    highest = std::max(highest, scans.back().highest_sample());
  }
  std::vector<ResponsePeak> found;
  for (const EdgeScan& scan : scans) scan.collect(std::min(least, highest), found);
  return found;
}

}  // namespace stillpoint::sim
