// SPDX-License-Identifier: Apache-2.0
// Motion that makes an arm ring, or shows how it answers a frequency. Prepared by the background, which knows all of it
// before anything moves; run by the tick in integers.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/base/meanwhile.hpp"
#include "shaper/base/shared.hpp"
#include "shaper/base/signal.hpp"
#include "shaper/base/status.hpp"

namespace stillpoint {

// kBump: out and back once, as short as the limits and the band allow, so that its spectrum reaches over the band.
// kSteppedSine: one frequency after the other, logarithmically apart, each with whole periods, faded in and out.
// kChirp: through the band once, the frequency rising.
// Every one begins and ends standing where it began, its difference 0.
enum class ExcitationKind : uint8_t { kBump, kSteppedSine, kChirp };

struct ExcitationConfig {
  ExcitationKind kind;
  double tick_s;
  double amplitude;  // counts, how far from where it begins at most; above 0, at most `travel` and 2^28
  double travel;     // counts: the room there is, either way
  double velocity;   // counts/s, acceleration counts/s^2 and jerk counts/s^3: what it keeps below
  double acceleration;
  double jerk;
  double low_hz;  // the band, low < high < 0.45 / tick
  double high_hz;
  uint32_t steps;  // of a stepped sine, 2 to kMostExcitationSteps

  Status validate() const;
};

constexpr uint32_t kMostExcitationSteps = 64;

// What will happen, before it does. Peaks of what the tick will emit, sampled: not exceeded, and reached but for 2^-26
// counts in each difference of a tick. A chirp's travel is its amplitude, which its samples may miss by 1e-4 of it.
struct Announcement {
  double travel;        // counts, the furthest from where it begins, either way
  double velocity;      // counts/s
  double acceleration;  // counts/s^2
  double jerk;          // counts/s^3
  double duration_s;
};

// `prepare` and `start` are the background's, `tick` the tick's, `over` anyone's. Zero-initialised it emits nothing.
// Each step: fade in over a block of whole periods (the envelope is sin^4), held, fade out, three ticks at 0. The chirp
// is linear in frequency, of one amplitude throughout; the bump is sin^4 and lasts 2.5 / high, short of its first
// notch.
class Excitation {
 public:
  // Refuses, by name, a config that does not validate; while running (kBusy); limits that leave less than a count; a
  // band so low that it would last over 2^30 ticks. Cost: the generator over all ticks of a bump; over two blocks of
  // each step of a sine, or 72 ticks where a block is of two periods and 128 ticks or more; over two of such a chirp's
  // twelve; and another Excitation of stack. `meanwhile` is called every 256 ticks.
  Status prepare(const ExcitationConfig& config, Announcement& announcement, const Meanwhile& meanwhile = {});

  // While the tick does not run it. From the beginning, again as often as wanted.
  void start();

  // How far from where it began, this tick. Integers only, the same bits on all machines.
  Signal tick();
  bool over() const { return load(running_) == 0; }

  static constexpr uint32_t kSteppedBlocks = 6;  // held, each of whole periods

  // For what listens in the tick: of the tick that comes next.
  uint32_t step() const { return at_; }
  bool held() const { return !over() && in_step_ - step_[at_].block < held_blocks_ * step_[at_].block; }
  uint32_t block_ticks() const { return step_[at_].block; }
  uint32_t phase() const { return static_cast<uint32_t>(phase_ >> 32); }  // 2^-32 turns

  // Background.
  uint32_t steps() const { return steps_; }
  uint32_t ticks() const { return ticks_; }
  uint32_t block_ticks(uint32_t step) const { return step_[step].block; }
  uint32_t step_ticks(uint32_t step) const;
  double cycles_a_tick(uint32_t step) const;  // a stepped sine's
  double amplitude(uint32_t step) const;      // counts

 private:
  static constexpr uint32_t kChirpBlocks = 10;  // of two periods of the lowest frequency

  struct Step {
    uint64_t increment;  // of the phase, 2^-64 turns a tick
    Signal amplitude;
    uint32_t block;       // ticks of a fade
    uint32_t fade_shift;  // the envelope's phase goes so many bits slower
  };
  struct Peaks {
    Signal difference[4];  // the value itself, the first, the second, the third
  };

  bool lay_out(const ExcitationConfig& config);
  void seek(uint32_t n);
  void measure(uint32_t from, uint32_t to, const Meanwhile& meanwhile, Peaks& peaks);
  Peaks peaks_of_step(const Meanwhile& meanwhile);
  Peaks most_before(uint32_t tick) const;
  void begin_step();

  Step step_[kMostExcitationSteps];
  uint64_t phase_;
  uint64_t fade_phase_;
  uint64_t increment_;
  uint64_t slope_;
  uint32_t held_blocks_;
  uint32_t in_step_;
  uint32_t at_;
  uint32_t steps_;
  uint32_t ticks_;
  uint32_t running_;
  ExcitationKind kind_;
};

// What a frequency was answered with: the sensor's samples over the setpoint, as the sum of one bin each.
struct BinAnswer {
  double frequency_hz;
  double re;  // sensor's unit a count: the transfer from setpoint to sensor
  double im;
  double spread;  // standard deviation of either part
};

}  // namespace stillpoint
