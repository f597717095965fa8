// SPDX-License-Identifier: Apache-2.0
// A whole drive under arbitrary bytes and ticks, for libFuzzer. The input is a programme of records of eight bytes:
// what the line carries, with a good CRC, a bad one or none, and for how long time goes on. What must hold is in
// client_watch.hpp. (Crashes and undefined behaviour are the sanitizers' to find.)
//
// `fuzz_modbus seeds DIR` writes the programmes to begin with. The drive is made anew for every input, in the same
// static storage.
#include <stddef.h>
#include <stdint.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <new>
#include <string>
#include <vector>

#include "firmware/application.hpp"
#include "firmware/crc16.hpp"
#include "firmware/default_axis.hpp"
#include "shaper/axis/axis.hpp"
#include "tests/fuzz/client_watch.hpp"
#include "tests/support/flash_model.hpp"

namespace {

using namespace stillpoint;

struct Line final : hal::ByteStream {
  explicit Line(testing::ClientWatch& watch) : watch_(watch) {}
  std::deque<uint8_t> to_drive;
  bool stuck = false;  // takes two bytes of an answer

  bool read(uint8_t& byte) override {
    const bool any = !to_drive.empty();
    if (any) {
      byte = to_drive.front();
      to_drive.pop_front();
    }
    if (went_) taken_ = 0;
    watch_.read(any, any ? byte : uint8_t{0});
    return any;
  }
  bool write(uint8_t byte) override {
    went_ = !stuck || taken_ < 2;
    if (went_) ++taken_;
    watch_.written(went_, byte);
    return went_;
  }

 private:
  testing::ClientWatch& watch_;
  size_t taken_ = 0;
  bool went_ = true;
};

// Follows while enabled; loses feedbacks when told.
struct Servo final : hal::ServoPort {
  explicit Servo(testing::ClientWatch& watch) : watch_(watch) {}
  int64_t position = 0;
  int64_t encoder_off = 0;
  uint16_t sequence = 0;
  bool valid = true;
  bool blocked = false;
  bool commit = true;

  void disable() override { watch_.disabled(); }
  hal::ServoFeedback exchange(const hal::ServoCommand& command) override {
    watch_.commanded(command, position + encoder_off);
    if (command.enabled && !blocked) position = command.setpoint;
    return {position + encoder_off, 0, ++sequence, valid, commit};
  }

 private:
  testing::ClientWatch& watch_;
};

struct Dog final : hal::Watchdog {
  void feed() override {}
};

void no_restart() {}

struct Rig {
  testing::ClientWatch watch;
  Axis<firmware::kLineCapacity> axis = {};
  firmware::Application drive = {};
  TuneMemory tune_memory = {};
  firmware::FaultMemory faults = {};
  Servo servo{watch};
  Line line{watch};
  Dog dog;
  testing::FlashModel flash;
  uint32_t ticks_left = 6000;  // a programme's length is bounded, or the fuzzer would only wait

  Rig() {
    if (!axis.configure(firmware::kDefaultAxis).ok()) std::abort();
    drive.begin(axis, {&servo, &line, &dog, &faults, &tune_memory, &flash, no_restart});
  }

  void step(uint32_t ticks, bool linked) {
    for (; ticks != 0 && ticks_left != 0; --ticks, --ticks_left) {
      if (linked) drive.tick();
      drive.own_timer_tick();
      drive.poll();
      drive.poll();
      if (watch.broken() == nullptr) continue;
      std::fprintf(stderr, "invariant broken: %s\n", watch.broken());
      std::abort();
    }
  }
};

using Frame = std::vector<uint8_t>;

void send(Rig& rig, const Frame& body, uint16_t crc_error = 0) {
  uint16_t crc = firmware::kCrc16Initial;
  for (const uint8_t byte : body) {
    crc = firmware::crc16_update(crc, byte);
    rig.line.to_drive.push_back(byte);
  }
  crc = static_cast<uint16_t>(crc ^ crc_error);
  rig.line.to_drive.push_back(static_cast<uint8_t>(crc));
  rig.line.to_drive.push_back(static_cast<uint8_t>(crc >> 8));
  rig.step(6 + static_cast<uint32_t>(body.size()) / 64, true);
}

void append(Frame& frame, uint32_t word) {
  frame.push_back(static_cast<uint8_t>(word >> 8));
  frame.push_back(static_cast<uint8_t>(word));
}

Frame single(uint8_t unit, uint32_t address, uint32_t word) {
  Frame frame{unit, 6};
  append(frame, address);
  append(frame, word);
  return frame;
}

Frame multiple(uint8_t unit, uint32_t address, const std::vector<uint32_t>& words) {
  Frame frame{unit, 16};
  append(frame, address);
  append(frame, static_cast<uint32_t>(words.size()));
  frame.push_back(static_cast<uint8_t>(2 * words.size()));
  for (const uint32_t word : words) append(frame, word);
  return frame;
}

Frame wide(uint8_t unit, uint32_t address, uint32_t value) {
  return multiple(unit, address, {value >> 16, value & 0xFFFF});
}

// What can be written, so that the fuzzer need not find it bit by bit.
constexpr uint16_t kRegisters[] = {
    0x0014, 0x0020, 0x0021, 0x0022, 0x0023, 0x0040, 0x0042, 0x0044, 0x0052, 0x0056, 0x0058, 0x005A, 0x005C,
    0x0060, 0x0062, 0x0064, 0x0066, 0x0068, 0x006A, 0x006C, 0x006E, 0x0070, 0x0072, 0x0074, 0x0076, 0x0078,
    0x0079, 0x0080, 0x0088, 0x0089, 0x0090, 0x0100, 0x0101, 0x0102, 0x0104, 0x0105, 0x0106, 0x0107, 0x010A,
    0x010C, 0x010E, 0x0130, 0x0137, 0x0138, 0x0200, 0x0201, 0x0202, 0x0204, 0x0206, 0x0207, 0x020C, 0x020E,
    0x0250, 0x0300, 0x0302, 0x0303, 0x0304, 0x0306, 0x0307, 0x0308, 0x030A, 0x030B, 0x030C, 0x030D, 0x0311};
constexpr size_t kRegisterCount = sizeof(kRegisters) / sizeof(kRegisters[0]);
constexpr size_t kRecord = 8;

enum Operation : uint8_t {
  kStep,
  kLongStep,
  kSilence,
  kRaw,
  kCollect,
  kSendCollected,
  kSingle,
  kWide,
  kMask,
  kReadWrite,
  kBroadcast,
  kRead,
  kEnable,
  kControl,
  kKey,
  kTrouble,
  kMode,
  kStreamPoints,
  kMove,
  kVelocity,
  kTune,
  kDiagnostics,
  kIdentify,
  kBadCrc,
  kShaper,
  kOtherUnit,
  kOperations
};

class Programme {
 public:
  explicit Programme(Rig& rig) : rig_(rig) {}

  void run(const uint8_t* record) {
    const auto operation = static_cast<uint8_t>(record[0] % kOperations);
    const uint8_t a = record[1];
    const uint32_t register_a = kRegisters[a % kRegisterCount];
    const uint32_t first = (uint32_t{record[2]} << 8) | record[3];
    const uint32_t second = (uint32_t{record[4]} << 8) | record[5];
    const uint32_t both = (first << 16) | second;
    switch (operation) {
      case kStep: rig_.step(1U + a % 32U, true); break;
      case kLongStep: rig_.step(8U * a, true); break;
      case kSilence: rig_.step(8U * a, false); break;
      case kRaw:
        for (uint32_t i = 0; i < 6; ++i) rig_.line.to_drive.push_back(record[2 + i]);
        break;
      case kCollect:
        for (uint32_t i = 0; i < 6 && collected_.size() < 300; ++i) collected_.push_back(record[2 + i]);
        break;
      case kSendCollected:
        collected_.insert(collected_.begin(), {a, record[2]});
        send(rig_, collected_);
        collected_.clear();
        break;
      case kSingle: send(rig_, single(1, register_a, first)); break;
      case kWide: send(rig_, wide(1, register_a, both)); break;
      case kMask: {
        Frame frame{1, 22};
        for (const uint32_t word : {register_a, first, second}) append(frame, word);
        send(rig_, frame);
        break;
      }
      case kReadWrite: {
        Frame frame{1, 23};
        for (const uint32_t word : {first, second % 128, register_a, uint32_t{record[6]} % 2U + 1U})
          append(frame, word);
        frame.push_back(static_cast<uint8_t>(2 * (record[6] % 2 + 1)));
        for (uint32_t i = 0; i <= record[6] % 2U; ++i) append(frame, record[7]);
        send(rig_, frame);
        break;
      }
      case kBroadcast: send(rig_, record[6] % 2 == 0 ? single(0, register_a, first) : wide(0, register_a, both)); break;
      default: run_more(operation, record, register_a, first, second); break;
    }
  }

 private:
  void run_more(uint8_t operation, const uint8_t* record, uint32_t register_a, uint32_t first, uint32_t second) {
    const uint8_t a = record[1];
    switch (operation) {
      case kRead: {
        Frame frame{1, static_cast<uint8_t>(3 + record[6] % 2)};
        append(frame, record[7] % 2 == 0 ? first : register_a);
        append(frame, second % 130);
        send(rig_, frame);
        break;
      }
      case kEnable:
        for (const uint32_t word : {0x06U, 0x07U, 0x0FU}) send(rig_, single(a % 8 == 7 ? 0 : 1, 0x0040, word));
        break;
      case kControl: send(rig_, single(1, 0x0040, (first & 0xFF00) | a)); break;
      case kKey: {
        constexpr uint32_t kKeys[] = {0x554E, 0x5341, 0x4C44, 0x5253};
        send(rig_, single(1, 0x0014, kKeys[a % 4]));
        break;
      }
      case kTrouble:
        rig_.servo.valid = (a & 1) == 0;
        rig_.line.stuck = (a & 2) != 0;
        rig_.flash.dead = (a & 4) != 0;
        rig_.servo.blocked = (a & 8) != 0;
        rig_.servo.commit = (a & 16) == 0;
        if ((a & 32) != 0) rig_.servo.encoder_off += int64_t{record[2]} << 40;
        break;
      case kMode: {
        constexpr uint32_t kModes[] = {1, 3, 6, 8};
        send(rig_, single(1, 0x0042, kModes[a % 4]));
        break;
      }
      default: run_motion(operation, record, register_a, first, second); break;
    }
  }

  void run_motion(uint8_t operation, const uint8_t* record, uint32_t register_a, uint32_t first, uint32_t second) {
    const uint8_t a = record[1];
    const auto signed_first = static_cast<int32_t>(static_cast<int16_t>(first));
    switch (operation) {
      case kStreamPoints: {
        // From where it stands, if it does.
        const auto stands = static_cast<uint32_t>((rig_.servo.position + (int64_t{1} << 31)) >> 32);
        std::vector<uint32_t> words;
        for (uint32_t i = 0; i <= a % 16U; ++i) {
          const uint32_t position = stands + i * static_cast<uint32_t>(signed_first);
          words.push_back(position >> 16);
          words.push_back(position & 0xFFFF);
        }
        send(rig_, multiple(1, 0x0090, words));
        break;
      }
      case kMove:
        send(rig_, wide(1, 0x0044, static_cast<uint32_t>(signed_first * 16)));
        send(rig_, single(1, 0x0040, 0x1FU | (a & 0x60U)));
        if ((a & 1) != 0) send(rig_, single(1, 0x0040, 0x0F));
        break;
      case kVelocity: send(rig_, wide(1, 0x0052, static_cast<uint32_t>(signed_first * 64))); break;
      case kTune: send(rig_, single(1, 0x0200, a % 6U)); break;
      case kDiagnostics: {
        Frame frame{1, 8};
        append(frame, a % 24U);
        append(frame, first);
        send(rig_, frame);
        break;
      }
      case kIdentify: send(rig_, {1, 43, record[2], record[3], record[4]}); break;
      case kBadCrc: send(rig_, single(1, register_a, first), static_cast<uint16_t>(second | 1)); break;
      case kShaper: {
        const uint32_t frequency = 5000U + 40U * first;
        send(rig_, multiple(1, 0x0102, {frequency >> 16, frequency & 0xFFFF, second % 30001, 0, a % 14U, 0, 0, 0}));
        send(rig_, single(1, 0x0100, 1));
        send(rig_, single(1, 0x0130, 1U + record[6] % 3U));
        break;
      }
      default: send(rig_, single(static_cast<uint8_t>(a | 2), 0x0040, first)); break;  // another unit's
    }
  }

  Rig& rig_;
  Frame collected_;
};

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
