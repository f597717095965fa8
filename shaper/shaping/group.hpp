// SPDX-License-Identifier: Apache-2.0
// Axes that move along one path. Each shaper delays its axis by its own time and bends a corner its own way, so axes
// that are shaped one by one leave the contour. Two ways out: one common shaper for all (Kim 2011), or pure delays.
//
//                    common_shaper                          equalise_delays
//   contour          kept exactly: all axes do the same     kept while all velocities are constant; worst_lag() says
//                                                           how far apart changes of velocity drive the axes
//   delay            the sum of the axes' delays            that of the slowest axis
//   modes            each axis is still at every mode       each axis is still at its own
//   cost a tick      every stage on every axis              own stages, and one of three taps
//
// Background context.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/status.hpp"
#include "shaper/shaping/design.hpp"
#include "shaper/shaping/shaper.hpp"

namespace stillpoint {

// The stages of all axes in one design, for every axis of the group (Kim 2011: the convolution of their shapers). A
// stage that several axes have bit for bit is taken once, since its zeros then serve all of them; one that an axis has
// several times (ZVD) stays as often as the axis with most of it has it. Refuses kTooManyStages, with the stages
// needed, when the result has no room; `out` is then unchanged. `out` may be one of `each`. No axis: passes through.
// Cost: count^2 stage comparisons.
Status common_shaper(const ShaperDesign* each, size_t count, ShaperDesign& out);

// Appends to every design but the slowest a stage that only delays: all centroids then agree, exactly, since a centroid
// is a whole number of 2^-30 ticks, as the gains are. So axes at constant velocity lag alike to the rounding of the
// signal. What is left: the responses still have different shapes, which shows while the velocity changes (in a steady
// acceleration as half the difference of their variances); and a delay of d + f ticks is split over d and d + 1,
// which adds f (1 - f) ticks^2 of variance. Calling it again adds nothing. Refuses kTooManyStages for an axis without
// room for a stage of three taps, and kAboveMaximum kDelay for a difference that outlasts kMaxStageTicks; every design
// is then unchanged.
Status equalise_delays(ShaperDesign* each, size_t count);

// What a design, or a group of one design an axis, costs.
struct ShaperCost {
  double delay_ticks;      // centroid; of a group: of its slowest axis
  uint32_t length_ticks;   // until the output stands; of a group: of its longest
  uint32_t line_signals;   // of delay line, 8 bytes each; of a group: of all axes together
  uint32_t taps_per_tick;  // multiplications; of a group: of all axes together
};
ShaperCost cost_of(const ShaperDesign& design);
ShaperCost cost_of(const ShaperDesign* each, size_t count);

// How far apart shapers drive two axes that are commanded alike, in ticks: times the tick and a velocity, a distance
// (0.8 ticks at 1 ms: 0.8 mm at 1 m/s). With s the step responses of the two:
struct ContourLag {
  double steady_ticks;  // at constant velocity: the difference of the centroids, |sum (s_1 - s_2)|
  double corner_ticks;  // at most, after velocity changed once (a sharp corner): the highest |partial sum of s_1 - s_2|
  double
      worst_ticks;  // at most, for any velocity between -1 and 1: sum |s_1 - s_2|, reached by switching with its sign
  uint32_t first_axis;  // the pair of worst_ticks
  uint32_t second_axis;
};

// Each of the above for the pair of axes in which it is largest. Runs the stages themselves, in `memory`, which has to
// hold the two shapers that need most; refuses kLineTooShort otherwise, `lag` is then unchanged. Cost: length_ticks
// ticks of two shapers a pair of axes.
// For ZV of 11 Hz, zeta 0.11, and of 17 Hz, zeta 0.05, at 1 ms, steady, corner and worst: 5.36, 5.36, 8.09 as they are;
// 0, 4.49, 8.97 with equal delays, which serve straights and hardly corners; 0 with the common shaper, for 13.6 ticks
// more of delay.
Status worst_lag(const ShaperDesign* each, size_t count, LineSample* memory, size_t capacity, ContourLag& lag);

}  // namespace stillpoint
