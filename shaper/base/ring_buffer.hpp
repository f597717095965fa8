// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

namespace stillpoint {

// First in, first out, at most kCapacity elements, no allocation. One writer and one reader in the same context, or one
// of them in an interrupt: `push` changes only `head_`, `pop` only `tail_`, and each publishes its index last.
template <typename T, size_t kCapacity>
class RingBuffer {
  static_assert(kCapacity >= 1, "a ring buffer holds at least one element");

 public:
  static constexpr size_t capacity() { return kCapacity; }

  bool empty() const { return size() == 0; }
  bool full() const { return size() == kCapacity; }

  size_t size() const {
    const size_t head = __atomic_load_n(&head_, __ATOMIC_ACQUIRE);
    const size_t tail = __atomic_load_n(&tail_, __ATOMIC_ACQUIRE);
    return head >= tail ? head - tail : head + kSlots - tail;
  }

  // False, and nothing stored, when full. O(1).
  [[nodiscard]] bool push(const T& element) {
    const size_t head = __atomic_load_n(&head_, __ATOMIC_RELAXED);
    const size_t next = advanced(head);
    if (next == __atomic_load_n(&tail_, __ATOMIC_ACQUIRE)) return false;
    slots_[head] = element;
    __atomic_store_n(&head_, next, __ATOMIC_RELEASE);
    return true;
  }

  // False, and `element` untouched, when empty. O(1).
  [[nodiscard]] bool pop(T& element) {
    const size_t tail = __atomic_load_n(&tail_, __ATOMIC_RELAXED);
    if (tail == __atomic_load_n(&head_, __ATOMIC_ACQUIRE)) return false;
    element = slots_[tail];
    __atomic_store_n(&tail_, advanced(tail), __ATOMIC_RELEASE);
    return true;
  }

  // As pop, and the element stays. Reader's context, or the writer's while nobody reads.
  [[nodiscard]] bool peek(T& element) const {
    if (empty()) return false;
    element = slots_[__atomic_load_n(&tail_, __ATOMIC_RELAXED)];
    return true;
  }

  // Forgets everything stored. Reader's context.
  void clear() { __atomic_store_n(&tail_, __atomic_load_n(&head_, __ATOMIC_ACQUIRE), __ATOMIC_RELEASE); }

 private:
  static constexpr size_t kSlots = kCapacity + 1;  // one stays free, so that full and empty differ
  static constexpr size_t advanced(size_t index) { return index + 1 == kSlots ? 0 : index + 1; }

  T slots_[kSlots] = {};
  size_t head_ = 0;
  size_t tail_ = 0;
};

}  // namespace stillpoint
