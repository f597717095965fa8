// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/identify.hpp"

#include "shaper/identify/saturation.hpp"
#include "shaper/identify/viscosity.hpp"

namespace stillpoint {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr size_t kLeastSamples = 32;
constexpr double kLeastPeriods = 3.0;
constexpr double kLeastDecay = 0.025;  // over the record; a hum's amplitude wanders by as much
constexpr double kSureDecay = 4.0;     // standard deviations above none
constexpr double kRingsAtMost = 0.6;   // damping ratio; beyond, one half-wave is all there is

// When two parts of a decay differ: beyond chance, and by so much that it matters.
constexpr double kDiffers = 3.0;
constexpr double kNotViscous = 4.0;
constexpr double kNotViscousPart = 0.25;

enum class Nature : uint8_t { kRinging, kHum, kSlow, kTransient, kUnclear };

[[gnu::noinline]] double damping_ratio_of(double decay, double angle) {
  return decay / math::sqrt(decay * decay + angle * angle);
}

Nature nature_of(const Component& component, const ComponentDoubt& doubt) {
  const double spread = math::sqrt(doubt.decay);
  if (doubt.evidence < kLeastEvidence) return Nature::kUnclear;
  if (damping_ratio_of(component.decay, component.angle) > kRingsAtMost) return Nature::kTransient;
  if (component.angle < kLeastPeriods * 2.0 * kPi) return Nature::kSlow;
  if (component.decay > kLeastDecay && component.decay > kSureDecay * spread) return Nature::kRinging;
  return spread < 0.5 ? Nature::kHum : Nature::kUnclear;
}

// Where the decay stands against each doubt: 1 with none, 1/2 where it is as large as `half`.
double trust(double doubt, double half) { return 1.0 / (1.0 + math::square(doubt / half)); }

// Of a variance, which rounding may have taken below zero.
double root(double variance) { return variance > 0.0 ? math::sqrt(variance) : 0.0; }

class Report {
 public:
  Report(const Record& record, const IdentifyConfig& config, const Decomposition& parts, IdentifyScratch& scratch,
         const Meanwhile& meanwhile)
      : record_(record), config_(config), parts_(parts), scratch_(scratch), meanwhile_(meanwhile) {}

  void write(Identification& result) {
    result.model = parts_.model;
    result.noise = math::sqrt(parts_.variance);
    const double to_hz = config_.rate_hz / (2.0 * kPi * static_cast<double>(record_.count));
    bool seen[5] = {};
    double hum = 0.0;
    for (size_t k = 0; k < parts_.model.count; ++k) {
      const Component& component = parts_.model.component[k];
      const Nature nature = nature_of(component, parts_.doubt[k]);
      seen[static_cast<size_t>(nature)] = true;
      const double amplitude = amplitude_of(component);
      if (nature == Nature::kRinging) insert(mode_of(k), result);
      if (nature == Nature::kHum && amplitude > hum) {
        hum = amplitude;
        result.hum_hz = component.angle * to_hz;
      }
    }
    drop_the_weak(result);
    const auto saw = [&](Nature nature) { return seen[static_cast<size_t>(nature)]; };
    if (result.mode_count > 0) {
      result.finding = Finding::kFound;
      result.confidence = result.mode[0].confidence;
    } else if (saw(Nature::kSlow)) {
      result.finding = Finding::kTooShort;
    } else if (saw(Nature::kUnclear) || (parts_.model.count == 0 && parts_.best_score > kNoisyScore)) {
      result.finding = Finding::kNoisy;
    } else {
      result.finding = Finding::kNoMode;
    }
  }

 private:
  static constexpr double kNoisyScore = 12.0;  // one record of white noise in a hundred

  static double amplitude_of(const Component& component) {
    return math::sqrt(math::square(component.cosine) + math::square(component.sine));
  }

  static void insert(const IdentifiedMode& mode, Identification& result) {
    size_t at = result.mode_count++;
    for (; at > 0 && result.mode[at - 1].amplitude < mode.amplitude; --at) result.mode[at] = result.mode[at - 1];
    result.mode[at] = mode;
  }

  void drop_the_weak(Identification& result) const {
    while (result.mode_count > 1 &&
           (result.mode_count > config_.most_modes ||
            result.mode[result.mode_count - 1].amplitude < config_.least_amplitude * result.mode[0].amplitude)) {
      result.mode[--result.mode_count] = IdentifiedMode{};
    }
  }

  IdentifiedMode mode_of(size_t k) {
    const Component& component = parts_.model.component[k];
    const ComponentDoubt& doubt = parts_.doubt[k];
    const double to_hz = config_.rate_hz / (2.0 * kPi * static_cast<double>(record_.count));
    const double s = component.decay, w = component.angle;
    const double natural = math::sqrt(s * s + w * w);
    IdentifiedMode mode{};
    mode.frequency_hz = natural * to_hz;
    mode.damping_ratio = s / natural;
    mode.amplitude = amplitude_of(component);
    const double of_natural = (s * s * doubt.decay + w * w * doubt.angle + 2.0 * s * w * doubt.decay_angle);
    const double of_damping = w * w * doubt.decay + s * s * doubt.angle - 2.0 * s * w * doubt.decay_angle;
    mode.frequency_std_hz = root(of_natural) / natural * to_hz;
    mode.damping_std = w / (natural * natural * natural) * root(of_damping);
    mode.viscous = true;
    compare_parts(k, to_hz, mode);
    mode.confidence = trust(mode.frequency_std_hz, 0.02 * mode.frequency_hz) *
                      trust(mode.damping_std, 0.5 * mode.damping_ratio) * trust(doubt.structure, 0.1) *
                      (mode.viscous ? 1.0 : 0.5);
    return mode;
  }

  void compare_parts(size_t k, double to_hz, IdentifiedMode& mode) {
    // Coloured noise is stronger where the mode is, or weaker; what a wrong model leaves there is no noise.
    const ComponentDoubt& doubt = parts_.doubt[k];
    const bool coloured = doubt.structure == 0.0 && doubt.noise > parts_.variance && parts_.variance > 0.0;
    const double colour = coloured ? doubt.noise / parts_.variance : 1.0;
    const TwoParts two = fit_two_parts(record_, parts_.model, k, colour, scratch_.fit, meanwhile_);
    if (!two.known) return;
    mode.damping_early = damping_ratio_of(two.decay[0], two.angle[0]);
    mode.damping_late = damping_ratio_of(two.decay[1], two.angle[1]);
    const double damping_spread =
        math::sqrt(math::square(two.decay_std[0]) + math::square(two.decay_std[1])) / two.angle[0];
    const double damping_change = math::magnitude(mode.damping_late - mode.damping_early);
    const double angle_spread = math::sqrt(math::square(two.angle_std[0]) + math::square(two.angle_std[1]));
    const double angle_change = math::magnitude(two.angle[1] - two.angle[0]);
    if (damping_change > kDiffers * damping_spread)
      mode.damping_std = math::sqrt(math::square(mode.damping_std) + math::square(0.5 * damping_change));
    if (angle_change > kDiffers * angle_spread)
      mode.frequency_std_hz =
          math::sqrt(math::square(mode.frequency_std_hz) + math::square(0.5 * angle_change * to_hz));
    mode.viscous =
        damping_change <= kNotViscous * damping_spread || damping_change <= kNotViscousPart * mode.damping_ratio;
  }

  const Record& record_;
  const IdentifyConfig& config_;
  const Decomposition& parts_;
  IdentifyScratch& scratch_;
  const Meanwhile& meanwhile_;
};

Status check(const Record& record, const IdentifyScratch& scratch) {
  if (record.count > scratch.size) {
    return refuse(Error::kAboveMaximum, Quantity::kSamples, static_cast<double>(record.count),
                  static_cast<double>(scratch.size));
  }
  for (size_t n = 0; n < record.count; ++n) {
    const auto sample = static_cast<double>(record.samples[n]);
    if (!math::is_finite(sample)) return refuse(Error::kNotFinite, Quantity::kSamples, sample);
  }
  return kOk;
}

}  // namespace

const char* text(Finding finding) {
  switch (finding) {
    case Finding::kFound: return "ok";
    case Finding::kNoMode: return "no_mode";
    case Finding::kNoisy: return "noisy";
    case Finding::kSaturated: return "saturated";
    case Finding::kTooShort: return "too_short";
    case Finding::kTravelLimit: return "travel_limit";
    case Finding::kAborted: return "aborted";
  }
  return "unknown";
}

Status IdentifyConfig::validate() const {
  Status status = check_positive(Quantity::kFrequency, rate_hz);
  if (status.ok()) status = check_count(Quantity::kStages, most_modes, 1, kMostComponents);
  if (!status.ok()) return status;
  if (!(least_amplitude >= 0.0)) return refuse(Error::kBelowMinimum, Quantity::kTolerance, least_amplitude, 0.0);
  if (least_amplitude > 1.0) return refuse(Error::kAboveMaximum, Quantity::kTolerance, least_amplitude, 1.0);
  return kOk;
}

Status identify(const Record& record, const IdentifyConfig& config, IdentifyScratch scratch, Identification& result,
                const Meanwhile& meanwhile) {
  Status status = config.validate();
  if (status.ok()) status = check(record, scratch);
  if (!status.ok()) return status;
  result = Identification{};
  if (record.count < kLeastSamples) {
    result.finding = Finding::kTooShort;
    return status;
  }
  const Decomposition parts = decompose(record, scratch, meanwhile);
  Report(record, config, parts, scratch, meanwhile).write(result);
  if ((!config.ends_known && is_saturated(record)) ||
      (result.finding == Finding::kFound && is_flattened(record, result.model))) {
    result.finding = Finding::kSaturated;
    result.mode_count = 0;
    result.confidence = 0.0;
  }
  if (meanwhile.is_given_up()) result.finding = Finding::kAborted;
  return status;
}

}  // namespace stillpoint
