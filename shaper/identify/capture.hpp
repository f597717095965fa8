// SPDX-License-Identifier: Apache-2.0
// Samples of the tick, put aside for the background.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/status.hpp"
#include "shaper/identify/record.hpp"

namespace stillpoint {

// A sample as the tick wrote it, and once Capture::record has been asked for it, as a number.
union CaptureWord {
  int32_t raw;
  float number;
};

constexpr uint32_t kMaxChannels = 4;

struct CaptureConfig {
  uint32_t channels = 1;     // 1 to kMaxChannels
  uint32_t samples = 0;      // of each; 0: as many as the memory holds
  uint32_t pre_trigger = 0;  // of them from before the trigger; below `samples`
  uint32_t decimation = 1;   // ticks a sample
  bool mean = false;         // each sample the mean of its ticks, the decimation a power of two; otherwise the last one
  // What the sensor reads at its ends: a value there or beyond counts as saturated. lowest >= highest: it has none.
  int32_t lowest = 0;
  int32_t highest = 0;

  // Refuses, by name, what the comments above rule out, and what a memory of `words` does not hold.
  Status validate(size_t words) const;
};

enum class CaptureState : uint32_t { kIdle, kWaiting, kRunning, kFull };

// What was seen since `start`, in ticks.
struct CaptureFlaws {
  uint32_t gaps;       // without a fresh value; the one before was taken again
  uint32_t saturated;  // with a value at the sensor's end, in one channel at least
  uint32_t overruns;   // triggers that came while the record before was still running or had not been fetched
};

// A ring of samples that begins to fill with `start`, goes on with a trigger and ends full. One capture serves an
// identification (one channel, means) and a scope (several, as they are). Zero-initialised it does nothing.
//
// `start`, `stop`, `record` and `value` are the background's, `tick` the tick's; `trigger` may come from either.
class Capture {
 public:
  // Background. Gives up what was there. The memory stays the capture's until `stop`.
  Status start(const CaptureConfig& config, CaptureWord* memory, size_t words);
  void stop();

  CaptureState state() const;
  CaptureFlaws flaws() const;
  uint32_t samples() const;  // of each channel, once full; up to now while it runs

  // Background, once full: sample n of a channel, oldest first.
  int32_t value(uint32_t channel, uint32_t n) const;

  // Background, once full, of a capture of one channel: the record, oldest first, times `scale`, in place of the
  // samples; of one that was finished, what there is from the pre-trigger on. Empty when not full. After it `value`
  // says nothing more.
  Record record(double scale);

  // By hand, or by the tick that sees what to trigger on.
  void trigger();

  // Tick: one value a channel. `fresh` false: nothing new came, the values are not looked at. No division, no floating
  // point; cost a dozen instructions a channel.
  void tick(const int32_t* values, bool fresh);

  // Tick: no more is to come; what runs is full with what it has.
  void finish();

 private:
  void store_sample();
  size_t place(uint32_t n) const;

  // As in the config, all zeros so that a capture costs no flash.
  CaptureWord* memory_ = nullptr;
  uint32_t channels_ = 0;
  uint32_t samples_ = 0;
  uint32_t pre_trigger_ = 0;
  uint32_t decimation_ = 0;
  bool mean_ = false;
  uint32_t shift_ = 0;  // of a mean
  int32_t lowest_ = 0;
  int32_t highest_ = 0;

  // The tick's, but for `start`, which finds the state idle.
  uint32_t state_ = 0;  // CaptureState
  uint32_t triggered_ = 0;
  int64_t sum_[kMaxChannels] = {};
  int32_t last_[kMaxChannels] = {};
  uint32_t in_sample_ = 0;  // ticks
  uint32_t newest_ = 0;     // place of the next sample
  uint32_t filled_ = 0;     // samples that are there
  uint32_t wanted_ = 0;     // samples still to come after the trigger
  CaptureFlaws flaws_ = {};
};

}  // namespace stillpoint
