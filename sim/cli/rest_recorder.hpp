// SPDX-License-Identifier: Apache-2.0
// A drive's moves there and back, and what its scope records of the rest after them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "shaper/tune/tune_plan.hpp"
#include "sim/cli/chip_client.hpp"
#include "sim/hil/register_port.hpp"
#include "sim/recorded_rest.hpp"

namespace stillpoint::cli {

class RestRecorder {
 public:
  // `meanwhile` is called while it waits; what it throws ends what is under way.
  RestRecorder(sim::RegisterPort& port, const std::function<void()>& meanwhile)
      : port_(port), client_(port), meanwhile_(meanwhile) {}

  // Between where the axis stands, `home`, and the config's target. Refuses a band as plan_listening does.
  void prepare(const TuneConfig& config, int32_t home);

  // To the other end. Before the first, unless it is the following error that is asked for, once there and back to see
  // both sensors. Throws a Refusal, also where more than 1 % of the ticks had no feedback, or the scope holds fewer
  // samples than the drive's own tuner.
  sim::RecordedRest move_and_record();

  // Of the last record, in ticks, with the motion before it.
  uint32_t gaps() const { return gaps_; }

 private:
  using Channels = std::vector<std::vector<int32_t>>;

  void look_at_sensors();
  Channels record(const std::string& channels, uint32_t decimation);
  MoveReport start_other_way();

  sim::RegisterPort& port_;
  ChipClient client_;
  std::function<void()> meanwhile_;
  int32_t ends_[2] = {};
  bool is_out_ = false;
  uint32_t decimation_ = 1;
  bool looked_ = false;
  bool by_accelerometer_ = false;
  TuneSource source_ = TuneSource::kAuto;
  sim::RestChannel motor_;  // its following error in the first rest
  uint32_t gaps_ = 0;
};

}  // namespace stillpoint::cli
