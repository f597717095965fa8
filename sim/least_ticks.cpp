// SPDX-License-Identifier: Apache-2.0
#include "sim/least_ticks.hpp"

#include <coin/Clp_C_Interface.h>

#include <cfloat>
#include <cmath>
#include <complex>
#include <memory>

namespace stillpoint::sim {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Free {
  void operator()(Clp_Simplex* model) const { Clp_deleteModel(model); }
};

// Rows of a programme whose columns are v_1 .. v_N, in units of the velocity limit.
class Programme {
 public:
  Programme(const LeastTicksQuestion& question, uint32_t ticks) : ticks_(ticks), model_(Clp_newModel()) {
    Clp_setLogLevel(model_.get(), 0);
    Clp_setPrimalTolerance(model_.get(), 1e-9);
    Clp_setDualTolerance(model_.get(), 1e-9);
    const double velocity = question.limits.velocity * question.tick_s;
    const double tick_2 = question.tick_s * question.tick_s;
    const std::vector<CoinBigIndex> none(ticks + 1, 0);
    const std::vector<double> highest(ticks, 1.0);
    const std::vector<double> lowest(ticks, -1.0);
    const std::vector<double> each(ticks, 1.0);
    Clp_setOptimizationDirection(model_.get(), -1.0);
    Clp_addColumns(model_.get(), static_cast<int>(ticks), lowest.data(), highest.data(), each.data(), none.data(),
                   nullptr, nullptr);
    add_differences({1.0, -1.0}, -question.limits.deceleration * tick_2 / velocity,
                    question.limits.acceleration * tick_2 / velocity);
    const double jerk = question.limits.larger_jerk() * tick_2 * question.tick_s / velocity;
    add_differences({1.0, -2.0, 1.0}, -jerk, jerk);
    for (const Mode& mode : question.modes) add_mode(mode, question.tick_s);
  }

  bool solve() {
    Clp_initialDualSolve(model_.get());
    return Clp_status(model_.get()) == 0;
  }
  const double* velocities() const { return Clp_primalColumnSolution(model_.get()); }

 private:
  // Of the stream's zeros before and after too.
  void add_differences(const std::vector<double>& weights, double low, double high) {
    for (uint32_t k = 0; k + 1 < ticks_ + weights.size(); ++k) {
      std::vector<int> columns;
      std::vector<double> row;
      for (uint32_t i = 0; i < weights.size(); ++i) {
        if (k < i || k - i >= ticks_) continue;
        columns.push_back(static_cast<int>(k - i));
        row.push_back(weights[i]);
      }
      add_row(columns, row, low, high);
    }
  }

  // sum v_k p^(N - k) = 0: the decay is counted from the end, where it is one.
  void add_mode(const Mode& mode, double tick_s) {
    const double angle = 2.0 * kPi * mode.frequency_hz * tick_s;
    const double damped = angle * std::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio);
    std::vector<int> columns;
    std::vector<double> real;
    std::vector<double> imaginary;
    for (uint32_t k = 0; k < ticks_; ++k) {
      const double before_end = static_cast<double>(ticks_ - 1 - k);
      const std::complex<double> power =
          std::polar(std::exp(-mode.damping_ratio * angle * before_end), damped * before_end);
      columns.push_back(static_cast<int>(k));
      real.push_back(power.real());
      imaginary.push_back(power.imag());
    }
    add_row(columns, real, 0.0, 0.0);
    add_row(columns, imaginary, 0.0, 0.0);
  }

  void add_row(const std::vector<int>& columns, const std::vector<double>& row, double low, double high) {
    const CoinBigIndex starts[] = {0, static_cast<CoinBigIndex>(row.size())};
    Clp_addRows(model_.get(), 1, &low, &high, starts, columns.data(), row.data());
  }

  uint32_t ticks_;
  std::unique_ptr<Clp_Simplex, Free> model_;
};

}  // namespace

double farthest(const LeastTicksQuestion& question, uint32_t ticks, std::vector<double>* setpoints) {
  Programme programme(question, ticks);
  if (!programme.solve()) return 0.0;
  const double unit = question.limits.velocity * question.tick_s;
  double position = 0.0;
  if (setpoints != nullptr) setpoints->clear();
  for (uint32_t k = 0; k < ticks; ++k) {
    position += programme.velocities()[k] * unit;
    if (setpoints != nullptr) setpoints->push_back(position);
  }
  return position;
}

std::optional<uint32_t> least_ticks(const LeastTicksQuestion& question, uint32_t known, const OnProgress& on_progress) {
  if (known > kMostLeastTicks) return std::nullopt;
  constexpr double kRounding = 1e-7;  // of the solver's tolerances, summed
  uint32_t too_few = 0;
  uint32_t enough = known;
  while (enough - too_few > 1) {
    const uint32_t middle = too_few + (enough - too_few) / 2;
    if (farthest(question, middle) >= question.distance * (1.0 - kRounding)) {
      enough = middle;
    } else {
      too_few = middle;
    }
    if (on_progress) on_progress(1.0 - static_cast<double>(enough - too_few) / known);
  }
  return enough;
}

}  // namespace stillpoint::sim
