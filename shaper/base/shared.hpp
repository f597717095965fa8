// SPDX-License-Identifier: Apache-2.0
// What crosses between the tick, an interrupt, and the background that it interrupts, on one core. A word of 32 bits
// crosses as it is; anything larger in a Snapshot.
#pragma once

#include <stdint.h>

namespace stillpoint {

// After `load` has seen a value, it sees all that was written before the `store` of that value.
[[gnu::always_inline]] inline uint32_t load(const uint32_t& word) { return __atomic_load_n(&word, __ATOMIC_ACQUIRE); }
[[gnu::always_inline]] inline void store(uint32_t& word, uint32_t value) {
  __atomic_store_n(&word, value, __ATOMIC_RELEASE);
}

// A value of any size that the tick writes and the background reads whole. Zero-initialised storage holds T{}.
template <typename T>
class Snapshot {
 public:
  // Tick. Runs to its end while a reader waits.
  void publish(const T& value) {
    value_ = value;
    store(version_, version_ + 1);
  }

  // Tick: what was published last.
  const T& latest() const { return value_; }

  // Background. Copies again if a tick came between.
  void read(T& copy) const {
    for (;;) {
      const uint32_t version = load(version_);
      copy = value_;
      __atomic_signal_fence(__ATOMIC_SEQ_CST);
      if (load(version_) == version) return;
    }
  }
  T read() const {
    T copy;
    read(copy);
    return copy;
  }

 private:
  T value_ = {};
  uint32_t version_ = 0;
};

}  // namespace stillpoint
