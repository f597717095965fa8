// SPDX-License-Identifier: Apache-2.0
#include "sim/optimal_train.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "shaper/shaping/design.hpp"
#include "sim/optimal_train_lp.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::sim {
namespace {

constexpr double kTicksPerPeriod = 1000.0;

void require_between(const std::string& what, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw bad_argument(what, shortest(value), "must be in " + shortest(low) + ".." + shortest(high));
}

void check(const ModeBand& band, double tolerance, double tick_s) {
  if (!(tick_s > 0.0) || !std::isfinite(tick_s)) {
    throw bad_argument("tick", shortest(tick_s), "must be a finite number above zero");
  }
  if (!(band.low_hz > 0.0)) throw bad_argument("band from", shortest(band.low_hz), "must be above zero");
  if (!(band.high_hz > band.low_hz)) {
    throw bad_argument("band to", shortest(band.high_hz), "must be above " + shortest(band.low_hz) + " Hz");
  }
  const double nyquist = 0.5 / tick_s;
  if (!(band.high_hz < nyquist)) {
    throw bad_argument("band to", shortest(band.high_hz), "must be below " + shortest(nyquist) + " Hz");
  }
  const double widest = kWidestBand * band.low_hz;
  if (band.high_hz > widest) {
    throw bad_argument("band to", shortest(band.high_hz), "must be at most " + shortest(widest) + " Hz");
  }
  require_between("damping from", band.low_damping, 0.0, kMaxDampingRatio);
  require_between("damping to", band.high_damping, band.low_damping, kMaxDampingRatio);
  require_between("tolerance", tolerance, kMinTolerance, kMaxTolerance);
}

// Bisects over the length. The least residual can only fall with it: a tick more allows every train there was before,
// and V decays while it waits for that tick.
class Search {
 public:
  Search(const std::vector<BandEdge>& edges, double tolerance, const PartDone& part_done)
      : edges_(edges), tolerance_(tolerance), part_done_(part_done) {}

  OptimalTrain run() {
    bracket();
    const double at_first = std::log(static_cast<double>(long_enough_ - too_short_));
    while (long_enough_ - too_short_ > 1) {
      if (part_done_) part_done_(1.0 - std::log(static_cast<double>(long_enough_ - too_short_)) / at_first);
      try_length(too_short_ + (long_enough_ - too_short_) / 2);
    }
    LeastResidual programme(edges_, long_enough_);
    programme.refine();
    if (programme.upper_bound() < best_.worst_residual) {
      best_.taps = programme.taps();
      best_.worst_residual = programme.upper_bound();
    }
    return best_;
  }

 private:
  // From the half period of the middle frequency, which is what a ZV shaper takes.
  void bracket() {
    const double half_period = 6.283185307179586 / (edges_[0].low_angle + edges_[0].high_angle);
    uint32_t length = static_cast<uint32_t>(std::min(std::ceil(half_period), 1.0 * kLongestTrain));
    while (!try_length(length)) {
      if (length == kLongestTrain) {
        throw Refusal(Refusal::Cause::kCannot, "band", std::to_string(length) + " ticks",
                      "no positive shaper of this length keeps it, a longer tick or a higher band is accepted");
      }
      length = std::min(2 * length, kLongestTrain);
    }
  }

  bool try_length(uint32_t length) {
    LeastResidual programme(edges_, length);
    programme.decide(tolerance_);
    const bool kept = programme.upper_bound() <= tolerance_;
    (kept ? long_enough_ : too_short_) = length;
    if (kept) {
      best_.length_ticks = length;
      best_.taps = programme.taps();
      best_.worst_residual = programme.upper_bound();
    } else {
      best_.shorter_leaves = programme.lower_bound();
    }
    return kept;
  }

  const std::vector<BandEdge>& edges_;
  double tolerance_;
  const PartDone& part_done_;
  uint32_t too_short_ = 0;
  uint32_t long_enough_ = 0;
  OptimalTrain best_ = {0, {}, 1.0, 1.0};
};

}  // namespace

OptimalTrain shortest_positive_train(const ModeBand& band, double tolerance, double tick_s, const PartDone& part_done) {
  check(band, tolerance, tick_s);
  const std::vector<BandEdge> edges = edges_of(band, tick_s);
  return Search(edges, tolerance, part_done).run();
}

double shortest_positive_periods(const ModeBand& band, double tolerance, double unit_hz) {
  const double tick_s = 1.0 / (kTicksPerPeriod * unit_hz);
  return shortest_positive_train(band, tolerance, tick_s).length_ticks / kTicksPerPeriod;
}

}  // namespace stillpoint::sim
