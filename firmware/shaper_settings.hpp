// SPDX-License-Identifier: Apache-2.0
// The staged modes (registers 0100 on), their designs, and the way into the axis.
#pragma once

#include "firmware/parameters.hpp"
#include "shaper/axis/axis_core.hpp"
#include "shaper/axis/shaper_sets.hpp"
#include "shaper/shaping/design.hpp"
#include "shaper/shaping/meanwhile.hpp"

namespace stillpoint::firmware {

// Background only. Zero-initialised storage is valid.
//
// Each of kShaperSets has staged registers of its own; register 0101 says which set's 0100 on show and edit, and apply
// designs and applies. An apply takes what is staged when it is written; it is refused once its design is, and an
// accepted one waits until the axis stands and takes effect at a tick that allows a commit. A blended one does not wait
// for rest if the move under way leaves room. A stop that drops it on the way only makes it wait longer. A set applied
// before, unchanged, is not designed again.
// A refusal leaves what was in force, or on its way, as it is.
class ShaperSettings {
 public:
  static constexpr uint32_t kSetInForce = kShaperSets;

  // `meanwhile` is called while a design runs; it may call what a register write calls here, but not `service`.
  void begin(AxisCore& axis, Parameters& parameters, const Meanwhile& meanwhile);

  // Register 0101: this set's registers are shown from now on. What runs does not change.
  void show_set(uint32_t set);

  // The staged registers of any set, shown or not: 0100 and those of the modes but the reserved ones. Of set
  // kSetInForce what is in force, or `restoring`, was made from; staged there, it waits for `restore`.
  uint32_t staged(uint32_t set, Register name) const;
  void stage(uint32_t set, Register name, uint32_t value);

  // The set that it belongs to, and whether there is one at all.
  uint32_t set_in_force() const { return set_in_force_; }
  bool shapes() const { return sets_[set_in_force_].in_force.count != 0; }

  // At the start, before anything was applied: what is staged in kSetInForce is applied at rest as the set of this
  // number, if it is anything. As behind every apply no motion begins before it is in force or refused.
  void restore(uint32_t set);
  // From then on, until this or something else has come into force, no shaper being something too: for good where it is
  // refused. Until then it counts as what was last in force of its set, for `discard` and a save.
  bool restoring() const { return restoring_; }

  // Nothing is to be in force, in the same way.
  void take_off();

  // Register 0130: apply. The design is left to `service`, so that the client's answer does not wait for it; one that
  // is under way is given up after its mode.
  void request_apply(Retune when);

  // Register 0130: the staged registers of the set go back to what was last in force of it; an apply of any set that
  // still waits for the axis is dropped.
  void discard();

  // As often as possible, when there is time for a design (see add_shaper) or for the search that a blend takes
  // (BlendSearch).
  void service();

  // What runs since the axis was tuned came from elsewhere, made of these: it becomes the set in force, what was staged
  // and in force of that is put aside. At most kMaxModes.
  void adopt(const ShaperSpec* specs, uint32_t count);

  // The shaper before `adopt` runs again, and the set is as it was when it was in force.
  void give_back();

  // The modes that what runs was made for; at most kMaxModes, and how many.
  uint32_t modes_in_force(Mode* modes) const;

  // Those of registers 0260 on in place of them: staged in the same set, and applied at rest. Nothing happens where
  // what is in force leaves at the worst of those at most `worthwhile` more than at the worst of its own, while an
  // apply is under way, or where the client has something else staged in the set. Where the design is refused, or
  // overtaken, the set is as it was, staged and in 0131 on, but for what the client has staged since; 0251 says why.
  void follow(double worthwhile);

  // Goes up when something comes into force otherwise than by `follow`.
  uint32_t changes() const { return changes_; }

  // Registers 0131 to 0136 from what runs, which somebody else may have changed.
  void show_in_force();

  // Nothing else has come into force since.
  bool adopted() const { return adopted_; }

  // Something applied is not in force yet; a move now would be run with the old shaper.
  bool waiting() const { return apply_requested_ || designing_ || waiting_; }

 private:
  static constexpr uint32_t kFieldCount = 5;
  struct Staged {
    uint32_t count;
    uint32_t fields[kMaxModes][kFieldCount];
  };
  struct Set {
    Staged staged;    // while another is shown; the shown one's lie in the parameters
    Staged designed;  // what the prepared design was made from
    Staged in_force;  // the last of this set that was
  };

  void take_over(const Staged& staged, bool restoring);
  void note_change();
  Staged staged_of(uint32_t set) const;
  void stage_set(uint32_t set, const Staged& staged);
  void drop_followed();
  void request(uint32_t set, const Staged& staged, Retune when);
  struct Place {
    uint32_t mode;
    uint32_t field;  // kFieldCount: the number of modes
  };

  static Place place_of(Register name);
  static bool same(const Staged& a, const Staged& b);
  Staged read_staged() const;
  void write_staged(const Staged& staged);
  void start_apply();
  bool prepare(uint32_t set, const Staged& staged);
  void hand_over();
  void finish();
  double worst_residual(const ShaperDesign& active, const Staged& modes) const;
  void refuse_design(const Status& status, uint32_t mode);
  void refuse_length(const Status& status);
  void refuse(uint16_t reason, Register culprit, uint32_t accepted);

  AxisCore* axis_ = nullptr;
  Parameters* parameters_ = nullptr;
  Meanwhile meanwhile_ = {};
  uint32_t shown_ = 0;

  // An apply goes from requested, through designing, to waiting for the axis; a later one overtakes it.
  bool apply_requested_ = false;
  uint32_t requested_set_ = 0;
  Staged requested_ = {};
  Retune requested_when_ = Retune::kAtRest;
  bool designing_ = false;
  bool waiting_ = false;
  bool following_ = false;  // the newest apply is `follow`'s
  uint32_t changes_ = 0;
  uint32_t wanted_set_ = 0;
  Retune when_ = Retune::kAtRest;

  bool restoring_ = false;
  uint32_t set_in_force_ = 0;
  bool adopted_ = false;
  Staged before_ = {};  // adopt
  bool was_restoring_ = false;
  Set sets_[kShaperSets] = {};
  ShaperSets<kShaperSets> prepared_ = {};
};

}  // namespace stillpoint::firmware
