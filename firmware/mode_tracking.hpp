// SPDX-License-Identifier: Apache-2.0
// The modes in force, followed from move to move (registers 0250 on).
#pragma once

#include <stdint.h>

#include "firmware/drive.hpp"
#include "firmware/parameters.hpp"
#include "firmware/shaper_settings.hpp"
#include "firmware/tuning.hpp"
#include "shaper/tune/auto_tune.hpp"
#include "shaper/tune/tracker.hpp"

namespace stillpoint::firmware {

// Off until 0250 says otherwise. After each move it records what still rings, from the source and with the sensor's
// ends that the auto-tune is told (020C, 024A on), until the axis moves again, for eight periods of the slowest mode or
// more; looks at it when nothing else is to be done; and moves the modes that it began with, those that the shaper in
// force was made for, by what the record tells (ModeTracker). Behind a shaper that leaves nothing there is nothing to
// hear: what is not measurable moves nothing. It begins anew with every shaper that comes into force otherwise than by
// itself. Modes that no record can hold (see plan_listening) are not followed.
//
// Never in the way: a look that a set-point, a velocity, an apply, a tuning, a save or a scope finds under way is given
// up, within 128 samples of a pass or a transform of kSamples, and the record is looked at again afterwards: in motion
// too, unless a change of that motion is checked behind the shaper (zero delay, negative gains). A tuning or a scope
// that takes the memory, a halt, and whatever ends operation enabled lose the record.
//
// With kApply the set is staged and applied at rest, as if a client had done it, once the shaper in force leaves at the
// worst of the modes followed more than at the worst of its own by kWorthwhile of the residual wanted (020E). A
// set-point waits for such a design as for any. Nothing is applied while the client has something else staged in the
// set. A refusal is in 0251, changes nothing else, and is final until it begins anew.
//
// Background. Zero-initialised storage is valid. A look takes 3 KB of stack.
class ModeTracking {
 public:
  static constexpr double kWorthwhile = 0.5;
  static constexpr uint32_t kSamples = 512;

  struct Parts {
    AxisCore* axis;
    AutoTune* tuner;
    const Drive* drive;
    ShaperSettings* shaper;
    const TuneSettings* tuning;
    Parameters* parameters;
  };

  void begin(const Parts& parts) { parts_ = parts; }

  // As often as possible, last of all, when there is time for an identification.
  void service(const Meanwhile& meanwhile);

  // With all that is done meanwhile: gives a look up that is in the way of that. `busy`: something that is not among
  // the parts.
  void keep_watch(bool busy);

 private:
  Tracking wanted() const { return static_cast<Tracking>(parts_.parameters->get(Register::kTracking)); }
  bool is_in_the_way() const;
  void begin_anew();
  void listen();
  void look(const Meanwhile& meanwhile);
  void apply();
  void show();

  Parts parts_ = {};
  ModeTracker tracker_ = {};
  uint32_t least_ = 0;    // samples worth a look
  uint32_t changes_ = 0;  // of the shaper, that it began with
  bool begun_ = false;
  bool moved_ = false;     // a mode, since the shaper was last compared with it
  bool given_up_ = false;  // the look under way
};

}  // namespace stillpoint::firmware
