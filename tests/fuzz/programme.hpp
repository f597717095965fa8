// SPDX-License-Identifier: Apache-2.0
// A programme of records of eight bytes: what the line carries, with a good CRC, a bad one or none, what goes wrong,
// and for how long time goes on.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include <vector>

#include "firmware/crc16.hpp"
#include "tests/fuzz/rig.hpp"

namespace stillpoint::testing {

using Frame = std::vector<uint8_t>;

inline void send(Rig& rig, const Frame& body, uint16_t crc_error = 0) {
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

inline void append(Frame& frame, uint32_t word) {
  frame.push_back(static_cast<uint8_t>(word >> 8));
  frame.push_back(static_cast<uint8_t>(word));
}

inline Frame single(uint8_t unit, uint32_t address, uint32_t word) {
  Frame frame{unit, 6};
  append(frame, address);
  append(frame, word);
  return frame;
}

inline Frame multiple(uint8_t unit, uint32_t address, const std::vector<uint32_t>& words) {
  Frame frame{unit, 16};
  append(frame, address);
  append(frame, static_cast<uint32_t>(words.size()));
  frame.push_back(static_cast<uint8_t>(2 * words.size()));
  for (const uint32_t word : words) append(frame, word);
  return frame;
}

inline Frame wide(uint8_t unit, uint32_t address, uint32_t value) {
  return multiple(unit, address, {value >> 16, value & 0xFFFF});
}

// What can be written, so that the fuzzer need not find it bit by bit.
constexpr uint16_t kRegisters[] = {
    0x0014, 0x0020, 0x0021, 0x0022, 0x0023, 0x0040, 0x0042, 0x0044, 0x0052, 0x0056, 0x0058, 0x005A, 0x005C, 0x0060,
    0x0062, 0x0064, 0x0066, 0x0068, 0x006A, 0x006C, 0x006E, 0x0070, 0x0072, 0x0074, 0x0076, 0x0078, 0x0079, 0x0080,
    0x0088, 0x0089, 0x0090, 0x0100, 0x0101, 0x0102, 0x0104, 0x0105, 0x0106, 0x0107, 0x010A, 0x010C, 0x010E, 0x0130,
    0x0137, 0x0138, 0x0200, 0x0201, 0x0202, 0x0204, 0x0206, 0x0207, 0x020C, 0x020E, 0x0248, 0x0249, 0x0250, 0x0300,
    0x0302, 0x0303, 0x0304, 0x0306, 0x0307, 0x0308, 0x030A, 0x030B, 0x030C, 0x030D, 0x0311};
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
  kSoftLimits,
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
      case kOtherUnit: send(rig_, single(static_cast<uint8_t>(a | 2), 0x0040, first)); break;
      default: {
        const auto low = static_cast<uint32_t>(-static_cast<int32_t>(8U * first));
        send(rig_, single(1, 0x0014, 0x554E));
        send(rig_, multiple(1, 0x0074, {low >> 16, low & 0xFFFF, 8U * second >> 16, 8U * second & 0xFFFF}));
        break;
      }
    }
  }

  Rig& rig_;
  Frame collected_;
};

}  // namespace stillpoint::testing
