// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/page_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

constexpr uint8_t kErased = 0xFF;

}  // namespace

PageFile::PageFile(const std::string& path) : path_(path), bytes_(kPages * kPageBytes, kErased) {
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown)) {
    std::ofstream(path, std::ios::binary).flush();
    if (write(0, bytes_.size())) return;
    throw sim::bad_argument("--memory", path, "cannot be written, a file that can be is accepted");
  }
  std::ifstream file(path, std::ios::binary);
  if (std::filesystem::is_directory(path, unknown) || !file)
    throw sim::bad_argument("--memory", path, "cannot be read, a file that can be is accepted");
  const std::vector<char> there{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (there.size() != bytes_.size())
    throw sim::bad_argument("--memory", path,
                            std::to_string(there.size()) + " bytes, a file of " + std::to_string(bytes_.size()) +
                                ", or none yet, is accepted");
  std::transform(there.begin(), there.end(), bytes_.begin(), [](char byte) { return static_cast<uint8_t>(byte); });
}

bool PageFile::read(size_t page, size_t offset, uint8_t* to, size_t bytes) const {
  if (page >= kPages || offset + bytes > kPageBytes) return false;
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(page * kPageBytes + offset), bytes, to);
  return true;
}

bool PageFile::erase(size_t page) {
  if (page >= kPages) return false;
  std::fill_n(bytes_.begin() + static_cast<std::ptrdiff_t>(page * kPageBytes), kPageBytes, kErased);
  return write(page * kPageBytes, kPageBytes);
}

// Bits only fall.
bool PageFile::program(size_t page, size_t offset, uint32_t word) {
  if (page >= kPages || offset % 4 != 0 || offset >= kPageBytes) return false;
  const size_t at = page * kPageBytes + offset;
  for (size_t i = 0; i < 4; ++i) bytes_[at + i] = static_cast<uint8_t>(bytes_[at + i] & (word >> (8 * i)));
  return write(at, 4);
}

bool PageFile::write(size_t at, size_t count) const {
  std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::streamoff>(at));
  for (size_t i = 0; i < count; ++i) file.put(static_cast<char>(bytes_[at + i]));
  return static_cast<bool>(file.flush());
}

}  // namespace stillpoint::cli
