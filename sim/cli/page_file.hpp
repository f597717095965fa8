// SPDX-License-Identifier: Apache-2.0
// A drive's parameter memory as a file: its pages one after the other.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/nonvolatile.hpp"

namespace stillpoint::cli {

// Every erase and every word goes into the file at once, so that a process that is killed is a power cut.
class PageFile final : public hal::Nonvolatile {
 public:
  static constexpr size_t kPages = 2;
  static constexpr size_t kPageBytes = 4096;

  // Erased where there is no such file yet. Throws a Refusal where it cannot be read or is of another size.
  explicit PageFile(const std::string& path);

  size_t page_count() const override { return kPages; }
  size_t page_bytes() const override { return kPageBytes; }
  bool read(size_t page, size_t offset, uint8_t* to, size_t bytes) const override;
  bool erase(size_t page) override;
  bool program(size_t page, size_t offset, uint32_t word) override;

  const std::vector<uint8_t>& bytes() const { return bytes_; }

 private:
  bool write(size_t at, size_t count) const;

  std::string path_;
  std::vector<uint8_t> bytes_;
};

}  // namespace stillpoint::cli
