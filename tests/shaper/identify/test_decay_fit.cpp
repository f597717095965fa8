// SPDX-License-Identifier: Apache-2.0
// The fit's own covariance against the Cramer-Rao bound of the analytic Fisher matrix in long double: two routes to the
// same number.
#include "shaper/identify/decay_fit.hpp"

#include <cmath>

#include "tests/shaper/identify/ringing.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

DecayModel model_of(const Ringing& ringing) {
  DecayModel model{};
  for (const TrueMode& mode : ringing.modes) {
    const double w = 2.0 * M_PI * mode.frequency_hz * ringing.duration_s;
    model.component[model.count++] =
        Component{mode.damping_ratio * w, w * std::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio), 0.0, 0.0};
  }
  return model;
}

}  // namespace

TEST_HOST(the_covariance_of_a_fit_is_the_cramer_rao_bound) {
  static DecayFit fit;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    Ringing ringing = random_ringing(random, 1 + seed % 3);
    ringing.duration_s = static_cast<double>(ringing.count()) / ringing.rate_hz;
    ringing.noise = 1.0;
    const std::vector<Bound> bounds = cramer_rao(ringing);
    ringing.noise = 0.0;
    const std::vector<float> samples = noisy(ringing, clean(ringing), random);
    DecayModel model = model_of(ringing);
    fit.solve_linear(record_of(samples), model);
    for (size_t k = 0; k < model.count; ++k) {
      const ComponentCovariance covariance = fit.covariance(model, k);
      const double s = model.component[k].decay, w = model.component[k].angle;
      const double natural = std::sqrt(s * s + w * w), to_hz = 1.0 / (2.0 * M_PI * ringing.duration_s);
      const double frequency =
          (s * s * covariance.decay + w * w * covariance.angle + 2.0 * s * w * covariance.decay_angle) /
          (natural * natural) * to_hz * to_hz;
      const double damping =
          (w * w * covariance.decay + s * s * covariance.angle - 2.0 * s * w * covariance.decay_angle) * w * w /
          std::pow(natural, 6);
      TEST_INFO(seed, seed);
      TEST_ASSERT_DOUBLE_RELATIVE(1e-4, bounds[k].frequency_variance, frequency);
      TEST_ASSERT_DOUBLE_RELATIVE(1e-4, bounds[k].damping_variance, damping);
    }
  }
}

// From a third of a bin and a fifth of the decay beside the truth, the fit of a clean record ends on it.
TEST_HOST(a_fit_of_a_clean_record_ends_on_the_truth) {
  static DecayFit fit;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    Ringing ringing = random_ringing(random, 1 + seed % 3);
    ringing.duration_s = static_cast<double>(ringing.count()) / ringing.rate_hz;
    const std::vector<float> samples = noisy(ringing, clean(ringing), random);
    const DecayModel truth = model_of(ringing);
    DecayModel model = truth;
    for (size_t k = 0; k < model.count; ++k) {
      model.component[k].angle += random.between(-2.0, 2.0);
      model.component[k].decay *= random.between(0.8, 1.2);
    }
    TEST_INFO(seed, seed);
    TEST_ASSERT_TRUE(fit.refine(record_of(samples), model));
    for (size_t k = 0; k < model.count; ++k) {
      TEST_ASSERT_DOUBLE_WITHIN(1e-4 * truth.component[k].angle, truth.component[k].angle, model.component[k].angle);
      TEST_ASSERT_DOUBLE_WITHIN(1e-4 * truth.component[k].angle, truth.component[k].decay, model.component[k].decay);
    }
  }
}
