// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

#include "shaper/base/complex.hpp"

namespace stillpoint {

// exp(rate * n) for n = first, first + 1, ...: by recurrence, taken anew every kExact steps, so that rounding stays at
// a few units in the last place at a fifth of the cost. Background.
class Rotor {
 public:
  Rotor() = default;
  explicit Rotor(const Complex& rate, size_t first = 0);

  Complex value() const { return value_; }
  void advance() {
    ++n_;
    if (n_ % kExact == 0) {
      renew();
    } else {
      value_ = value_ * step_;
    }
  }

 private:
  static constexpr size_t kExact = 16;

  void renew();

  Complex rate_{0.0, 0.0};
  Complex step_{1.0, 0.0};
  Complex value_{1.0, 0.0};
  size_t n_ = 0;
};

}  // namespace stillpoint
