// SPDX-License-Identifier: Apache-2.0
// The staged modes (registers 0100 on), their design, and the way into the axis.
#pragma once

#include "firmware/parameters.hpp"
#include "shaper/axis/axis_core.hpp"
#include "shaper/shaping/design.hpp"

namespace stillpoint::firmware {

// Background only. Zero-initialised storage is valid.
//
// An apply is designed from the staged registers at once and refused at once; an accepted one waits until the axis
// stands and takes effect at a tick that allows a commit. A blended one does not wait for rest if the move under way
// leaves room. A stop that drops it on the way only makes it wait longer.
// A refusal leaves what was in force, or on its way, as it is.
class ShaperSettings {
 public:
  void begin(AxisCore& axis, Parameters& parameters);

  // Register 0130: apply. The design is left to `service`, so that the client's answer does not wait for it.
  void request_apply(Retune when);

  // Register 0130: the staged registers go back to what is in force; an apply that still waits for the axis is dropped.
  void discard();

  // As often as possible, when there is time for a design (some 10,000 instructions a mode with software doubles) or
  // for the search that a blend takes (BlendSearch).
  void service();

  // Something applied is not in force yet; a move now would be run with the old shaper.
  bool waiting() const { return apply_requested_ || waiting_; }

 private:
  static constexpr uint32_t kFieldCount = 5;
  struct Staged {
    uint32_t count;
    uint32_t fields[kMaxModes][kFieldCount];
  };

  Staged read_staged() const;
  void write_staged(const Staged& staged);
  Status design(const Staged& staged, ShaperDesign& out, uint32_t& failed_mode) const;
  void start_apply();
  void hand_over();
  void finish();
  void refuse_design(const Status& status, uint32_t mode);
  void refuse_length(const Status& status);
  void show_in_force();

  AxisCore* axis_ = nullptr;
  Parameters* parameters_ = nullptr;
  bool apply_requested_ = false;
  Retune when_ = Retune::kAtRest;
  bool waiting_ = false;
  ShaperDesign wanted_ = {};
  Staged wanted_registers_ = {};
  Staged in_force_ = {};
};

}  // namespace stillpoint::firmware
