// SPDX-License-Identifier: Apache-2.0
// A whole drive under arbitrary bytes and ticks, for libFuzzer: the input is a programme (programme.hpp). What must
// hold is in client_watch.hpp. (Crashes and undefined behaviour are the sanitizers' to find.)
//
// `fuzz_modbus seeds DIR` writes the programmes to begin with. The drive is made anew for every input, in the same
// static storage.
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <new>
#include <string>
#include <vector>

#include "tests/fuzz/programme.hpp"
#include "tests/support/random.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::testing;

using Entry = std::array<uint8_t, kRecord>;

Entry record(uint8_t operation, uint8_t a = 0, uint32_t first = 0, uint32_t second = 0, uint8_t f = 0, uint8_t g = 0) {
  return {operation,
          a,
          static_cast<uint8_t>(first >> 8),
          static_cast<uint8_t>(first),
          static_cast<uint8_t>(second >> 8),
          static_cast<uint8_t>(second),
          f,
          g};
}

void write_seed(const std::string& folder, const std::string& name, const std::vector<Entry>& records) {
  std::ofstream file(folder + "/" + name, std::ios::binary);
  for (const Entry& one : records) file.write(reinterpret_cast<const char*>(one.data()), kRecord);
}

uint8_t index_of(uint16_t address) {
  const auto at = std::find(std::begin(kRegisters), std::end(kRegisters), address);
  return static_cast<uint8_t>(at - std::begin(kRegisters));
}

void write_seeds(const std::string& folder) {
  const Entry enable = record(kEnable);
  const Entry wait = record(kLongStep, 60);
  write_seed(folder, "move", {enable, record(kMove, 1, 2000), wait, record(kControl, 0x0B), wait, wait});
  write_seed(folder, "shaped", {record(kShaper, 1, 2600, 11000), enable, record(kMove, 1, 2000), wait, wait});
  write_seed(folder, "buffered",
             {enable, record(kMove, 1, 2000), record(kMove, 1, 1000), record(kMove, 0x21, 5), wait});
  write_seed(folder, "velocity", {record(kMode, 1), enable, record(kVelocity, 0, 900), wait, record(kVelocity), wait});
  write_seed(folder, "homing", {record(kMode, 2), enable, record(kControl, 0x1F), wait});
  write_seed(folder, "stream", {record(kMode, 3), enable, record(kStreamPoints, 9, 20), record(kControl, 0x1F), wait});
  write_seed(folder, "tune", {enable, record(kTune, 1), wait, wait, wait, record(kTune, 3), wait});
  const Entry limits = record(kSoftLimits, 0, 300, 3000);
  write_seed(folder, "limits", {limits, enable, record(kMove, 1, 1400), wait, record(kMove, 1, 2000), wait});
  write_seed(
      folder, "limited_velocity",
      {limits, record(kMode, 1), enable, record(kVelocity, 0, 900), wait, wait, record(kVelocity, 0, 500), wait});
  write_seed(folder, "limited_stream",
             {limits, record(kMode, 3), enable, record(kStreamPoints, 15, 2000), record(kControl, 0x1F), wait, wait});
  write_seed(folder, "limited_tune", {limits, enable, record(kTune, 1), wait, wait, wait});
  write_seed(folder, "limited_braking",
             {limits, enable, record(kMove, 0, 1400), record(kStep, 25),
              record(kWide, index_of(0x0064), 0x001E, 0x8480), record(kMove, 0x20, 500), wait});
  const Entry rest = record(kLongStep, 255);
  write_seed(folder, "velocity_left",
             {record(kMode, 1), enable, record(kVelocity, 0, 900), wait, record(kControl, 0x0F, 0x0100), wait,
              record(kMode, 0), record(kControl, 0x0F), rest, wait, wait, record(kMode, 1), wait});
  write_seed(folder, "velocity_over",
             {record(kMode, 1), enable, record(kVelocity, 0, 900), wait, record(kVelocity), rest, wait, wait, wait});
  write_seed(folder, "tune_aborted",
             {record(kSingle, index_of(0x0249), 4000), enable, record(kTune, 1), wait, record(kTune, 2), rest, wait,
              wait, rest});
  write_seed(folder, "fault",
             {enable, record(kMove, 1, 900), record(kTrouble, 1), wait, record(kTrouble), wait, record(kControl, 0x80),
              record(kControl), enable, record(kMove, 1, 50), wait});
  write_seed(folder, "broadcast", {enable, record(kMove, 1, 900), record(kBroadcast, 3, 0x0B), wait, enable, wait});
  std::vector<Entry> keys;
  for (uint8_t key = 1; key < 4; ++key) {
    keys.push_back(record(kKey));
    keys.push_back(record(kKey, key));
    keys.push_back(wait);
  }
  write_seed(folder, "keys", keys);
  for (uint8_t i = 0; i < kRegisterCount; ++i) {
    write_seed(folder, "register" + std::to_string(i),
               {record(kKey), record(kSingle, i, 1), record(kWide, i, 0, 1000), record(kMask, i, 0xFF, 1),
                record(kReadWrite, i, 0x40, 4, 1, 1), record(kRead, i, 0, 2, 0, 1), record(kBadCrc, i, 1),
                record(kBroadcast, i, 0, 5, 1)});
  }
  std::vector<Entry> functions;
  for (uint8_t sub = 0; sub < 24; ++sub) functions.push_back(record(kDiagnostics, sub));
  functions.push_back(record(kIdentify, 0, 0x0E01));
  write_seed(folder, "functions", functions);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments);
extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned seed);
extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  if (*count == 3 && std::strcmp((*arguments)[1], "seeds") == 0) {
    write_seeds((*arguments)[2]);
    std::exit(0);
  }
  return 0;
}

// Whole records are put in, taken out, doubled and moved, so that what follows keeps its meaning; else libFuzzer's own.
extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned seed) {
  testing::Random random(seed);
  const auto below = [&](size_t n) {
    return static_cast<size_t>(random.integer(0, n == 0 ? int64_t{0} : static_cast<int64_t>(n - 1)));
  };
  std::vector<uint8_t> bytes(data, data + size / kRecord * kRecord);
  const auto at = [&](size_t records) { return bytes.begin() + static_cast<std::ptrdiff_t>(below(records) * kRecord); };
  const size_t records = bytes.size() / kRecord;
  const size_t how = below(6);
  if (how < 2 || records == 0) {
    Entry one = {};
    for (uint8_t& byte : one) byte = static_cast<uint8_t>(below(256));
    if (below(2) == 0) one[0] = static_cast<uint8_t>(below(2) == 0 ? kEnable : kMove);
    bytes.insert(at(records + 1), one.begin(), one.end());
  } else if (how == 2) {
    const auto from = at(records);
    bytes.erase(from, from + kRecord);
  } else if (how == 3) {
    const auto from = at(records);
    const std::vector<uint8_t> one(from, from + kRecord);
    bytes.insert(at(records + 1), one.begin(), one.end());
  } else if (how == 4) {
    *(at(records) + static_cast<std::ptrdiff_t>(below(kRecord))) = static_cast<uint8_t>(below(256));
  } else {
    return LLVMFuzzerMutate(data, size, most);
  }
  const size_t length = bytes.size() < most ? bytes.size() : most;
  std::memcpy(data, bytes.data(), length);
  return length;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  constexpr size_t kMostRecords = 64;
  alignas(Rig) static uint8_t storage[sizeof(Rig)];
  Rig* rig = new (storage) Rig();
  rig->step(3, true);
  Programme programme(*rig);
  for (size_t i = 0; i < kMostRecords && (i + 1) * kRecord <= size; ++i) programme.run(data + i * kRecord);
  rig->step(50, true);
  rig->~Rig();
  return 0;
}
