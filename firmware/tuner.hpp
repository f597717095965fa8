// SPDX-License-Identifier: Apache-2.0
// What of a drive identifies its own arm.
#pragma once

#include <stdint.h>

#include "firmware/drive.hpp"
#include "firmware/mode_tracking.hpp"
#include "firmware/parameters.hpp"
#include "firmware/shaper_settings.hpp"
#include "firmware/tuning.hpp"
#include "shaper/axis/axis_core.hpp"
#include "shaper/tune/auto_tune.hpp"

namespace stillpoint::firmware {

// The auto-tune that a client asks for (TuneSettings, 0200 on) and the following of the modes in force (ModeTracking,
// 0250 on).
//
// A third of an image is this and what only it calls. An image that has no flash for it is linked with no_tuner.cpp,
// whose functions then stand in for those of tuner.cpp: there every command is refused as not available, and what shows
// a tuning reads 0. Such a drive is identified by its client, from the scope.
//
// Background, but for `tick`. Zero-initialised storage is valid.
class Tuner {
 public:
  struct Parts {
    AxisCore* axis;
    TuneMemory* memory;  // null: this drive has no tuner
    Drive* drive;
    ShaperSettings* shaper;
    Parameters* parameters;
  };

  void begin(const Parts& parts);

  // Whether there is one. Without nothing may be commanded.
  bool available() const;

  // Register 0200, see TuneSettings::command.
  bool command(TuneCommand command, const Parameters& staged, uint32_t now_ms);

  // After each Drive::service. Short. `background_wanted`: by something that is not among the parts.
  void keep_watch(bool background_wanted);

  // As often as possible, when there is time for an identification: the auto-tune's work, and last of all the modes'.
  void service(uint32_t now_ms, const Meanwhile& meanwhile);
  void follow(const Meanwhile& meanwhile);

  // Brings registers 0208 to 0249 up to date.
  void show();

  // It has the axis.
  bool busy() const;

  const TuneReport& report() const { return tuner_.report(); }

  // --- tick -------------------------------------------------------------------------------------------------------

  // See AutoTune::tick.
  void tick(const TuneSample& sample);

 private:
  AutoTune tuner_ = {};
  TuneSettings settings_ = {};
  ModeTracking tracking_ = {};
};

}  // namespace stillpoint::firmware
