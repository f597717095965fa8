// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/design.hpp"

#include "shaper/base/math.hpp"
#include "shaper/shaping/grid_fit.hpp"
#include "shaper/shaping/nearest_train.hpp"
#include "shaper/shaping/prototype.hpp"
#include "shaper/shaping/quantise.hpp"
#include "shaper/shaping/zv.hpp"

namespace stillpoint {

namespace {

// What a stage's sums can take is 4; the rest is for rounding.
constexpr double kLargestGain = 1.999;
constexpr double kLargestGainSum = 3.9;

bool within_gains(const Cascade& taps) {
  for (uint32_t i = 0; i < taps.part_count; ++i) {
    double sum = 0.0;
    for (uint32_t k = taps.parts[i].first; k < taps.parts[i].first + taps.parts[i].count; ++k) {
      const double size = math::magnitude(taps.impulses[k].amplitude);
      if (!(size < kLargestGain)) return false;
      sum += size;
    }
    if (!(sum < kLargestGainSum)) return false;
  }
  return true;
}

double highest_ratio(const Prototype& prototype) { return prototype.zeros[prototype.zero_count - 1].ratio; }

// The longest part of a prototype, in periods of the mode.
[[gnu::noinline]] double longest_part(const Prototype& prototype) {
  double longest = 0.0;
  for (uint32_t i = 0; i < prototype.train.part_count; ++i) {
    const Cascade::Part& part = prototype.train.parts[i];
    const double length = prototype.train.impulses[part.first + part.count - 1].time;
    if (length > longest) longest = length;
  }
  return longest;
}

Status check_frequency(const Prototype& prototype, const ShaperSpec& spec, double tick_s) {
  const double frequency_hz = spec.mode.frequency_hz;
  constexpr double kSlack = 1e-11;  // so that what is named is accepted, in twelve digits too
  const double highest = kHighestCyclesATick / (tick_s * highest_ratio(prototype));
  if (frequency_hz > highest * (1.0 + kSlack))
    return refuse(Error::kAboveMaximum, Quantity::kFrequency, frequency_hz, highest);
  const double lowest = longest_part(prototype) / (tick_s * (kMaxStageTicks - 3.0));
  if (frequency_hz >= lowest * (1.0 - kSlack)) return kOk;
  // The times of a custom train are the caller's, whatever the mode.
  if (spec.kind == ShaperKind::kCustom)
    return refuse(Error::kAboveMaximum, Quantity::kImpulseTime, longest_part(prototype) / frequency_hz,
                  tick_s * (kMaxStageTicks - 3.0));
  return refuse(Error::kBelowMinimum, Quantity::kFrequency, frequency_hz, lowest);
}

// On the ticks, without looking at the band yet.
Placed put_on_ticks(const Prototype& prototype, double damping_ratio, double cycles_a_tick, GridShaper& shaper) {
  if (prototype.is_cascade || prototype.is_banded) {
    if (!place(prototype, cycles_a_tick, shaper)) return Placed::kCannot;
  } else {
    shaper = GridShaper{};
    const Placed placed = nearest_train(prototype.train, damping_ratio, cycles_a_tick, shaper.taps);
    if (placed != Placed::kYes) return placed;
  }
  return within_gains(shaper.taps) ? Placed::kYes : Placed::kCannot;
}

// The highest frequency below one that the ticks cannot hold, to a part in a thousand.
double highest_on_ticks(const Prototype& prototype, double damping_ratio, double cycles_a_tick) {
  double works = 0.0;
  double fails = cycles_a_tick;
  GridShaper unused;
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (works + fails);
    (put_on_ticks(prototype, damping_ratio, middle, unused) == Placed::kYes ? works : fails) = middle;
  }
  return works;
}

Status check_room(const GridShaper& shaper, const ShaperDesign& design) {
  const uint32_t stages = design.stage_count + shaper.taps.part_count;
  const uint32_t taps = design.tap_count + shaper.taps.impulse_count;
  if (stages > ShaperDesign::kMaxStages)
    return refuse(Error::kTooManyStages, Quantity::kStages, stages, ShaperDesign::kMaxStages);
  if (taps > ShaperDesign::kMaxTaps)
    return refuse(Error::kTooManyStages, Quantity::kTaps, taps, ShaperDesign::kMaxTaps);
  return kOk;
}

Status realise(const ShaperSpec& spec, double tick_s, GridShaper& shaper, PlacementReport& report,
               const Meanwhile& meanwhile) {
  Prototype prototype;
  Status status = make_prototype(spec, prototype, meanwhile);
  if (status.ok()) status = check_frequency(prototype, spec, tick_s);
  if (!status.ok()) return status;
  const double zeta = spec.mode.damping_ratio;
  const double cycles = spec.mode.frequency_hz * tick_s;
  const Placed on_ticks = put_on_ticks(prototype, zeta, cycles, shaper);
  if (on_ticks == Placed::kTooManyTaps)
    return refuse(Error::kTooManyStages, Quantity::kTaps, 2.0 * prototype.train.impulse_count - 1.0, kMaxTaps);
  if (on_ticks == Placed::kCannot) {
    if (spec.kind == ShaperKind::kCustom)
      return refuse(Error::kNotAvailable, Quantity::kImpulseTime, longest_part(prototype) / spec.mode.frequency_hz);
    const double highest = highest_on_ticks(prototype, zeta, cycles) / tick_s;
    return refuse(Error::kAboveMaximum, Quantity::kFrequency, spec.mode.frequency_hz, highest);
  }
  if (prototype.zero_count > 1) {
    const GridShaper placed = shaper;
    const BandTargets targets = band_targets(prototype, zeta, spec.tolerance, cycles, meanwhile);
    meanwhile();
    report.band_miss = fit_band(targets, zeta, cycles, shaper, meanwhile);
    if (!within_gains(shaper.taps)) {
      shaper = placed;
      report.band_miss = band_miss(targets, zeta, cycles, shaper);
    }
  }
  report.has_negative_tap = shaper.taps.has_negative() && !prototype.train.has_negative();
  return kOk;
}

}  // namespace

uint32_t ShaperDesign::length_ticks() const { return line_length() - stage_count; }

uint32_t ShaperDesign::line_length() const {
  uint32_t length = 0;
  for (uint32_t i = 0; i < stage_count; ++i) {
    length += taps[stages[i].first_tap + stages[i].tap_count - 1].delay_ticks + 1;
  }
  return length;
}

double ShaperDesign::delay_ticks() const {
  double sum = 0.0;
  for (uint32_t i = 0; i < tap_count; ++i) sum += static_cast<double>(taps[i].gain) * taps[i].delay_ticks;
  return sum / kUnityGain;
}

double ShaperDesign::peak_gain() const {
  double product = 1.0;
  for (uint32_t i = 0; i < stage_count; ++i) {
    double sum = 0.0;
    for (uint32_t k = 0; k < stages[i].tap_count; ++k) {
      sum += math::magnitude(static_cast<double>(taps[stages[i].first_tap + k].gain));
    }
    product *= sum / kUnityGain;
  }
  return product;
}

Cascade ShaperDesign::cascade() const {
  Cascade out{};
  for (uint32_t i = 0; i < stage_count; ++i) {
    out.parts[out.part_count++] = Cascade::Part{stages[i].first_tap, stages[i].tap_count};
  }
  for (uint32_t i = 0; i < tap_count; ++i) {
    out.impulses[out.impulse_count++] =
        Impulse{static_cast<double>(taps[i].delay_ticks), static_cast<double>(taps[i].gain) / kUnityGain};
  }
  return out;
}

Status add_shaper(const ShaperSpec& spec, double tick_s, ShaperDesign& design, PlacementReport* report,
                  const Meanwhile& meanwhile) {
  PlacementReport placed{0.0, false};
  if (spec.kind == ShaperKind::kNone) {
    if (report != nullptr) *report = placed;
    return kOk;
  }
  Status status = spec.validate();
  if (status.ok()) status = check_positive(Quantity::kTick, tick_s);
  if (!status.ok()) return status;
  GridShaper shaper;
  status = realise(spec.with_defaults(), tick_s, shaper, placed, meanwhile);
  if (status.ok()) status = check_room(shaper, design);
  if (!status.ok()) return status;
  append_quantised(shaper.taps, design);
  if (report != nullptr) *report = placed;
  return kOk;
}

Status add_shaper(ShaperKind kind, const Mode& mode, double tick_s, ShaperDesign& design) {
  return add_shaper(ShaperSpec{kind, mode, 0.0, 0.0, nullptr}, tick_s, design);
}

double lowest_frequency_hz(const ShaperSpec& spec, double tick_s, size_t line_length) {
  if (spec.kind == ShaperKind::kNone) return 0.0;
  ShaperSpec any = spec.with_defaults();
  any.mode.frequency_hz = 1.0;  // a prototype does not depend on it
  Prototype prototype;
  if (!any.validate().ok() || any.kind == ShaperKind::kCustom || !make_prototype(any, prototype).ok()) return 0.0;
  const double room = static_cast<double>(line_length);
  const double highest = kHighestCyclesATick / (tick_s * highest_ratio(prototype));
  const uint32_t stages = prototype.train.part_count;
  if (prototype.is_cascade && !prototype.is_banded) {
    // A stage takes k + 2 signals, and k is at most c as long as half a damped period is below c + 1 ticks.
    const double longest = math::floor(room / stages) - 2.0;
    if (longest < 1.0) return highest;
    return (1.0 + 1e-9) / (2.0 * tick_s * (longest + 1.0) * damped_ratio(spec.mode.damping_ratio));
  }
  // A stage of length t takes at most floor(t) + 2 signals.
  const double ticks = room - 2.0 * stages;
  return ticks < 1.0 ? highest : prototype.train.length() / (ticks * tick_s);
}

}  // namespace stillpoint
