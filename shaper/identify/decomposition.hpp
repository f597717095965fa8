// SPDX-License-Identifier: Apache-2.0
// A record as a sum of as many damped sinusoids as it has. Background.
#pragma once

#include "shaper/base/meanwhile.hpp"
#include "shaper/identify/candidate.hpp"
#include "shaper/identify/decay_fit.hpp"

namespace stillpoint {

// Memory of an identification: for records of up to kSamples samples, a power of two. 8 kSamples + 5.3 KB.
template <size_t kSamples>
struct IdentifyMemory {
  static_assert(is_fft_size(kSamples), "a power of two up to kLargestFft");
  DecayFit fit;
  double buffer[kSamples];
};

// The same, whatever its size.
struct IdentifyScratch {
  template <size_t kSamples>
  explicit IdentifyScratch(IdentifyMemory<kSamples>& memory) : fit(memory.fit), buffer(memory.buffer), size(kSamples) {}
  // `memory_size`: a power of two of doubles.
  IdentifyScratch(DecayFit& memory_fit, double* memory, size_t memory_size)
      : fit(memory_fit), buffer(memory), size(memory_size) {}

  DecayFit& fit;
  double* buffer;
  size_t size;
};

// How sure a component is, in the model's units.
struct ComponentDoubt {
  double decay;        // variance
  double angle;        // variance
  double decay_angle;  // covariance
  double evidence;     // chi^2 with two degrees
  double noise;        // variance a sample that white noise of the density about the component would have
  double structure;    // energy beyond the noise that the fit left under the component's peak, over its own energy
};

struct Decomposition {
  DecayModel model;
  ComponentDoubt doubt[kMostComponents];
  double variance;    // of the residual
  double best_score;  // of the last candidate that was not taken, see ModeCandidate
};

// Of chi^2 with two degrees; the maximum over frequencies and decays of white noise passes it in one record of 10,000.
constexpr double kLeastEvidence = 40.0;

// Components are added while the residual's spectrum has a peak that noise does not, and every one of them stands out
// from the noise between the peaks and can be told from the others. Method: CLEAN with a joint fit each time.
// The noise that doubts are reckoned with is what is left around the component, not the mean over all frequencies: for
// a narrow component, least squares in coloured noise errs as in white noise of that density.
// Given up, it means nothing.
Decomposition decompose(const Record& record, IdentifyScratch& scratch, const Meanwhile& meanwhile);

}  // namespace stillpoint
