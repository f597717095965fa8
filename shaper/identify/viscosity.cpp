// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/viscosity.hpp"

namespace stillpoint {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kLeastPeriods = 1.5;
constexpr size_t kLeastSamples = 24;

// The same model, told from the part of the record that begins at `first` (of 1) and is `length` long.
DecayModel seen_from(const DecayModel& model, double first, double length) {
  DecayModel part = model;
  part.offset = model.offset + model.drift * (first + 0.5 * length - 0.5);
  part.drift = model.drift * length;
  for (size_t k = 0; k < model.count; ++k) {
    const Component& from = model.component[k];
    const Complex turn = math::exp(Complex{-from.decay * first, from.angle * first});
    part.component[k] = Component{from.decay * length, from.angle * length, from.cosine * turn.re + from.sine * turn.im,
                                  from.sine * turn.re - from.cosine * turn.im};
  }
  return part;
}

}  // namespace

TwoParts fit_two_parts(const Record& record, const DecayModel& model, size_t k, double colour, DecayFit& fit,
                       const Meanwhile& meanwhile) {
  TwoParts parts{};
  const Component& whole = model.component[k];
  const double period = 2.0 * kPi / whole.angle;
  double split = whole.decay > 2.0 ? 1.0 / whole.decay : 0.5;
  if (split < kLeastPeriods * period) split = kLeastPeriods * period;
  const auto count = static_cast<double>(record.count);
  const auto at = static_cast<size_t>(math::floor(split * count));
  if (split + kLeastPeriods * period > 1.0 || at < kLeastSamples || record.count - at < kLeastSamples) return parts;
  const size_t edges[] = {0, at, record.count};
  for (int i = 0; i < 2; ++i) {
    const Record part = record.part(edges[i], edges[i + 1]);
    const double length = static_cast<double>(part.count) / count;
    DecayModel others = seen_from(model, static_cast<double>(edges[i]) / count, length);
    DecayModel one{};
    one.count = 1;
    one.component[0] = others.component[k];
    others.component[k] = others.component[--others.count];
    if (!fit.refine(part, one, &others, meanwhile)) return parts;
    const ComponentCovariance covariance = fit.covariance(one, 0);
    const double variance = colour * fit.residual_energy() / static_cast<double>(part.count - 6);
    parts.decay[i] = one.component[0].decay / length;
    parts.angle[i] = one.component[0].angle / length;
    parts.decay_std[i] = math::sqrt(variance * covariance.decay) / length;
    parts.angle_std[i] = math::sqrt(variance * covariance.angle) / length;
  }
  parts.known = true;
  return parts;
}

}  // namespace stillpoint
