// SPDX-License-Identifier: Apache-2.0
// Where another mode may be: the spectrum of what a model leaves. Background.
#pragma once

#include "shaper/base/meanwhile.hpp"
#include "shaper/identify/decay_model.hpp"
#include "shaper/identify/fft.hpp"

namespace stillpoint {

// Power per sample of what lies under the peaks of a spectrum: the median of bands that grow with frequency, so that
// coloured noise has its colour and half of a band may be peaks.
struct NoiseFloor {
  static constexpr size_t kMostBands = 24;

  size_t bands;
  double centre[kMostBands];  // logarithm of the bin
  double level[kMostBands];   // logarithm of the power a sample

  double least;  // nothing below it is told from rounding

  // From `power`, size / 2 + 1 powers of what is left of the record. Cost: 40 comparisons a bin.
  void take(const double* power, size_t size, const Record& record);
  double at(size_t bin) const;
};

struct ModeCandidate {
  double decay;
  double angle;
  double score;  // power over the floor: of white noise, one that is above x has a chance of exp(-x) a bin
};

// A candidate that noise is not: one bin of 8,000 of white noise has this score.
constexpr double kWorthTrying = 9.0;

struct Candidates {
  ModeCandidate largest;   // holds most of what is left, whatever its score
  ModeCandidate standing;  // holds most of it among those with a score of kWorthTrying; the best score where none has
};

// Angles that have been tried and refused.
struct Refused {
  static constexpr size_t kMost = 4;

  size_t count;
  double angle[kMost];

  void add(double tried) {
    if (count < kMost) angle[count++] = tried;
  }
};

// Damped sinusoids in what `model` leaves of the record, further than half of a mode's width from those it has and than
// a bin from those refused. The largest and the one that stands out differ where the noise is coloured, and where the
// skirts of modes that are not in the model yet pass for noise. Method: the likelihood of one damped sinusoid in noise,
// over a grid of decays, is the spectrum of the record under that decay as its window. `buffer`: a power of two of
// doubles, no less than the record. Cost: nine transforms, with a call of `meanwhile` after each.
Candidates find_candidates(const Record& record, const DecayModel& model, const Refused& refused, double* buffer,
                           size_t size, const Meanwhile& meanwhile);

// What `model` leaves of the record, times exp(-decay x), as a power spectrum in buffer[0 .. size / 2]; `weight` is the
// sum of the window's squares. False unless is_fft_size(size).
[[nodiscard]] bool power_of_residual(const Record& record, const DecayModel& model, double decay, double* buffer,
                                     size_t size, double& weight);

// The same without a window.
void residual_spectrum(const Record& record, const DecayModel& model, double* buffer, size_t size);

}  // namespace stillpoint
