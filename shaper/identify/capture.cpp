// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/capture.hpp"

#include "shaper/base/shared.hpp"

namespace stillpoint {

namespace {

constexpr uint32_t kMaxDecimation = UINT32_C(1) << 16;

constexpr uint32_t as_word(CaptureState state) { return static_cast<uint32_t>(state); }

int32_t mean_of(int64_t sum, uint32_t shift) {
  return static_cast<int32_t>((sum + ((INT64_C(1) << shift) >> 1)) >> shift);
}

void reverse(CaptureWord* words, size_t first, size_t end) {
  while (first + 1 < end) {
    const CaptureWord word = words[first];
    words[first++] = words[--end];
    words[end] = word;
  }
}

}  // namespace

Status CaptureConfig::validate(size_t words) const {
  Status status = check_count(Quantity::kChannels, channels, 1, kMaxChannels);
  if (!status.ok()) return status;
  const auto most = static_cast<uint32_t>(words / channels);
  status = check_count(Quantity::kSamples, samples == 0 ? most : samples, 1, most);
  if (status.ok()) status = check_count(Quantity::kPreTrigger, pre_trigger, 0, (samples == 0 ? most : samples) - 1);
  if (status.ok()) status = check_count(Quantity::kDecimation, decimation, 1, kMaxDecimation);
  if (!status.ok()) return status;
  if (!mean || (decimation & (decimation - 1)) == 0) return kOk;
  uint32_t below = 1;
  while (2 * below < decimation) below *= 2;
  return refuse(Error::kNotAvailable, Quantity::kDecimation, decimation, below);
}

Status Capture::start(const CaptureConfig& config, CaptureWord* memory, size_t words) {
  const Status status = config.validate(words);
  if (!status.ok()) return status;
  stop();
  channels_ = config.channels;
  samples_ = config.samples == 0 ? static_cast<uint32_t>(words / config.channels) : config.samples;
  pre_trigger_ = config.pre_trigger;
  decimation_ = config.decimation;
  mean_ = config.mean;
  lowest_ = config.lowest;
  highest_ = config.highest;
  memory_ = memory;
  shift_ = 0;
  while (mean_ && (UINT32_C(1) << shift_) < decimation_) ++shift_;
  for (uint32_t k = 0; k < kMaxChannels; ++k) {
    sum_[k] = 0;
    last_[k] = 0;
  }
  in_sample_ = 0;
  newest_ = 0;
  filled_ = 0;
  wanted_ = samples_ - pre_trigger_;
  flaws_ = {};
  store(triggered_, 0);
  store(state_, as_word(CaptureState::kWaiting));
  return status;
}

void Capture::stop() { store(state_, as_word(CaptureState::kIdle)); }

CaptureState Capture::state() const { return static_cast<CaptureState>(load(state_)); }

CaptureFlaws Capture::flaws() const { return {load(flaws_.gaps), load(flaws_.saturated), load(flaws_.overruns)}; }

uint32_t Capture::samples() const { return load(filled_); }

size_t Capture::place(uint32_t n) const {
  const uint32_t oldest = filled_ < samples_ ? 0 : newest_;
  const uint32_t at = oldest + n;
  return size_t{at < samples_ ? at : at - samples_} * channels_;
}

int32_t Capture::value(uint32_t channel, uint32_t n) const { return memory_[place(n) + channel].raw; }

Record Capture::record(double scale) {
  if (state() != CaptureState::kFull || channels_ != 1) return {nullptr, 0};
  const size_t count = filled_;
  // Turned round in place, so that the oldest comes first.
  if (filled_ == samples_) {
    reverse(memory_, 0, newest_);
    reverse(memory_, newest_, count);
    reverse(memory_, 0, count);
    newest_ = 0;
  }
  for (size_t n = 0; n < count; ++n)
    memory_[n].number = static_cast<float>(static_cast<double>(memory_[n].raw) * scale);
  // One that was finished holds as many older than the pre-trigger as are still wanted.
  const size_t asked = samples_ - wanted_;
  const size_t first = count > asked ? count - asked : 0;
  return {&memory_[first].number, count - first};
}

void Capture::trigger() {
  const CaptureState now = state();
  if (now == CaptureState::kRunning || now == CaptureState::kFull) {
    store(flaws_.overruns, flaws_.overruns + 1);
  } else if (now == CaptureState::kWaiting) {
    store(triggered_, 1);
  }
}

void Capture::finish() {
  if (load(state_) == as_word(CaptureState::kRunning)) store(state_, as_word(CaptureState::kFull));
}

void Capture::tick(const int32_t* values, bool fresh) {
  uint32_t now = load(state_);
  if (now != as_word(CaptureState::kWaiting) && now != as_word(CaptureState::kRunning)) return;
  if (now == as_word(CaptureState::kWaiting) && load(triggered_) != 0) {
    now = as_word(CaptureState::kRunning);
    store(state_, now);
    // The sample that the trigger falls into is the first after it.
    if (pre_trigger_ == 0) {
      in_sample_ = 0;
      for (int64_t& sum : sum_) sum = 0;
    }
  }
  if (!fresh) store(flaws_.gaps, flaws_.gaps + 1);
  bool at_end = false;
  for (uint32_t k = 0; k < channels_; ++k) {
    if (fresh) last_[k] = values[k];
    at_end = at_end || last_[k] <= lowest_ || last_[k] >= highest_;
    sum_[k] += last_[k];
  }
  if (fresh && at_end && lowest_ < highest_) store(flaws_.saturated, flaws_.saturated + 1);
  if (++in_sample_ == decimation_) store_sample();
}

void Capture::store_sample() {
  in_sample_ = 0;
  const bool running = load(state_) == as_word(CaptureState::kRunning);
  if (!running && pre_trigger_ == 0) {
    for (int64_t& sum : sum_) sum = 0;
    return;
  }
  CaptureWord* const to = memory_ + size_t{newest_} * channels_;
  for (uint32_t k = 0; k < channels_; ++k) {
    to[k].raw = mean_ ? mean_of(sum_[k], shift_) : last_[k];
    sum_[k] = 0;
  }
  newest_ = newest_ + 1 < samples_ ? newest_ + 1 : 0;
  if (filled_ < samples_) store(filled_, filled_ + 1);
  if (running && --wanted_ == 0) store(state_, as_word(CaptureState::kFull));
}

}  // namespace stillpoint
