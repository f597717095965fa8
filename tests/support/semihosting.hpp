// SPDX-License-Identifier: Apache-2.0
// Arm semihosting (Thumb, M profile), for test images only: BKPT 0xAB is a fault where no debugger or emulator
// listens, so nothing under firmware/ may include this. Operations as in Arm's "Semihosting for AArch32 and AArch64".
// Runs under `qemu-system-arm -semihosting-config enable=on,target=native`; relative paths start at QEMU's working
// directory. Every call stops the virtual processor until the host has done it, so under -icount no time passes.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace stillpoint::semihosting {

enum class Operation : uint32_t {
  kOpen = 0x01,
  kClose = 0x02,
  kWrite0 = 0x04,
  kWrite = 0x05,
  kRead = 0x06,
  kExitExtended = 0x20
};

// fopen's modes, as numbered by the specification.
enum class Mode : uint32_t { kReadBinary = 1, kWriteBinary = 5, kAppendBinary = 9 };

constexpr int32_t kNoHandle = -1;

inline int32_t call(Operation operation, const void* argument) {
  register uint32_t r0 __asm__("r0") = static_cast<uint32_t>(operation);
  register const void* r1 __asm__("r1") = argument;
  __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return static_cast<int32_t>(r0);
}

inline uint32_t length_of(const char* text) {
  uint32_t length = 0;
  while (text[length] != '\0') ++length;
  return length;
}

inline uint32_t address_of(const void* pointer) { return static_cast<uint32_t>(reinterpret_cast<uintptr_t>(pointer)); }

// A handle, or kNoHandle. Opening a FIFO waits for its other end, for ever.
inline int32_t open(const char* path, Mode mode) {
  const uint32_t block[3] = {address_of(path), static_cast<uint32_t>(mode), length_of(path)};
  return call(Operation::kOpen, block);
}

inline void close(int32_t handle) {
  const uint32_t block[1] = {static_cast<uint32_t>(handle)};
  call(Operation::kClose, block);
}

// Waits until at least one byte is there; returns how many came, 0 at the end of the file or on an error.
inline size_t read_some(int32_t handle, void* to, size_t bytes) {
  const uint32_t block[3] = {static_cast<uint32_t>(handle), address_of(to), static_cast<uint32_t>(bytes)};
  const int32_t missing = call(Operation::kRead, block);
  return missing < 0 || static_cast<size_t>(missing) > bytes ? 0 : bytes - static_cast<size_t>(missing);
}

// Waits for all of it. False at the end of the file.
inline bool read(int32_t handle, void* to, size_t bytes) {
  uint8_t* next = static_cast<uint8_t*>(to);
  while (bytes > 0) {
    const size_t got = read_some(handle, next, bytes);
    if (got == 0) return false;
    next += got;
    bytes -= got;
  }
  return true;
}

// False when not all of it was taken.
inline bool write(int32_t handle, const void* from, size_t bytes) {
  const uint32_t block[3] = {static_cast<uint32_t>(handle), address_of(from), static_cast<uint32_t>(bytes)};
  return call(Operation::kWrite, block) == 0;
}

// To the emulator's console (its standard error, or the -semihosting-config chardev).
inline void write0(const char* text) { call(Operation::kWrite0, text); }

// Ends the emulator with this exit status.
[[noreturn]] inline void exit(uint32_t code) {
  const uint32_t block[2] = {0x20026, code};  // ADP_Stopped_ApplicationExit
  for (;;) call(Operation::kExitExtended, block);
}

}  // namespace stillpoint::semihosting
