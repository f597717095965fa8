// SPDX-License-Identifier: Apache-2.0
#include "sim/optimal_train_lp.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <numeric>

namespace stillpoint::sim {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kMostRounds = 200;   // 10 to 30 are usual
constexpr double kNoGain = 1e-10;  // less than a gain of 30 bits can hold
constexpr double kPriceSamplesPerWave = 32.0;

// Local minima, ends and plateaus included.
bool is_low(const std::vector<double>& values, size_t i) {
  return (i == 0 || values[i - 1] >= values[i]) && (i + 1 == values.size() || values[i + 1] >= values[i]);
}

}  // namespace

LeastResidual::LeastResidual(const std::vector<BandEdge>& edges, uint32_t length)
    : edges_(edges), length_(length), model_(Clp_newModel()) {
  const double ticks_per_wave = 2.0 * kPi / edges[0].high_angle;
  stride_ = std::max(UINT32_C(1), static_cast<uint32_t>(ticks_per_wave / kPriceSamplesPerWave));
  Clp_setLogLevel(model_.get(), 0);
  // Coefficients are cosines: nothing to scale, and Clp 1.17 answers wrongly after rows and columns were added to a
  // scaled model (seen with bands of two dampings).
  Clp_scaling(model_.get(), 0);
  Clp_setPrimalTolerance(model_.get(), 1e-9);
  Clp_setDualTolerance(model_.get(), 1e-9);
  const double one = 1.0;
  const double lowest = -DBL_MAX;
  const double highest = DBL_MAX;
  const CoinBigIndex none[] = {0, 0};
  Clp_addRows(model_.get(), 1, &one, &one, none, nullptr, nullptr);
  Clp_addColumns(model_.get(), 1, &lowest, &highest, &one, none, nullptr, nullptr);

  std::vector<uint32_t> ticks;
  const uint32_t parts = std::min(length, static_cast<uint32_t>(4.0 * length / ticks_per_wave) + 2);
  for (uint64_t i = 0; i <= parts; ++i) ticks.push_back(static_cast<uint32_t>(length * i / parts));
  add_ticks(ticks);
  std::vector<Limit> limits;
  for (const BandEdge& edge : edges) {
    const int samples = static_cast<int>(edge.length() * length / kPi) + 2;
    for (int i = 0; i <= samples; ++i) {
      for (const double phase : {0.0, kPi}) limits.push_back({edge.at(static_cast<double>(i) / samples), phase});
    }
  }
  add_limits(limits);
}

double LeastResidual::coefficient(const Limit& limit, uint32_t tick) const {
  const double before_end = static_cast<double>(length_) - tick;
  const double after_middle = tick - 0.5 * length_;
  return std::exp(-limit.pole.decay * before_end) * std::cos(limit.pole.angle * after_middle - limit.phase);
}

void LeastResidual::add_limits(const std::vector<Limit>& limits) {
  std::vector<int> columns(ticks_.size() + 1);
  std::iota(columns.begin(), columns.end(), 0);
  std::vector<double> row(columns.size(), -1.0);
  const CoinBigIndex starts[] = {0, static_cast<CoinBigIndex>(row.size())};
  const double lowest = -DBL_MAX;
  const double highest = 0.0;
  for (const Limit& limit : limits) {
    for (size_t i = 0; i < ticks_.size(); ++i) row[i + 1] = coefficient(limit, ticks_[i]);
    Clp_addRows(model_.get(), 1, &lowest, &highest, starts, columns.data(), row.data());
    limits_.push_back(limit);
  }
}

void LeastResidual::add_ticks(const std::vector<uint32_t>& ticks) {
  std::vector<int> rows(limits_.size() + 1);
  std::iota(rows.begin(), rows.end(), 0);
  std::vector<double> column(rows.size(), 1.0);
  const CoinBigIndex starts[] = {0, static_cast<CoinBigIndex>(column.size())};
  const double lowest = 0.0;
  const double highest = DBL_MAX;
  const double cost = 0.0;
  for (const uint32_t tick : ticks) {
    for (size_t i = 0; i < limits_.size(); ++i) column[i + 1] = coefficient(limits_[i], tick);
    Clp_addColumns(model_.get(), 1, &lowest, &highest, &cost, starts, rows.data(), column.data());
    ticks_.push_back(tick);
  }
}

// One round; false when there is nothing left to exchange.
bool LeastResidual::exchange(double gap) {
  // Dual or primal is a matter of taste here: the last basis is neither feasible nor optimal any more.
  Clp_primal(model_.get(), 0);
  const std::vector<Limit> limits = violated_limits();
  const std::vector<uint32_t> ticks = wanted_ticks();
  if (upper_ - lower_ <= gap * upper_) return false;
  add_limits(limits);
  add_ticks(ticks);
  return !limits.empty() || !ticks.empty();
}

void LeastResidual::decide(double tolerance) {
  for (int round = 0; round < kMostRounds; ++round) {
    if (!exchange(1e-6) || upper_ <= tolerance || lower_ > tolerance) return;
  }
}

void LeastResidual::refine() {
  for (int round = 0; round < kMostRounds; ++round) {
    if (!exchange(1e-4)) return;
  }
}

std::vector<ImpulseTap> LeastResidual::solution() const {
  const double* values = Clp_primalColumnSolution(model_.get());
  std::vector<ImpulseTap> taps;
  long double sum = 0.0L;
  for (size_t i = 0; i < ticks_.size(); ++i) {
    const double gain = std::max(values[i + 1], 0.0);
    // V is counted from the last tick, so that one stays whatever its gain.
    if (gain < kNoGain && ticks_[i] != 0 && ticks_[i] != length_) continue;
    taps.push_back({ticks_[i], gain});
    sum += gain;
  }
  std::sort(taps.begin(), taps.end(), [](const auto& a, const auto& b) { return a.delay_ticks < b.delay_ticks; });
  for (ImpulseTap& tap : taps) tap.gain /= sum;
  return taps;
}

// Where the solution rings above its level. Keeps it if it is the best yet.
std::vector<LeastResidual::Limit> LeastResidual::violated_limits() {
  const std::vector<ImpulseTap> taps = solution();
  double highest = 0.0;
  std::vector<Limit> limits;
  for (const ResponsePeak& peak : peaks(taps, length_, edges_, level())) {
    const double modulus = std::abs(peak.response);
    highest = std::max(highest, modulus);
    if (modulus > level() * (1.0 + 1e-7)) limits.push_back({peak.pole, std::arg(peak.response)});
  }
  if (highest < upper_) {
    upper_ = highest;
    taps_ = taps;
  }
  return limits;
}

// The duals of the limits, which are not negative and sum to one at an optimum; both are made sure of.
std::vector<LeastResidual::WeightedLimit> LeastResidual::weights() const {
  const double* duals = Clp_dualRowSolution(model_.get());
  std::vector<WeightedLimit> weights;
  double sum = 0.0;
  for (size_t k = 0; k < limits_.size(); ++k) {
    const double weight = -duals[k + 1];
    if (weight > 0.0) weights.push_back({limits_[k], weight});
    if (weight > 0.0) sum += weight;
  }
  for (WeightedLimit& each : weights) each.weight /= sum;
  return weights;
}

double LeastResidual::price(const std::vector<WeightedLimit>& weights, uint32_t tick) const {
  double sum = 0.0;
  for (const WeightedLimit& each : weights) sum += each.weight * coefficient(each.limit, tick);
  return sum;
}

// The ticks priced below the level. Whatever the weights, r >= sum_k weight_k Re(...)_k = sum_i a_i price_i >= the
// lowest price: the lower bound. The price is no faster than the fastest wave of the band: it is sampled, and looked at
// tick by tick around the minima of the samples.
std::vector<uint32_t> LeastResidual::wanted_ticks() {
  const std::vector<WeightedLimit> weighted = weights();
  std::vector<uint32_t> places;
  for (uint32_t tick = 0; tick < length_; tick += stride_) places.push_back(tick);
  places.push_back(length_);
  std::vector<double> prices;
  for (const uint32_t tick : places) prices.push_back(price(weighted, tick));
  std::vector<uint32_t> wanted;
  double lowest = 1.0;
  for (size_t i = 0; i < places.size(); ++i) {
    if (!is_low(prices, i)) continue;
    uint32_t best = places[i];
    double best_price = prices[i];
    const uint32_t end = places[std::min(i + 1, places.size() - 1)];
    for (uint32_t tick = places[i == 0 ? 0 : i - 1]; tick <= end && stride_ > 1; ++tick) {
      const double other = price(weighted, tick);
      if (other < best_price) best = tick;
      best_price = std::min(best_price, other);
    }
    lowest = std::min(lowest, best_price);
    if (best_price < level() - 1e-9) wanted.push_back(best);
  }
  lower_ = std::max(lower_, lowest);
  return wanted;
}

}  // namespace stillpoint::sim
