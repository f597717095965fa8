// SPDX-License-Identifier: Apache-2.0
// Flash of two pages with a plug that can be pulled at any erase or word. What the cut meets is left, at random,
// not begun, done, or (in half of the cuts) half done: any of a word's bits programmed, any of a page's words erased,
// some of the bits of others.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include <limits>
#include <utility>
#include <vector>

#include "hal/nonvolatile.hpp"
#include "tests/support/random.hpp"

namespace stillpoint::testing {

class FlashModel final : public hal::Nonvolatile {
 public:
  static constexpr size_t kPages = 2;
  static constexpr size_t kPageBytes = 4096;
  static constexpr uint64_t kNever = std::numeric_limits<uint64_t>::max();

  FlashModel() {
    for (auto& page : pages) page.assign(kPageBytes / 4, UINT32_MAX);
  }

  // The operation, counted from now, that the power fails in; whatever is asked for after it is not done.
  void cut_at(uint64_t operation, uint64_t seed) {
    operations_ = 0;
    cut_ = operation;
    random_ = Random(seed);
    damage_ = static_cast<Damage>(random_.integer(0, 3));
  }
  void power_up() { cut_ = kNever; }
  uint64_t operations() const { return operations_; }

  size_t page_count() const override { return kPages; }
  size_t page_bytes() const override { return kPageBytes; }

  bool read(size_t page, size_t offset, uint8_t* to, size_t bytes) const override {
    if (page >= kPages || offset + bytes > kPageBytes || dead) return false;
    for (size_t i = 0; i < bytes; ++i) {
      to[i] = static_cast<uint8_t>(pages[page][(offset + i) / 4] >> (8 * ((offset + i) % 4)));
    }
    return true;
  }

  bool erase(size_t page) override {
    if (page >= kPages || !begin()) return false;
    if (failing() && damage_ == Damage::kNotBegun) return false;
    for (uint32_t& word : pages[page]) {
      if (!spoiled() || random_.integer(0, 2) == 0) {
        word = UINT32_MAX;
      } else if (random_.integer(0, 1) == 0) {
        word |= static_cast<uint32_t>(random_.next());
      }
    }
    return !failing();
  }

  // Bits only fall.
  bool program(size_t page, size_t offset, uint32_t word) override {
    if (page >= kPages || offset % 4 != 0 || offset >= kPageBytes || !begin()) return false;
    if (failing() && damage_ == Damage::kNotBegun) return false;
    uint32_t& at = pages[page][offset / 4];
    overwritten = overwritten || at != UINT32_MAX;
    at &= spoiled() ? word | static_cast<uint32_t>(random_.next()) : word;
    return !failing();
  }

  std::vector<uint32_t> pages[kPages];
  bool dead = false;         // answers nothing
  bool overwritten = false;  // a word was programmed that was not erased

 private:
  enum class Damage : uint8_t { kNotBegun, kDone, kHalf, kAlsoHalf };

  bool begin() {
    if (dead || operations_ > cut_) return false;
    ++operations_;
    return true;
  }
  bool failing() const { return operations_ > cut_; }
  bool spoiled() const { return failing() && damage_ != Damage::kDone; }

  uint64_t operations_ = 0;
  uint64_t cut_ = kNever;
  Random random_{0};
  Damage damage_ = Damage::kNotBegun;
};

}  // namespace stillpoint::testing
