// SPDX-License-Identifier: Apache-2.0
// What shaper is asked for.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/status.hpp"
#include "shaper/shaping/mode.hpp"
#include "shaper/shaping/response.hpp"

namespace stillpoint {

// The numbers are the drive's register values: never renumbered.
enum class ShaperKind : uint8_t {
  kNone = 0,
  kZv = 1,
  kZvd = 2,
  kZvdd = 3,
  kZvddd = 4,
  kMzv = 5,  // three impulses, `spacing` apart
  kEi = 6,   // extra-insensitive: one, two, three humps of the tolerance
  kEi2 = 7,
  kEi3 = 8,
  kCv1 = 9,  // Park 2001: ZV shapers beside the mode, convolved; one to four humps
  kCv2 = 10,
  kCv3 = 11,
  kCv4 = 12,
  kUmZv = 13,   // impulses of +1, -1, +1
  kCustom = 14  // the caller's own train
};
constexpr uint32_t kShaperKinds = 15;

// The caller's own impulses, times in seconds from 0 on, rising; amplitudes sum to one.
struct ImpulseTrain {
  static constexpr uint32_t kMaxImpulses = 63;  // on whole ticks; 31 where each has to be split over two
  uint32_t count;
  Impulse impulses[kMaxImpulses];

  // Refuses, naming impulse times or amplitudes: fewer than one or more than kMaxImpulses, anything not finite, a first
  // time that is not 0, times that do not rise, an amplitude beyond 1.9 either way, amplitudes whose sum is not one to
  // 1e-3 or whose magnitudes sum to more than 3.5 (what a stage can take, and a little for the ticks).
  Status validate() const;
};

constexpr double kDefaultTolerance = 0.05;
constexpr double kMinTolerance = 0.001;
constexpr double kMaxTolerance = 0.2;
constexpr double kDefaultSpacing = 0.375;  // MZV as it is usually meant
constexpr double kMinSpacing = 0.25;       // there it is ZV
constexpr double kMaxSpacing = 0.5;        // there it is ZVD
constexpr double kMaxDampingRatio = 0.3;

struct ShaperSpec {
  ShaperKind kind;
  Mode mode;
  double tolerance;           // EI, CV: height of the humps, a residual ratio; 0: kDefaultTolerance
  double spacing;             // MZV: of its impulses, in damped periods; 0: kDefaultSpacing
  const ImpulseTrain* train;  // custom

  // Refuses by name what add_shaper says it does; the tick is not looked at.
  Status validate() const;
  ShaperSpec with_defaults() const;
};

// Humps of the family: 0 for those without.
uint32_t humps_of(ShaperKind kind);

// "zv", "ei2", "um-zv": as in a specification.
const char* text(ShaperKind kind);

}  // namespace stillpoint
