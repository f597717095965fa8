// SPDX-License-Identifier: Apache-2.0
#include "sim/table_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "shaper/profile/track.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::sim {
namespace {

using Real = long double;
constexpr size_t kMostCoefficients = 2 * kMaxTableOrder + 2;

bool begins_like_a_number(const std::string& cell) {
  return !cell.empty() && std::string("+-.0123456789").find(cell[0]) != std::string::npos;
}

struct Columns {
  size_t time;
  size_t position;
};

Columns columns_of(const std::vector<std::string>& header) {
  const auto time = std::find(header.begin(), header.end(), "time_s");
  const auto position = std::find(header.begin(), header.end(), "position");
  if (time == header.end() || position == header.end()) return {0, 1};
  return {static_cast<size_t>(time - header.begin()), static_cast<size_t>(position - header.begin())};
}

void normalise(ShapeSamples& samples, const std::string& path) {
  if (samples.size() < 3)
    throw bad_argument("--from", path, std::to_string(samples.size()) + " samples, 3 at least are accepted");
  const ShapeSample first = samples.front();
  const ShapeSample last = samples.back();
  if (last.position == first.position)
    throw bad_argument("--from", path, "ends where it begins, a move from one place to another is accepted");
  for (ShapeSample& sample : samples) {
    sample.time = (sample.time - first.time) / (last.time - first.time);
    sample.position = (sample.position - first.position) / (last.position - first.position);
  }
}

// The polynomials that a node of 1 makes of the span behind and before its knot: coefficients[node][power].
using Basis = std::array<std::array<Real, kMostCoefficients>, kMostCoefficients>;

Basis basis_of(uint32_t order) {
  Basis basis{};
  const uint32_t both = 2 * (order + 1);
  for (uint32_t node = 0; node < both; ++node) {
    std::vector<int64_t> nodes(both, 0);
    nodes[node] = 1;
    int64_t coefficients[kMostCoefficients] = {};
    ProfileTable{order, 1, nodes.data(), {}}.polynomial(0, coefficients);
    for (uint32_t k = 0; k < both; ++k) basis[node][k] = static_cast<Real>(coefficients[k]);
  }
  return basis;
}

Real horner(const std::array<Real, kMostCoefficients>& c, Real x) {
  Real sum = 0;
  for (size_t k = c.size(); k-- > 0;) sum = sum * x + c[k];
  return sum;
}

// Symmetric, positive definite, `width` numbers a row from the diagonal on. Solved by Cholesky's method in the band.
class BandSystem {
 public:
  BandSystem(size_t size, size_t width) : width_(width), rows_(size, std::vector<Real>(width)), right_(size) {}
  void add(size_t i, size_t k, Real value) {
    if (k >= i) rows_[i][k - i] += value;
  }
  void add_right(size_t i, Real value) { right_[i] += value; }
  // The unknown is 0.
  void fix(size_t i) {
    for (size_t k = 0; k < width_; ++k) {
      rows_[i][k] = 0;
      if (k <= i) rows_[i - k][k] = 0;
    }
    rows_[i][0] = 1;
    right_[i] = 0;
  }
  std::vector<Real> solved() {
    const size_t n = rows_.size();
    for (size_t i = 0; i < n; ++i) {
      const Real root = std::sqrt(rows_[i][0]);
      for (Real& value : rows_[i]) value /= root;
      right_[i] /= root;
      for (size_t k = 1; k < width_ && i + k < n; ++k) {
        for (size_t m = k; m < width_; ++m) rows_[i + k][m - k] -= rows_[i][k] * rows_[i][m];
        right_[i + k] -= rows_[i][k] * right_[i];
      }
    }
    for (size_t i = n; i-- > 0;) {
      for (size_t k = 1; k < width_ && i + k < n; ++k) right_[i] -= rows_[i][k] * right_[i + k];
      right_[i] /= rows_[i][0];
    }
    return right_;
  }

 private:
  size_t width_;
  std::vector<std::vector<Real>> rows_;
  std::vector<Real> right_;
};

class Fit {
 public:
  Fit(const ShapeSamples& samples, uint32_t order, uint32_t spans)
      : samples_(samples), each_(order + 1), spans_(spans), basis_(basis_of(order)), nodes_((spans + 1) * each_) {
    nodes_[spans * each_] = 1;
  }

  // Towards the samples from where the nodes are. Its own rounding is what is left for the next.
  void improve() {
    BandSystem system(nodes_.size(), 2 * each_);
    for (const ShapeSample& sample : samples_) {
      const Place place = place_of(sample.time);
      const Real missing = sample.position - at(place);
      std::array<Real, kMostCoefficients> share{};
      for (size_t i = 0; i < 2 * each_; ++i) share[i] = horner(basis_[i], place.x);
      for (size_t i = 0; i < 2 * each_; ++i) {
        for (size_t k = i; k < 2 * each_; ++k) system.add(place.first + i, place.first + k, share[i] * share[k]);
        system.add_right(place.first + i, share[i] * missing);
      }
    }
    for (size_t k = 0; k < std::min<size_t>(each_, 3); ++k) {
      system.fix(k);
      system.fix(spans_ * each_ + k);
    }
    const std::vector<Real> change = system.solved();
    for (size_t i = 0; i < nodes_.size(); ++i) nodes_[i] += change[i];
  }

  std::vector<int64_t> rounded() {
    std::vector<int64_t> whole;
    for (Real& node : nodes_) {
      const Real scaled = std::round(std::ldexp(node, kTableFractionBits));
      if (!(std::abs(scaled) <= static_cast<Real>(kLargestNode)))
        throw bad_argument("--spans", std::to_string(spans_),
                           "derivatives beyond what a table holds, more spans are accepted");
      whole.push_back(static_cast<int64_t>(scaled));
      node = std::ldexp(scaled, -kTableFractionBits);
    }
    return whole;
  }

  double largest_deviation() const {
    Real largest = 0;
    for (const ShapeSample& sample : samples_)
      largest = std::max(largest, std::abs(at(place_of(sample.time)) - sample.position));
    return static_cast<double>(largest);
  }

 private:
  struct Place {
    size_t first;  // node
    Real x;
  };
  Place place_of(Real time) const {
    const Real spans = time * static_cast<Real>(spans_);
    const auto span = static_cast<size_t>(std::min(std::floor(spans), static_cast<Real>(spans_ - 1)));
    return {span * each_, spans - static_cast<Real>(span)};
  }
  Real at(const Place& place) const {
    Real sum = 0;
    for (size_t i = 0; i < 2 * each_; ++i) sum += nodes_[place.first + i] * horner(basis_[i], place.x);
    return sum;
  }

  const ShapeSamples& samples_;
  size_t each_;
  size_t spans_;
  Basis basis_;
  std::vector<Real> nodes_;
};

void check_spans(const ShapeSamples& samples, uint32_t order, uint32_t spans) {
  std::vector<uint32_t> held(spans, 0);
  for (const ShapeSample& sample : samples) {
    const auto span = static_cast<uint32_t>(sample.time * static_cast<Real>(spans));
    ++held[std::min(span, spans - 1)];
  }
  if (std::all_of(held.begin(), held.end(), [order](uint32_t count) { return count > order; })) return;
  throw bad_argument("--spans", std::to_string(spans),
                     "too many for " + std::to_string(samples.size()) + " samples, spans of at least " +
                         std::to_string(order + 1) + " samples each are accepted");
}

}  // namespace

ShapeSamples read_shape(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw bad_argument("--from", path, "cannot be read, a CSV file of time,position lines is accepted");
  ShapeSamples samples;
  Columns columns{0, 1};
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string where = path + ", line " + std::to_string(number);
    line = trimmed(line);
    if (line.empty() || line[0] == '#') continue;
    std::vector<std::string> cells;
    for (const std::string& cell : split(line, ',')) cells.push_back(trimmed(cell));
    if (samples.empty() && !begins_like_a_number(cells[0])) {
      columns = columns_of(cells);
      continue;
    }
    const bool alone = cells.size() == 1;
    if (!alone && std::max(columns.time, columns.position) >= cells.size())
      throw bad_argument("--from", where, "too few columns, time,position is accepted");
    const Real time =
        alone ? static_cast<Real>(samples.size()) : static_cast<Real>(parse_number(cells[columns.time], where));
    if (!samples.empty() && !(time > samples.back().time))
      throw bad_argument("--from", where, "not after the line before, times that rise are accepted");
    samples.push_back({time, static_cast<Real>(parse_number(cells[alone ? 0 : columns.position], where))});
  }
  normalise(samples, path);
  return samples;
}

ShapeSamples sample_shape(const MoveTask& task, size_t least) {
  constexpr int32_t kCounts = 1 << 30;
  const double scale = kCounts / std::abs(static_cast<double>(task.distance_counts));
  MoveTask fine = task;
  fine.distance_counts = kCounts;
  fine.counts_per_unit *= scale;
  for (double* limit : {&fine.limits.velocity, &fine.limits.acceleration, &fine.limits.deceleration, &fine.limits.jerk,
                        &fine.limits.deceleration_jerk})
    *limit *= scale;
  fine.tick_s = plan_of(fine).optimum_ticks * fine.tick_s / static_cast<double>(least);
  const Plan plan = plan_of(fine);
  Track track{};
  Track::make(plan, 0, signal_from_counts(kCounts), track);
  Sampler sampler;
  sampler.begin(track);
  ShapeSamples samples{{0.0L, 0.0L}};
  for (uint32_t tick = 1; tick <= plan.duration_ticks; ++tick) {
    samples.push_back({static_cast<Real>(tick) / plan.duration_ticks,
                       std::ldexp(static_cast<Real>(sampler.tick()), -30 - kSignalFractionBits)});
  }
  return samples;
}

TableFit fit_table(const ShapeSamples& samples, uint32_t order, uint32_t spans) {
  check_spans(samples, order, spans);
  Fit fit(samples, order, spans);
  for (int i = 0; i < 3; ++i) fit.improve();
  TableFit result{{order, spans, fit.rounded(), {}}, 0.0};
  result.data.peaks = peaks_of_nodes(result.data.table());
  require(result.data.table().validate());
  result.largest_deviation = fit.largest_deviation();
  return result;
}

}  // namespace stillpoint::sim
