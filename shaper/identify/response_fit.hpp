// SPDX-License-Identifier: Apache-2.0
// From an arm's answers to single frequencies to its modes. Shows the well damped ones, which hardly ring. Background.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/complex.hpp"
#include "shaper/base/linear.hpp"
#include "shaper/base/meanwhile.hpp"
#include "shaper/base/status.hpp"
#include "shaper/identify/excitation.hpp"
#include "shaper/identify/identification.hpp"

namespace stillpoint {

constexpr size_t kMostResponseModes = 3;
constexpr size_t kLeastAnswers = 9;  // and 4 more for each further mode: 2 numbers each, 7 + 4 a mode unknown

struct ResponseConfig {
  uint32_t power;     // of jw that the sensor puts before it all: 2 an accelerometer, 0 a position or following error
  double delay_s;     // from setpoint to sensor, as far as it is known: the fit begins there and finds it by itself
  size_t most_modes;  // 1 to kMostResponseModes

  Status validate() const;
};

// Memory of a fit (2.1 KB).
struct ResponseScratch {
  static constexpr size_t kColumns = 3 + 3 * kMostResponseModes + 2;
  static constexpr size_t kParameters = 2 * kMostResponseModes + 1;
  Complex triangle[kColumns * (kColumns + 1) / 2];  // one column after the other
  LinearSystem<kParameters> normal;
};

// Modes in `answers`, whose frequencies rise. `result` as of identify(), but: `amplitude` is what the mode alone would
// ring with after a step of one count, in the sensor's unit; `noise` is what the model leaves, over what the spreads
// say. A spread is taken for a thousandth of its answer at least. kNoMode for a rigid arm or noise, kNoisy where
// something resonates and its frequency cannot be told to 5 % or its damping to half of it, kTooShort below
// kLeastAnswers. Refuses what is not finite, frequencies that do not rise (kFrequency) and spreads below 0 (kSamples);
// `result` then stays.
//
// Model: (jw)^power e^(-jw delay) (c0 + c1 w^2 + c2 w^4 + sum of ck / (1 - x^2 + 2j zeta x)), x = w / wk, every c
// complex. A smooth factor common to all, as of interpolating the setpoint, changes the c and hardly anything else: w^2
// times a mode is a constant plus the mode. Where what is left is beyond the spreads by three, all modes together must
// take away ten times what they leave, else kNoMode or kNoisy.
// Method: variable projection (Golub and Pereyra 1973, Kaufman 1975) with Levenberg-Marquardt in log f, log zeta and
// the delay; a mode is added while chi^2 says so and the bins can resolve it.
// Cost: 6 linear fits an answer and mode in search of it, then at most 40 of the whole; each takes 2 columns^2 complex
// multiplications an answer. `meanwhile` is called once a fit. Stack 2.2 KB.
Status identify_response(const BinAnswer* answers, size_t count, const ResponseConfig& config, ResponseScratch& scratch,
                         Identification& result, const Meanwhile& meanwhile = {});

}  // namespace stillpoint
