// SPDX-License-Identifier: Apache-2.0
// Shapers prepared for the loads or poses of one axis, switched by number.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "shaper/axis/axis_core.hpp"
#include "shaper/base/status.hpp"
#include "shaper/shaping/design.hpp"

namespace stillpoint {

constexpr uint32_t kNoShaperSet = UINT32_MAX;

// RAM: sizeof(ShaperDesign) a set. All zeros at first, so a static one lies in .bss. Background context, one caller at
// a time; the tick never sees it, since the axis takes a copy.
template <size_t kSets = 8>
class ShaperSets {
  static_assert(kSets >= 1, "at least one set");
  static_assert(kSets <= 64, "sets are counted in tens: more of them belong in nonvolatile memory");

 public:
  // Keeps a copy of the design under this number. (One without stages is a set too: pass-through.) What the axis runs
  // does not change: the set stored over is no longer in force, and the new one is not before it is selected. Refuses
  // kAboveMaximum a number that there is not, with the last that there is. Whether the design fits the line of an axis
  // shows when it is selected. Cost: one copy.
  Status store(uint32_t index, const ShaperDesign& design) {
    const Status status = check(index);
    if (!status.ok()) return status;
    designs_[index] = design;
    stored_[index] = true;
    return status;
  }

  // Hands the set over to the axis by AxisCore::set_shaper, which says when it takes effect and what it refuses
  // (kBusy, kLineTooShort); `how` goes to it as it is. Refuses kAboveMaximum a number that there is not, and
  // kNotAvailable, with the number as value, a set that nothing was stored in. After a refusal the axis runs what it
  // ran.
  template <typename... How>
  Status select(uint32_t index, AxisCore& axis, const How&... how) {
    Status status = check(index);
    if (status.ok() && !stored_[index]) status = refuse(Error::kNotAvailable, Quantity::kNone, index);
    if (status.ok()) status = axis.set_shaper(designs_[index], how...);
    if (status.ok()) selected_ = index;
    return status;
  }

  // The set that the axis runs now, bit for bit, or kNoShaperSet: read off the axis, so it holds whoever gave it its
  // shaper, and while the set selected last still waits for its tick. Of sets that are the same, the one selected
  // last, or else the first. Cost: up to kSets comparisons of designs; 700 bytes of stack.
  uint32_t in_force(const AxisCore& axis) const {
    const ShaperDesign design = axis.shaper();
    if (holds(selected_, design)) return selected_;
    for (uint32_t i = 0; i < kSets; ++i) {
      if (holds(i, design)) return i;
    }
    return kNoShaperSet;
  }

  bool stored(uint32_t index) const { return index < kSets && stored_[index]; }

  // Of a number that there is; without stages if nothing was stored.
  const ShaperDesign& design(uint32_t index) const { return designs_[index]; }

 private:
  static Status check(uint32_t index) {
    if (index >= kSets) return refuse(Error::kAboveMaximum, Quantity::kNone, index, kSets - 1);
    return kOk;
  }

  bool holds(uint32_t index, const ShaperDesign& other) const {
    const ShaperDesign& own = designs_[index];
    if (!stored_[index] || own.stage_count != other.stage_count || own.tap_count != other.tap_count) return false;
    for (uint32_t i = 0; i < own.stage_count; ++i) {
      if (own.stages[i].first_tap != other.stages[i].first_tap) return false;
      if (own.stages[i].tap_count != other.stages[i].tap_count) return false;
    }
    for (uint32_t i = 0; i < own.tap_count; ++i) {
      if (own.taps[i].delay_ticks != other.taps[i].delay_ticks) return false;
      if (own.taps[i].gain != other.taps[i].gain) return false;
    }
    return true;
  }

  ShaperDesign designs_[kSets] = {};
  bool stored_[kSets] = {};
  uint32_t selected_ = 0;
};

}  // namespace stillpoint
