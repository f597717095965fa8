// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/bin.hpp"

#include "shaper/identify/quadrature.hpp"
#include "shaper/identify/step_fit.hpp"

namespace stillpoint {

namespace {

constexpr double kOne = 32768.0;  // of a quadrature pair

}  // namespace

void SteppedBins::start() {
  for (Step& step : step_) step = {};
  sums_ = {};
  in_block_ = 0;
  block_ = 0;
}

void SteppedBins::tick(const Excitation& excitation, int32_t value) {
  if (!excitation.held()) {
    block_ = 0;
    return;
  }
  const Quadrature pair = quadrature_of(excitation.phase());
  sums_.sine += int64_t{value} * pair.sine;
  sums_.cosine += int64_t{value} * pair.cosine;
  Step& step = step_[excitation.step()];
  step.all += value;
  if (++in_block_ < excitation.block_ticks()) return;
  step.block[block_++] = sums_;
  sums_ = {};
  in_block_ = 0;
}

// A tick, from the means of the neighbouring steps; the first and the last have one.
double SteppedBins::drift(const Excitation& excitation, uint32_t step) const {
  const uint32_t from = step == 0 ? 0 : step - 1;
  const uint32_t to = step + 1 < excitation.steps() ? step + 1 : step;
  double ticks = 0.0;
  for (uint32_t k = from; k <= to; ++k) ticks += (k == from || k == to ? 0.5 : 1.0) * excitation.step_ticks(k);
  const auto mean = [&](uint32_t k) {
    return static_cast<double>(step_[k].all) / (1.0 * kBlocks * excitation.block_ticks(k));
  };
  return (mean(to) - mean(from)) / ticks;
}

void SteppedBins::answers(const Excitation& excitation, double tick_s, const Identification& known, BinAnswer* answers,
                          const Meanwhile& meanwhile) const {
  for (uint32_t k = 0; k < excitation.steps(); ++k) {
    meanwhile();
    const double ticks = excitation.block_ticks(k);
    const double scale = 2.0 / (kOne * ticks * excitation.amplitude(k));
    const double half_angle = math::kPi * excitation.cycles_a_tick(k);
    // Of a ramp over whole periods.
    const double ramp = 0.5 * ticks * drift(excitation, k) * kOne * scale;
    const double in_phase = ramp * math::cos(half_angle) / math::sin(half_angle);
    BlockColumn values;
    for (uint32_t b = 0; b < kBlocks; ++b) {
      const BinSums& sums = step_[k].block[b];
      values.part[2 * b] = scale * static_cast<double>(sums.sine) + in_phase;
      values.part[2 * b + 1] = scale * static_cast<double>(sums.cosine) + ramp;
    }
    StepFit fit(values);
    for (size_t i = 0; i < known.mode_count; ++i) fit.take_off(known.mode[i], 2.0 * half_angle, tick_s, ticks);
    answers[k].frequency_hz = excitation.cycles_a_tick(k) / tick_s;
    fit.report(answers[k]);
  }
}

}  // namespace stillpoint
