// SPDX-License-Identifier: Apache-2.0
// Auto-tune through the client's door (registers 0200 on).
#pragma once

#include <stdint.h>

#include "firmware/drive.hpp"
#include "firmware/parameters.hpp"
#include "firmware/shaper_settings.hpp"
#include "shaper/axis/axis_core.hpp"
#include "shaper/tune/auto_tune.hpp"

namespace stillpoint::firmware {

// Background only. Zero-initialised storage is valid.
//
// A start takes what is staged when it is written: the move that excites goes out by the amplitude (0202) from where
// the axis stands, upwards unless only below there is room between the soft limits, with the profile of 0060-006A in
// the least time, zero delay as 0137. What it will do can be read at once (0230 on); nothing moves before the time of
// 0249 is over, and an abort in it leaves everything as it was. Where a stepped sine follows that was not asked for (by
// 0), what it will do is announced anew and the time of 0249 runs again. A start by a stepped sine or a chirp plans
// them before it answers: up to 7 million instructions, and 43 million for a chirp from 0.1 Hz.
//
// From then on until the end the tuner has the axis: set-points, applies and new axis limits are refused. Whatever
// takes the axis out of operation enabled, or halts it, aborts the tuning. What is kept becomes the shaper set in
// force (0100 on), so that it can be applied again and stored like any other. Where the axis refuses a motion or a
// shaper on the way, the tuning has failed and 0012 has the reason.
class TuneSettings {
 public:
  struct Parts {
    AxisCore* axis;
    AutoTune* tuner;
    Drive* drive;
    ShaperSettings* shaper;
    Parameters* parameters;
  };

  void begin(const Parts& parts) { parts_ = parts; }

  // Register 0200, with the registers as they will be once the write that it comes in is done. False where it is
  // refused, and nothing has happened then: the reason is in 0012. A start plans a move.
  bool command(TuneCommand command, const Parameters& staged, uint32_t now_ms);

  // After each Drive::service. Short.
  void keep_watch();

  // As often as possible, when there is time for an identification and the designs after it.
  void service(uint32_t now_ms, const Meanwhile& meanwhile);

  // Brings the registers up to date.
  void show();

  // It has begun. Before that only what returns nothing may be called, and `busy`.
  bool available() const { return parts_.tuner != nullptr; }
  bool busy() const { return available() && parts_.tuner->busy(); }

 private:
  uint16_t reason_against(TuneCommand command) const;
  Status start(const Parameters& staged, uint32_t now_ms);
  void refuse_start(const Status& status);
  void finish(const TuneReport& report);
  void clear_shown();
  void show_result(const TuneReport& report);
  void show_modes(const TuneReport& report);
  void set(Register name, double value);

  Parts parts_ = {};
  double from_counts_ = 0.0;  // where it stood, for refusals
  double low_hz_ = 0.0;
  bool leading_ = false;  // announced, and nothing has begun
  bool running_ = false;  // and its end is still to be seen to
  bool aborted_ = false;  // for what the drive does; once is enough
  bool undoing_ = false;  // what was kept
  uint32_t started_ms_ = 0;
  TuneState seen_ = TuneState::kIdle;
  bool by_sine_ = false;  // that was not asked for
};

}  // namespace stillpoint::firmware
