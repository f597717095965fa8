// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/recommend.hpp"

#include "shaper/shaping/free_cascade.hpp"
#include "shaper/shaping/peak.hpp"
#include "shaper/shaping/prototype.hpp"

namespace stillpoint {

namespace {

constexpr uint32_t kNamed = 12;  // ZV to CV4, in the order of ShaperKind
constexpr uint32_t kThreeFree = kNamed;
// What the drive's registers hold; divided by, not multiplied with the reciprocal, so that few decimals stay few.
constexpr double kPerHz = 1e4;
constexpr double kPerDamping = 1e5;
constexpr double kPerPart = 1e4;  // of spacing and tolerance

double rounded_down(double value, double per_one) { return math::floor(value * per_one + 1e-6) / per_one; }
double rounded(double value, double per_one) { return math::floor(value * per_one + 0.5) / per_one; }

// Bands of frequency over the mode's in which a prototype leaves at most the tolerance, at both dampings.
struct RatioBand {
  double low;
  double high;
  bool holds(double high_over_low) const { return low > 0.0 && high >= low * high_over_low; }
};

RatioBand ratio_band(const Prototype& prototype, const ModeBand& band, double tolerance) {
  constexpr double kStep = 0.01;
  constexpr double kHighest = 20.0;
  const double log_tolerance = math::log(tolerance) + 1e-9;
  const double inner_low = prototype.zeros[0].ratio;
  const double inner_high = prototype.zeros[prototype.zero_count - 1].ratio;
  RatioBand both{0.0, kHighest};
  const double dampings[] = {band.low_damping, band.high_damping};
  for (int i = 0; i < 2; ++i) {
    const double z = dampings[i];
    if (log_residual(prototype.train, inner_low, z).value > log_tolerance ||
        log_residual(prototype.train, inner_high, z).value > log_tolerance)
      return {0.0, 0.0};
    const double low = edge_towards(prototype.train, z, log_tolerance, inner_low, 0.0, kStep);
    const double high = edge_towards(prototype.train, z, log_tolerance, inner_high, kHighest, kStep);
    if (low > both.low) both.low = low;
    if (high < both.high) both.high = high;
  }
  return both;
}

double middle_damping(const ModeBand& band) {
  return rounded(0.5 * (band.low_damping + band.high_damping), kPerDamping);
}

void add_spec(Candidate& candidate, ShaperKind kind, double frequency_hz, double damping, double tolerance,
              double spacing) {
  const Mode mode{rounded_down(frequency_hz, kPerHz), damping};
  candidate.specs[candidate.spec_count++] =
      ShaperSpec{kind, mode, rounded_down(tolerance, kPerPart), rounded(spacing, kPerPart), nullptr};
}

// The mode as high as the low end of the band allows, or, where the band is too wide, in its middle.
void add_shifted(Candidate& candidate, const ShaperSpec& spec, const Prototype& prototype, const ModeBand& band,
                 double tolerance) {
  const RatioBand ratios = ratio_band(prototype, band, tolerance);
  double frequency = math::sqrt(band.low_hz * band.high_hz);
  if (ratios.holds(band.high_hz / band.low_hz)) {
    frequency = band.low_hz / ratios.low;
  } else if (ratios.low > 0.0 && ratios.high > ratios.low) {
    frequency /= math::sqrt(ratios.low * ratios.high);
  }
  add_spec(candidate, spec.kind, frequency, spec.mode.damping_ratio, spec.tolerance, spec.spacing);
}

void make_named(ShaperKind kind, const ModeBand& band, double tolerance, Candidate& candidate) {
  const ShaperSpec spec{kind, {1.0, middle_damping(band)}, rounded_down(tolerance, kPerPart), kDefaultSpacing, nullptr};
  Prototype prototype;
  if (spec.tolerance < kMinTolerance || !make_prototype(spec, prototype).ok()) return;
  add_shifted(candidate, spec, prototype, band, tolerance);
}

// Three impulses have a second zero at (1 / spacing - 1) times the mode. From spacing 1/4 (ZV) on the band grows until
// the hump between the zeros is the tolerance (there it is EI); at the least spacing that holds the band the shaper is
// shortest.
void make_three_free(const ModeBand& band, double tolerance, Candidate& candidate) {
  const double damping = middle_damping(band);
  const double wanted = band.high_hz / band.low_hz;
  double narrow = kMinSpacing;
  double wide = kMaxSpacing;
  for (int i = 0; i < 20; ++i) {
    const double spacing = 0.5 * (narrow + wide);
    const ShaperSpec spec{ShaperKind::kMzv, {1.0, damping}, kDefaultTolerance, spacing, nullptr};
    Prototype prototype;
    if (!make_prototype(spec, prototype).ok()) return;
    const double second = 1.0 / spacing - 1.0;
    const double hump = peak_between(prototype.train, damping, 1.0, second).log_residual;
    const bool holds = hump <= math::log(tolerance) || ratio_band(prototype, band, tolerance).holds(wanted);
    (holds ? wide : narrow) = spacing;
  }
  // Rounded up, so that the hump stays below.
  const double spacing = rounded_down(wide + 1.0 / kPerPart, kPerPart);
  const ShaperSpec spec{
      ShaperKind::kMzv, {1.0, damping}, kDefaultTolerance, spacing > kMaxSpacing ? kMaxSpacing : spacing, nullptr};
  Prototype prototype;
  if (make_prototype(spec, prototype).ok()) add_shifted(candidate, spec, prototype, band, tolerance);
}

void make_free(uint32_t count, const ModeBand& band, double tolerance, Candidate& candidate) {
  const double damping = middle_damping(band);
  Prototype prototype;
  if (!make_free_cascade(count, band.high_hz / band.low_hz, damping, tolerance, prototype)) return;
  for (uint32_t i = 0; i < count; ++i) {
    add_spec(candidate, ShaperKind::kZv, band.low_hz * prototype.zeros[i].ratio, damping, kDefaultTolerance,
             kDefaultSpacing);
  }
}

void make(uint32_t index, const ModeBand& band, double tolerance, Candidate& candidate) {
  candidate = Candidate{};
  if (index < kNamed) {
    make_named(static_cast<ShaperKind>(index + 1), band, tolerance, candidate);
  } else if (index == kThreeFree) {
    make_three_free(band, tolerance, candidate);
  } else {
    make_free(index - kThreeFree + 1, band, tolerance, candidate);
  }
}

bool put_on_ticks(const ModeBand& band, double tick_s, Candidate& candidate) {
  ShaperDesign design{};
  for (uint32_t i = 0; i < candidate.spec_count; ++i) {
    if (!add_shaper(candidate.specs[i], tick_s, design).ok()) return false;
  }
  candidate.length_ticks = design.length_ticks();
  candidate.delay_ticks = design.delay_ticks();
  candidate.worst = worst_residual(design.cascade(), band, tick_s);
  return candidate.spec_count > 0;
}

}  // namespace

Candidate try_candidate(uint32_t index, const ModeBand& band, double tolerance, double tick_s) {
  Candidate best{};
  double aim = tolerance;
  for (int i = 0; i < kRecommendRounds; ++i) {
    Candidate candidate;
    make(index, band, aim, candidate);
    if (!put_on_ticks(band, tick_s, candidate)) break;
    candidate.keeps_band = candidate.worst.residual <= tolerance;
    if (best.spec_count == 0 || candidate.worst.residual < best.worst.residual) best = candidate;
    if (candidate.keeps_band || candidate.worst.residual > 1.5 * tolerance) break;
    constexpr double kLess = 1.0 - 2e-3;
    aim *= kLess * tolerance / candidate.worst.residual;
  }
  return best;
}

bool is_better(const Candidate& a, const Candidate& b) {
  if (a.keeps_band != b.keeps_band) return a.keeps_band;
  if (!a.keeps_band) {
    if ((a.spec_count > 0) != (b.spec_count > 0)) return a.spec_count > 0;
    return a.worst.residual < b.worst.residual;
  }
  if (a.length_ticks != b.length_ticks) return a.length_ticks < b.length_ticks;
  return a.delay_ticks < b.delay_ticks;
}

Status recommend(const ModeBand& band, double tolerance, double tick_s, Candidate& out) {
  Status status = check_positive(Quantity::kTick, tick_s);
  if (status.ok()) status = band.validate(tick_s);
  if (status.ok()) status = check_range(Quantity::kTolerance, tolerance, kMinTolerance, kMaxTolerance);
  if (!status.ok()) return status;
  Candidate best{};
  for (uint32_t i = 0; i < kRecommendCandidates; ++i) {
    const Candidate candidate = try_candidate(i, band, tolerance, tick_s);
    if (is_better(candidate, best)) best = candidate;
  }
  if (!best.keeps_band) return refuse(Error::kNotAvailable, Quantity::kTolerance, tolerance, best.worst.residual);
  out = best;
  return kOk;
}

}  // namespace stillpoint
