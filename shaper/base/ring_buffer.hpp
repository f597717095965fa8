// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

#include "shaper/base/shared.hpp"

namespace stillpoint {

// First in, first out, at most kCapacity elements, no allocation. One writer and one reader in the same context, or one
// of them in an interrupt: `push` changes only `head_`, `pop` only `tail_`, and each publishes its index last.
template <typename T, size_t kCapacity>
class RingBuffer {
  static_assert(kCapacity >= 1 && kCapacity < UINT32_MAX, "a ring buffer holds at least one element");

 public:
  static constexpr size_t capacity() { return kCapacity; }

  bool empty() const { return size() == 0; }
  bool full() const { return size() == kCapacity; }

  size_t size() const {
    const uint32_t head = load(head_);
    const uint32_t tail = load(tail_);
    return head >= tail ? head - tail : head + kSlots - tail;
  }

  // False, and nothing stored, when full. O(1).
  [[nodiscard]] bool push(const T& element) {
    const uint32_t head = load(head_);
    const uint32_t next = advanced(head);
    if (next == load(tail_)) return false;
    slots_[head] = element;
    store(head_, next);
    return true;
  }

  // False, and `element` untouched, when empty. O(1).
  [[nodiscard]] bool pop(T& element) {
    const uint32_t tail = load(tail_);
    if (tail == load(head_)) return false;
    element = slots_[tail];
    store(tail_, advanced(tail));
    return true;
  }

  // As pop, and the element stays. Reader's context, or the writer's while nobody reads.
  [[nodiscard]] bool peek(T& element) const {
    if (empty()) return false;
    element = slots_[load(tail_)];
    return true;
  }

  // Forgets everything stored. Reader's context.
  void clear() { store(tail_, load(head_)); }

 private:
  static constexpr uint32_t kSlots = kCapacity + 1;  // one stays free, so that full and empty differ
  static constexpr uint32_t advanced(uint32_t index) { return index + 1 == kSlots ? 0 : index + 1; }

  T slots_[kSlots] = {};
  uint32_t head_ = 0;
  uint32_t tail_ = 0;
};

}  // namespace stillpoint
