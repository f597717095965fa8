// SPDX-License-Identifier: Apache-2.0
// From the blocks of a step of a stepped sine to what stays. Background.
#pragma once

#include "shaper/base/complex.hpp"
#include "shaper/identify/excitation.hpp"
#include "shaper/identify/identification.hpp"

namespace stillpoint {

// One complex number a block, re and im in turn.
struct BlockColumn {
  static constexpr uint32_t kParts = 2 * Excitation::kSteppedBlocks;
  double part[kParts];

  double times(const BlockColumn& other) const;  // the scalar product
  void take_off(const BlockColumn& other, double power);
};

// The amplitudes of a step's blocks, in phase (re) and in quadrature (im), are one complex number that stays and what
// the arm rings with by itself since the fade: that is multiplied from block to block by exp(s T), s the mode's pole, T
// the block's time, for the periods of what drives it are whole. Least squares in real factors; what decays is taken
// off the blocks and off the constant.
class StepFit {
 public:
  explicit StepFit(const BlockColumn& values);

  // What a mode rings with; `turn`: radians a tick of what drives it, `ticks` a block. Where much of it lasts from
  // block to block, what an error of its pole would make of it comes off too, while blocks are left to tell.
  void take_off(const IdentifiedMode& mode, double turn, double tick_s, double ticks);

  // What stays, and its deviation in either part by the scatter that is left.
  void report(BinAnswer& answer) const;

 private:
  static constexpr uint32_t kBlocks = Excitation::kSteppedBlocks;
  static constexpr uint32_t kMostColumns = 2 * kBlocks - 4;

  void take_off_decay(const Complex& factor, Complex own, Complex mirror, bool slope);

  BlockColumn rest_;
  BlockColumn constant_[2];
  BlockColumn decay_[kMostColumns] = {};
  double power_[kMostColumns] = {};
  uint32_t decays_ = 0;
  uint32_t freedom_ = 2 * kBlocks - 2;
};

}  // namespace stillpoint
