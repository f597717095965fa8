// SPDX-License-Identifier: Apache-2.0
#include "shaper/tune/ringing.hpp"

namespace stillpoint {

namespace {

double natural_angle(const Component& component) {
  return math::sqrt(math::square(component.decay) + math::square(component.angle));
}

bool is_mode(const Identification& found, const Component& component, double to_hz) {
  const double frequency = natural_angle(component) * to_hz;
  for (size_t k = 0; k < found.mode_count; ++k) {
    if (math::abs(found.mode[k].frequency_hz - frequency) < 1e-9 * frequency) return true;
  }
  return false;
}

// All that was fitted but the modes.
DecayModel without_modes(const Identification& found, const DecayModel& model, double to_hz) {
  DecayModel rest{model.offset, model.drift, 0, {}};
  for (size_t k = 0; k < model.count; ++k) {
    if (!is_mode(found, model.component[k], to_hz)) rest.component[rest.count++] = model.component[k];
  }
  return rest;
}

}  // namespace

Ringing ringing_of(const Record& record, double rate_hz, double low_hz, double high_hz, const Identification& found,
                   IdentifyScratch scratch, const Meanwhile& meanwhile) {
  Ringing result{};
  const size_t size = fft_size_for(record.count);
  if (size == 0 || size > scratch.size || found.mode_count == 0) return result;
  const auto count = static_cast<double>(record.count);
  DecayModel model = found.model;
  scratch.fit.solve_linear(record, model, nullptr, meanwhile);
  const DecayModel rest = without_modes(found, model, rate_hz / (2.0 * math::kPi * count));
  const IdentifiedMode& strongest = found.mode[0];
  const double decay = 2.0 * math::kPi * strongest.frequency_hz * strongest.damping_ratio * count / rate_hz;
  double weight = 0.0;
  if (!power_of_residual(record, rest, decay, scratch.buffer, size, weight)) return result;
  const auto points = static_cast<double>(size);
  const double to_bin = points / rate_hz;
  const auto last = static_cast<size_t>(high_hz * to_bin);
  double energy = 0.0;
  uint32_t counted = 0;
  for (size_t k = static_cast<size_t>(low_hz * to_bin) + 1; k < size / 2 && k <= last; ++k, ++counted)
    energy += scratch.buffer[k];
  const double bins = counted;
  // Each bin stands for its mirror too. Bins nearer than the window is wide go up and down together.
  const double noise = math::square(found.noise);
  const double alike = (1.0 + decay / math::kPi) * points / count;
  const double deviation = noise * math::sqrt(bins * alike);
  const double clean = energy / weight - noise * bins;
  const double positive = clean > 0.0 ? clean : 0.0;
  // The cross term of ringing and noise.
  const double cross = math::sqrt(2.0 * positive * noise);
  result.level = math::sqrt(2.0 / points * positive);
  result.at_most =
      math::sqrt(2.0 / points * (positive + 3.0 * math::sqrt(math::square(deviation) + math::square(cross))));
  return result;
}

}  // namespace stillpoint
