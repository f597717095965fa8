// SPDX-License-Identifier: Apache-2.0
#include "sim/tuning.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "firmware/default_axis.hpp"
#include "shaper/axis/axis.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::sim {
namespace {

// An hour of an axis with a tick of a millisecond: far beyond the longest stepped sine.
constexpr size_t kMostTicks = 3600000;

// With the firmware's memory, so that what fits here fits there.
struct Rig {
  Axis<firmware::kLineCapacity> axis;
  AutoTune tune;
  TuneMemory memory;
};

TuneConfig config_of(const TuneTask& task) {
  TuneConfig config{};
  config.excitation = task.excitation;
  config.source = task.source;
  config.move = move_of(task.move);
  config.amplitude_counts = task.amplitude_counts;
  config.travel_counts = task.travel_counts;
  config.low_hz = task.low_hz;
  config.high_hz = task.high_hz;
  config.tolerance = task.tolerance;
  config.sensor_highest = highest_reading(task.drive.accelerometer);
  config.sensor_lowest = -config.sensor_highest;
  return config;
}

class Bench {
 public:
  explicit Bench(const TuneTask& task)
      : task_(task), config_(config_of(task)), rig_(std::make_unique<Rig>()), drive_(task.drive) {
    require(rig_->axis.configure(axis_config_of(task.move)), task.move.counts_per_unit);
    rig_->tune.begin(rig_->axis, rig_->memory);
    // As the firmware enables: from where the encoder says that the motor stands.
    rig_->axis.reset(drive_.exchange({0, false}).position);
  }

  Tuning run(const OnProgress& on_progress) {
    TunePlan plan{};
    const Status planned =
        plan_tuning(rig_->axis, config_, TuneMemory::kSamples, firmware::kLineCapacity, rig_->memory.excitation, plan);
    check(planned);
    check(rig_->tune.start(config_, &tuning_.first_announced));
    const TuneReport& report = rig_->tune.report();
    while (rig_->tune.busy()) {
      const TuneState before = report.state;
      tick();
      rig_->axis.service();
      rig_->tune.service({});
      if (report.state == TuneState::kIdentifying && before != report.state) take_record(plan.listen);
      if (report.state == TuneState::kProposed) check(rig_->tune.accept());
      if (on_progress) on_progress(report.progress_percent / 100.0);
    }
    tuning_.report = report;
    return std::move(tuning_);
  }

 private:
  void check(const Status& status) const { require(status, task_.move.counts_per_unit); }

  void tick() {
    if (tuning_.ticks.size() == kMostTicks) {
      throw Refusal(Refusal::Cause::kCannot, "tune", "an hour", "and no end, a narrower --band is accepted", "endless");
    }
    const Signal setpoint = rig_->axis.tick();
    const hal::ServoFeedback feedback = drive_.exchange({setpoint, true});
    rig_->tune.tick({setpoint, feedback.position, feedback.acceleration, feedback.valid});
    tuning_.ticks.push_back({rig_->tune.report().state, setpoint, drive_.tip_position(), drive_.tip_acceleration(),
                             feedback.position, feedback.acceleration});
  }

  // As the capture took it: the newest tick is the last of the last sample. What a sine answers has no record; that of
  // the bump after it comes later.
  void take_record(const ListenPlan& listen) {
    const bool to_error = rig_->tune.report().source == TuneSource::kFollowingError;
    const size_t ticks = size_t{listen.samples} * listen.decimation;
    if (tuning_.ticks.size() < ticks) return;
    const size_t first = tuning_.ticks.size() - ticks;
    tuning_.record.clear();
    for (size_t i = first; i < tuning_.ticks.size(); i += listen.decimation) {
      double sum = 0.0;
      for (size_t k = i; k < i + listen.decimation; ++k) {
        const TuneTick& tick = tuning_.ticks[k];
        sum += to_error ? static_cast<double>(tick.position - tick.setpoint) / static_cast<double>(kSignalPerCount)
                        : tick.acceleration;
      }
      tuning_.record.push_back(static_cast<float>(sum / listen.decimation));
    }
    tuning_.record_rate_hz = listen.rate_hz;
    tuning_.record_begins_s = (static_cast<double>(first) + 0.5 * (listen.decimation - 1.0)) * task_.move.tick_s;
  }

  const TuneTask& task_;
  TuneConfig config_;
  std::unique_ptr<Rig> rig_;
  SimulatedDrive drive_;
  Tuning tuning_{};
};

}  // namespace

int32_t highest_reading(const AccelerometerConfig& sensor) {
  return static_cast<int32_t>(std::min(sensor.range / sensor.resolution, 2147483647.0));
}

const char* text(TuneExcitation excitation) {
  switch (excitation) {
    case TuneExcitation::kMove: return "move";
    case TuneExcitation::kBump: return "bump";
    case TuneExcitation::kSteppedSine: return "stepped-sine";
    case TuneExcitation::kChirp: return "chirp";
    default: return "auto";
  }
}

const char* text(TuneSource source) {
  switch (source) {
    case TuneSource::kAccelerometer: return "accelerometer";
    case TuneSource::kFollowingError: return "following-error";
    default: return "auto";
  }
}

Tuning tune_on_drive(const TuneTask& task, const OnProgress& on_progress) { return Bench(task).run(on_progress); }

}  // namespace stillpoint::sim
