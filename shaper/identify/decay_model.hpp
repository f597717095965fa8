// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

#include "shaper/base/math.hpp"
#include "shaper/identify/record.hpp"
#include "shaper/identify/rotor.hpp"

namespace stillpoint {

constexpr size_t kMostComponents = 4;

// exp(-decay x) (cosine cos(angle x) + sine sin(angle x)), x = n / count from 0 to 1 over the record: `decay` is the
// logarithm of what the record leaves of it, `angle` the (damped) radians in the record. Neither knows a unit.
struct Component {
  double decay;
  double angle;
  double cosine;
  double sine;
};

// A record as a sum of damped sinusoids, an offset and a drift that is 0 in the middle of the record.
struct DecayModel {
  double offset;
  double drift;  // over the record
  size_t count;
  Component component[kMostComponents];
};

// The model's samples one after the other. Cost: 8 multiplications and additions a component and step.
class ModelSamples {
 public:
  ModelSamples(const DecayModel& model, size_t count) : model_(model), step_(1.0 / static_cast<double>(count)) {
    for (size_t k = 0; k < model.count; ++k) {
      rotor_[k] = Rotor({-model.component[k].decay * step_, model.component[k].angle * step_});
    }
  }

  double next() {
    double sum = model_.offset + model_.drift * (static_cast<double>(n_) * step_ - 0.5);
    for (size_t k = 0; k < model_.count; ++k) {
      const Complex turn = rotor_[k].value();
      sum += model_.component[k].cosine * turn.re + model_.component[k].sine * turn.im;
      rotor_[k].advance();
    }
    ++n_;
    return sum;
  }

 private:
  const DecayModel& model_;
  double step_;
  size_t n_ = 0;
  Rotor rotor_[kMostComponents];
};

}  // namespace stillpoint
