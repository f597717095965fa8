// SPDX-License-Identifier: Apache-2.0
// Single-bin detection: what a sensor answers to one frequency, summed in the tick; no record is needed.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/meanwhile.hpp"
#include "shaper/identify/excitation.hpp"
#include "shaper/identify/identification.hpp"

namespace stillpoint {

constexpr uint32_t kMostBins = 32;

// Sums of samples times a quadrature pair of 2^15. Samples of 32 bits over 2^17 ticks fit.
struct BinSums {
  int64_t sine;
  int64_t cosine;
};

// A stepped sine's, of at most kMostBins steps: the frequency of each step over each block that is held. `tick` is the
// tick's, all else the background's: `start` before it, `answers` once the sine is over.
class SteppedBins {
 public:
  void start();

  // Before the excitation's own tick. Cost: at most 210 instructions on a Cortex-M4.
  void tick(const Excitation& excitation, int32_t value);

  // Answers of all steps, without what the arm rings with since the fade, as far as its modes are `known`. A drift of
  // the sensor that is linear over three steps comes off. `tick_s`: of the excitation.
  void answers(const Excitation& excitation, double tick_s, const Identification& known, BinAnswer* answers,
               const Meanwhile& meanwhile = {}) const;

 private:
  static constexpr uint32_t kBlocks = Excitation::kSteppedBlocks;

  struct Step {
    BinSums block[kBlocks];
    int64_t all;  // the samples themselves
  };

  double drift(const Excitation& excitation, uint32_t step) const;

  Step step_[kMostBins];
  BinSums sums_;
  uint32_t in_block_;
  uint32_t block_;
};

}  // namespace stillpoint
