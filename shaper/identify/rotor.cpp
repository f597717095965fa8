// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/rotor.hpp"

namespace stillpoint {

Rotor::Rotor(const Complex& rate, size_t first) : rate_(rate), step_(math::exp(rate)), n_(first) { renew(); }

void Rotor::renew() { value_ = math::exp(static_cast<double>(n_) * rate_); }

}  // namespace stillpoint
