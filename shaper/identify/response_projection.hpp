// SPDX-License-Identifier: Apache-2.0
// Modes, and what does not resonate, against an arm's answers: the nearest least sum of squares. See response_fit.hpp.
// Background.
#pragma once

#include <stddef.h>

#include "shaper/base/complex.hpp"
#include "shaper/base/meanwhile.hpp"
#include "shaper/identify/response_fit.hpp"

namespace stillpoint {

constexpr size_t kRigidColumns = 3;  // of what does not resonate
constexpr double kMostResponseDamping = 0.6;

// Frequencies in units of the highest answer's.
struct ResponseModel {
  size_t count;
  double turn;                               // of the delay, radians at the highest answer
  double parameter[2 * kMostResponseModes];  // frequency, damping, frequency, ...
  Complex factor[kRigidColumns + kMostResponseModes];
};

// Variable projection: the factors are the best ones of what the modes and the delay are, so only these are looked for.
class ResponseProjection {
 public:
  // At least one answer. Refers to all of it.
  ResponseProjection(const BinAnswer* answers, size_t count, const ResponseConfig& config, ResponseScratch& scratch,
                     const Meanwhile& meanwhile);

  // Or all that was heard is zeros.
  bool heard() const { return floor_ > 0.0; }

  // The weighted sum of squares that is left with the best factors.
  double left_by(const ResponseModel& model) { return pass(model, false); }

  // To the nearest least sum of squares, which it returns; leaves factors and the linearised problem there.
  double refine(ResponseModel& model);

  // Of what is left.
  double freedom(const ResponseModel& model) const;

  // Of the logarithm of a parameter, by the problem that `refine` left; infinity where nothing can be told.
  double deviation(size_t parameter, double noise) const;

  // To the power of jw that the sensor puts before it all.
  double power_of(double x) const;

  double top_hz() const { return top_; }

 private:
  Complex& at(size_t row, size_t column);
  double median_spread() const;
  void push(Complex* row);
  void write_row(const BinAnswer& answer, const ResponseModel& model, bool slopes, Complex* row) const;
  double pass(const ResponseModel& model, bool slopes);
  void take_factors(ResponseModel& model);
  void take_normal(const ResponseModel& model);
  double step(double damping, double* change);
  ResponseModel moved(const ResponseModel& from, const double* change) const;

  const BinAnswer* answers_;
  size_t count_;
  const ResponseConfig& config_;
  ResponseScratch& scratch_;
  const Meanwhile& meanwhile_;
  size_t columns_ = 0;
  double top_;
  double floor_;
};

}  // namespace stillpoint
