// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/shaper_spec.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

double next_above(double x) { return math::from_bits(math::bits_of(x) + 1); }  // x >= 0

}  // namespace

Status ImpulseTrain::validate() const {
  Status status = check_count(Quantity::kImpulses, count, 1, kMaxImpulses);
  if (!status.ok()) return status;
  constexpr double kSumTolerance = 1e-3;
  constexpr double kLargest = 1.9;
  constexpr double kLargestSize = 3.5;
  double sum = 0.0;
  double size = 0.0;
  for (uint32_t i = 0; i < count; ++i) {
    const Impulse& impulse = impulses[i];
    status = check_finite(Quantity::kImpulseTime, impulse.time);
    if (status.ok()) status = check_finite(Quantity::kImpulseAmplitude, impulse.amplitude);
    if (!status.ok()) return status;
    const double before = i > 0 ? impulses[i - 1].time : 0.0;
    if (i == 0 && impulse.time > 0.0) return refuse(Error::kAboveMaximum, Quantity::kImpulseTime, impulse.time, 0.0);
    if (i == 0 && impulse.time < 0.0) return refuse(Error::kBelowMinimum, Quantity::kImpulseTime, impulse.time, 0.0);
    if (i > 0 && impulse.time <= before)
      return refuse(Error::kBelowMinimum, Quantity::kImpulseTime, impulse.time, next_above(before));
    if (math::magnitude(impulse.amplitude) > kLargest)
      return refuse(Error::kAboveMaximum, Quantity::kImpulseAmplitude, impulse.amplitude, kLargest);
    sum += impulse.amplitude;
    size += math::magnitude(impulse.amplitude);
  }
  if (sum < 1.0 - kSumTolerance) return refuse(Error::kBelowMinimum, Quantity::kImpulseSum, sum, 1.0);
  if (sum > 1.0 + kSumTolerance) return refuse(Error::kAboveMaximum, Quantity::kImpulseSum, sum, 1.0);
  if (size > kLargestSize) return refuse(Error::kAboveMaximum, Quantity::kImpulseAmplitude, size, kLargestSize);
  return kOk;
}

ShaperSpec ShaperSpec::with_defaults() const {
  ShaperSpec spec = *this;
  if (spec.tolerance == 0.0) spec.tolerance = kDefaultTolerance;
  if (spec.spacing == 0.0) spec.spacing = kDefaultSpacing;
  return spec;
}

Status ShaperSpec::validate() const {
  if (static_cast<uint32_t>(kind) >= kShaperKinds)
    return refuse(Error::kAboveMaximum, Quantity::kKind, static_cast<double>(kind), kShaperKinds - 1);
  const ShaperSpec given = with_defaults();
  Status status = Mode{mode.frequency_hz, 0.0}.validate();
  if (status.ok()) status = check_range(Quantity::kDampingRatio, mode.damping_ratio, 0.0, kMaxDampingRatio);
  if (status.ok()) status = check_range(Quantity::kTolerance, given.tolerance, kMinTolerance, kMaxTolerance);
  if (status.ok()) status = check_range(Quantity::kSpacing, given.spacing, kMinSpacing, kMaxSpacing);
  if (!status.ok() || kind != ShaperKind::kCustom) return status;
  if (train == nullptr) return refuse(Error::kNotAvailable, Quantity::kImpulses, 0.0, 1.0);
  return train->validate();
}

uint32_t humps_of(ShaperKind kind) {
  switch (kind) {
    case ShaperKind::kEi:
    case ShaperKind::kCv1: return 1;
    case ShaperKind::kEi2:
    case ShaperKind::kCv2: return 2;
    case ShaperKind::kEi3:
    case ShaperKind::kCv3: return 3;
    case ShaperKind::kCv4: return 4;
    default: return 0;
  }
}

const char* text(ShaperKind kind) {
  constexpr const char* kNames[kShaperKinds] = {"none", "zv",  "zvd", "zvdd", "zvddd", "mzv",   "ei",    "ei2",
                                                "ei3",  "cv1", "cv2", "cv3",  "cv4",   "um-zv", "custom"};
  return static_cast<uint32_t>(kind) < kShaperKinds ? kNames[static_cast<uint32_t>(kind)] : "unknown";
}

}  // namespace stillpoint
