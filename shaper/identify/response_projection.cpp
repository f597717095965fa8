// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/response_projection.hpp"

#include "shaper/base/linear.hpp"
#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

constexpr int kMostPasses = 40;
constexpr double kWider = 1.2;  // modes are looked for beyond the band
constexpr double kLeastDamping = 0.001;

// What a spread is at least: of the median, of the answer itself and of the largest.
constexpr double kOfMedian = 0.25;
constexpr double kOfAnswer = 1e-3;
constexpr double kOfLargest = 1e-7;

[[gnu::noinline]] double bounded(double value, double low, double high) {
  return value < low ? low : value > high ? high : value;
}
[[gnu::noinline]] double size_of(const BinAnswer& answer) {
  return math::greater(math::magnitude(answer.re), math::magnitude(answer.im));
}

}  // namespace

ResponseProjection::ResponseProjection(const BinAnswer* answers, size_t count, const ResponseConfig& config,
                                       ResponseScratch& scratch, const Meanwhile& meanwhile)
    : answers_(answers), count_(count), config_(config), scratch_(scratch), meanwhile_(meanwhile) {
  top_ = answers[count - 1].frequency_hz;
  double largest = 0.0;
  for (size_t n = 0; n < count; ++n) largest = math::greater(largest, size_of(answers[n]));
  const double median = median_spread();
  floor_ = math::greater(kOfMedian * median, kOfLargest * largest);
}

[[gnu::noinline]] Complex& ResponseProjection::at(size_t row, size_t column) {
  return scratch_.triangle[column * (column + 1) / 2 + row];
}

double ResponseProjection::median_spread() const {
  double median = 0.0;
  for (size_t n = 0; n < count_; ++n) {
    size_t below = 0;
    for (size_t k = 0; k < count_; ++k) below += answers_[k].spread < answers_[n].spread ? 1 : 0;
    if (2 * below <= count_) median = math::greater(median, answers_[n].spread);
  }
  return median;
}

[[gnu::noinline]] double ResponseProjection::power_of(double x) const {
  double power = 1.0;
  for (uint32_t i = 0; i < config_.power; ++i) power *= x;
  return power;
}

// A row of the matrix comes into the triangle by Givens rotations; diagonals stay real.
void ResponseProjection::push(Complex* row) {
  for (size_t j = 0; j < columns_; ++j) {
    const double below = square_of(row[j]);
    if (below == 0.0) continue;
    Complex& diagonal = at(j, j);
    const double length = math::sqrt(math::square(diagonal.re) + below);
    const double c = diagonal.re / length;
    const Complex s = (1.0 / length) * row[j];
    diagonal.re = length;
    for (size_t k = j + 1; k < columns_; ++k) {
      const Complex above = at(j, k);
      at(j, k) = c * above + conjugate(s) * row[k];
      row[k] = c * row[k] - s * above;
    }
  }
}

// Columns: what does not resonate, the modes; with `slopes`, their derivatives by the logarithms of frequency and
// damping, and the answers' by the delay; the answers. These are turned back by the delay, not the model by it.
void ResponseProjection::write_row(const BinAnswer& answer, const ResponseModel& model, bool slopes,
                                   Complex* row) const {
  const double x = answer.frequency_hz / top_;
  const double weight = 1.0 / math::greater(math::greater(answer.spread, floor_), kOfAnswer * size_of(answer));
  const double unit = weight * power_of(x);
  const double xx = x * x;
  row[0] = {unit, 0.0};
  row[1] = {unit * xx, 0.0};
  row[2] = {unit * xx * xx, 0.0};
  Complex* slope = row + kRigidColumns + model.count;
  for (size_t k = 0; k < model.count; ++k) {
    const double from = x / model.parameter[2 * k];
    const double square = from * from;
    const double lag = 2.0 * model.parameter[2 * k + 1] * from;
    const Complex one = Complex{1.0, 0.0} / Complex{1.0 - square, lag};
    row[kRigidColumns + k] = unit * one;
    if (!slopes) continue;
    const Complex twice = row[kRigidColumns + k] * one;
    *slope++ = Complex{-2.0 * square, lag} * twice;
    *slope++ = Complex{0.0, -lag} * twice;
  }
  const Complex turned = weight * (Complex{answer.re, answer.im} * math::exp(Complex{0.0, model.turn * x}));
  if (slopes) *slope++ = Complex{0.0, x} * turned;
  *slope = turned;
}

double ResponseProjection::pass(const ResponseModel& model, bool slopes) {
  meanwhile_();
  const size_t linear = kRigidColumns + model.count;
  columns_ = linear + (slopes ? 2 * model.count + 1 : 0) + 1;
  for (size_t i = 0; i < columns_ * (columns_ + 1) / 2; ++i) scratch_.triangle[i] = {0.0, 0.0};
  Complex row[ResponseScratch::kColumns];
  for (size_t n = 0; n < count_; ++n) {
    write_row(answers_[n], model, slopes, row);
    push(row);
  }
  double left = 0.0;
  for (size_t i = linear; i < columns_; ++i) left += square_of(at(i, columns_ - 1));
  return left;
}

void ResponseProjection::take_factors(ResponseModel& model) {
  for (size_t i = kRigidColumns + model.count; i-- > 0;) {
    Complex sum = at(i, columns_ - 1);
    for (size_t k = i + 1; k < kRigidColumns + model.count; ++k) sum = sum - at(i, k) * model.factor[k];
    const double diagonal = at(i, i).re;
    model.factor[i] = (diagonal > 0.0 ? 1.0 / diagonal : 0.0) * sum;
  }
}

// The linearised problem in logarithms and the delay.
void ResponseProjection::take_normal(const ResponseModel& model) {
  const size_t linear = kRigidColumns + model.count;
  const size_t size = 2 * model.count + 1;
  LinearSystem<ResponseScratch::kParameters>& normal = scratch_.normal;
  normal.clear(size);
  for (size_t i = 0; i < size; ++i) {
    Complex slope[ResponseScratch::kParameters + 1];
    for (size_t k = i; k < size; ++k) {
      const Complex factor = k + 1 == size ? Complex{-1.0, 0.0} : model.factor[kRigidColumns + k / 2];
      slope[k] = factor * at(linear + i, linear + k);
    }
    slope[size] = at(linear + i, columns_ - 1);
    for (size_t j = i; j < size; ++j) {
      for (size_t k = i; k <= size; ++k) {
        const double product = (conjugate(slope[j]) * slope[k]).re;
        (k < size ? normal.row[j][k] : normal.right(j)) += product;
      }
    }
  }
}

// Returns how far the sum of squares would fall; below 0 where nothing can be told.
double ResponseProjection::step(double damping, double* change) {
  LinearSystem<ResponseScratch::kParameters> damped = scratch_.normal;
  for (size_t i = 0; i < damped.size; ++i) damped.row[i][i] *= 1.0 + damping;
  if (!damped.solve(change)) return -1.0;
  double gain = 0.0;
  for (size_t i = 0; i < damped.size; ++i) gain += change[i] * scratch_.normal.right(i);
  return gain;
}

ResponseModel ResponseProjection::moved(const ResponseModel& from, const double* change) const {
  constexpr double kFurthest = 0.7;
  ResponseModel model = from;
  for (size_t k = 0; k < 2 * model.count; ++k) {
    const bool is_damping = k % 2 == 1;
    const double reach = is_damping ? kFurthest : 0.2 * kFurthest;
    model.parameter[k] = bounded(model.parameter[k] * math::exp(bounded(change[k], -reach, reach)),
                                 is_damping ? kLeastDamping : answers_[0].frequency_hz / (kWider * top_),
                                 is_damping ? kMostResponseDamping : kWider);
  }
  model.turn += bounded(change[2 * model.count], -kFurthest, kFurthest);
  return model;
}

double ResponseProjection::refine(ResponseModel& model) {
  constexpr double kDone = 1e-4;  // of a standard deviation, squared
  double left = pass(model, true);
  take_factors(model);
  take_normal(model);
  double damping = 1e-3;
  for (int passes = 1; passes < kMostPasses && damping < 1e6; ++passes) {
    double change[ResponseScratch::kParameters];
    const double gain = step(damping, change);
    if (gain >= 0.0 && damping <= 1.0 && gain <= kDone * left / freedom(model)) break;
    ResponseModel trial = model;
    double then = left;
    if (gain > 0.0) {
      trial = moved(model, change);
      then = pass(trial, true);
    }
    if (then < left) {
      left = then;
      model = trial;
      take_factors(model);
      take_normal(model);
      damping *= 0.1;
    } else {
      damping *= damping < 1e-3 ? 100.0 : 10.0;
    }
  }
  return left;
}

[[gnu::noinline]] double ResponseProjection::freedom(const ResponseModel& model) const {
  return static_cast<double>(2 * count_ - (2 * kRigidColumns + 1 + 4 * model.count));
}

double ResponseProjection::deviation(size_t parameter, double noise) const {
  LinearSystem<ResponseScratch::kParameters> system = scratch_.normal;
  for (size_t i = 0; i < system.size; ++i) system.right(i) = i == parameter ? 1.0 : 0.0;
  double column[ResponseScratch::kParameters];
  if (!system.solve(column) || !(column[parameter] > 0.0)) return math::kInfinity;
  return math::sqrt(noise * column[parameter]);
}

}  // namespace stillpoint
