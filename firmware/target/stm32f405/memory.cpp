// SPDX-License-Identifier: Apache-2.0
// The functions that the compiler calls on its own, for images without a C library; and one of its own library that it
// has in 700 bytes.
#include <stddef.h>
#include <stdint.h>

// Or GCC would turn each loop back into a call of the function it is in.
#pragma GCC optimize("no-tree-loop-distribute-patterns")

namespace {

using Word = uint32_t __attribute__((may_alias));  // objects of any type are copied through it

uintptr_t address(const void* pointer) { return reinterpret_cast<uintptr_t>(pointer); }

bool word_aligned(uintptr_t bits) { return bits % sizeof(Word) == 0; }

}  // namespace

extern "C" {

void* memcpy(void* to, const void* from, size_t bytes);
void* memmove(void* to, const void* from, size_t bytes);
void* memset(void* to, int value, size_t bytes);
uint64_t __udivmoddi4(uint64_t dividend, uint64_t divisor, uint64_t* remainder);

void* memcpy(void* to, const void* from, size_t bytes) {
  uint8_t* out = static_cast<uint8_t*>(to);
  const uint8_t* in = static_cast<const uint8_t*>(from);
  if (word_aligned(address(out) | address(in))) {
    for (; bytes >= sizeof(Word); bytes -= sizeof(Word), out += sizeof(Word), in += sizeof(Word)) {
      *static_cast<Word*>(static_cast<void*>(out)) = *static_cast<const Word*>(static_cast<const void*>(in));
    }
  }
  for (; bytes > 0; --bytes) *out++ = *in++;
  return to;
}

void* memmove(void* to, const void* from, size_t bytes) {
  if (address(to) <= address(from)) return memcpy(to, from, bytes);  // which goes upwards
  uint8_t* out = static_cast<uint8_t*>(to);
  const uint8_t* in = static_cast<const uint8_t*>(from);
  while (bytes > 0) {
    --bytes;
    out[bytes] = in[bytes];
  }
  return to;
}

void* memset(void* to, int value, size_t bytes) {
  uint8_t* out = static_cast<uint8_t*>(to);
  const Word word = static_cast<uint8_t>(value) * 0x01010101u;
  if (word_aligned(address(out))) {
    for (; bytes >= sizeof(Word); bytes -= sizeof(Word), out += sizeof(Word)) {
      *static_cast<Word*>(static_cast<void*>(out)) = word;
    }
  }
  for (; bytes > 0; --bytes) *out++ = static_cast<uint8_t>(value);
  return to;
}

// What every division of 64 bits ends in. Background only; 600 instructions.
uint64_t __udivmoddi4(uint64_t dividend, uint64_t divisor, uint64_t* remainder) {
  uint64_t rest = 0;
  for (int bit = 0; bit < 64; ++bit) {
    const bool carries = (rest >> 63) != 0;
    rest = (rest << 1) | (dividend >> 63);
    dividend <<= 1;
    if (carries || rest >= divisor) {
      rest -= divisor;
      dividend |= 1;  // the quotient comes in where the dividend goes out
    }
  }
  if (remainder != nullptr) *remainder = rest;
  return dividend;
}

}  // extern "C"
