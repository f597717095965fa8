// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace stillpoint::hal {

// Memory that survives a power cut, in pages that are erased whole to FFh and programmed word by word.
// Background context; may take seconds. Every call says whether the memory did it.
class Nonvolatile {
 public:
  virtual size_t page_count() const = 0;
  virtual size_t page_bytes() const = 0;
  virtual bool read(size_t page, size_t offset, uint8_t* to, size_t bytes) const = 0;
  virtual bool erase(size_t page) = 0;
  virtual bool program(size_t page, size_t offset, uint32_t word) = 0;

 protected:
  ~Nonvolatile() = default;
};

}  // namespace stillpoint::hal
