// SPDX-License-Identifier: Apache-2.0
// The typed table of everything a client can read or write, and the values. One source for the register map, and later
// for the stored image and the documentation.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "firmware/registers.hpp"
#include "shaper/axis/axis_config.hpp"

namespace stillpoint::firmware {

// 1000 counts/s^3 a unit of the jerk registers.
constexpr double kJerkUnit = 1000.0;

enum class Type : uint8_t { kU16, kI16, kU32, kI32 };
enum class Access : uint8_t { kRead, kReadWrite, kWrite };
enum class Lock : uint8_t { kOpen, kNeedsKey };

// What else happens when a value is written; nothing for most.
enum class Effect : uint8_t {
  kNone,
  kControlword,
  kCommandKey,
  kApplyShaper,
  kAxisLimits,
  kWatch,
  kVelocity,
  kShaperSet,
  kTune,
  kScope
};

struct Parameter {
  Register name;
  Type type;
  Access access;
  Lock lock;
  Effect effect;
  Register ceiling;  // the parameter whose value is this one's maximum, or kNoRegister
  uint32_t minimum;  // these three are the type's own bits
  uint32_t maximum;
  uint32_t initial;
  // Bit v: minimum + v is a value that this firmware can do; 0: all in the range are. Of a range of more than 32
  // values: besides 0, for unused, those from this one on.
  uint32_t allowed;

  constexpr uint32_t words() const { return type == Type::kU32 || type == Type::kI32 ? 2 : 1; }
  constexpr bool is_signed() const { return type == Type::kI16 || type == Type::kI32; }
  constexpr bool unused_or_more() const { return allowed != 0 && maximum - minimum >= 32; }
  constexpr bool readable() const { return access != Access::kWrite; }
  constexpr bool writable() const { return access != Access::kRead; }
};

constexpr size_t kParameterCount = 192;
constexpr size_t kNoParameter = kParameterCount;

// What people are told of one.
struct ParameterText {
  const char* text;
  const char* unit;
  uint16_t object;  // of CiA 402, or 0
};

// Sorted by address. A parameter is put together when asked for: many differ in name alone, and what they have in
// common is in the image once.
struct ParameterTable {
  class Iterator {
   public:
    constexpr explicit Iterator(size_t index) : index_(index) {}
    Parameter operator*() const { return ParameterTable{}[index_]; }
    Iterator& operator++() {
      ++index_;
      return *this;
    }
    bool operator!=(Iterator other) const { return index_ != other.index_; }

   private:
    size_t index_;
  };

  Parameter operator[](size_t index) const;
  Iterator begin() const { return Iterator(0); }
  Iterator end() const { return Iterator(kParameterCount); }
};

constexpr ParameterTable kParameters{};

// The parameter that `address` belongs to (as its only, its high or its low word), or kNoParameter. O(log n).
size_t find_parameter(uint16_t address);

// Apart from the table: an image that shows the texts to nobody does not have them. `parameter` is one of kParameters.
const ParameterText& text_of(const Parameter& parameter);

// Whether `value` (the type's bits; a 16-bit signed one sign-extended) lies in [minimum, ceiling] and is allowed;
// otherwise `accepted` is the nearest bound (the least that is used, where 0 is unused), or `value` itself where a
// value within the bounds is not available.
bool in_range(const Parameter& parameter, uint32_t ceiling, uint32_t value, uint32_t& accepted);

// The values. Background only. Zero-initialised storage is valid; load_defaults makes it meaningful.
class Parameters {
 public:
  void load_defaults();
  // Takes the axis's maxima and quick stop, rounded down to whole registers, and lowers the profile to them.
  void adopt(const AxisConfig& config);

  // Lowers what a move and a quick stop may ask for to what the axis may: every parameter with a ceiling. One that was
  // above it, or kNoRegister.
  Register lower_to_ceilings();

  uint32_t value(size_t index) const { return values_[index]; }
  void set_value(size_t index, uint32_t value) { values_[index] = value; }

  uint32_t get(Register name) const;
  int32_t get_signed(Register name) const { return static_cast<int32_t>(get(name)); }
  void set(Register name, uint32_t value);
  void set_signed(Register name, int32_t value) { set(name, static_cast<uint32_t>(value)); }

  // Registers 0012, 0013 and 0016: why something was not done. `accepted` is in the unit of `culprit`, 0 for none.
  void note_refusal(uint16_t reason, uint16_t culprit, uint32_t accepted = 0);
  // As in_range refuses it.
  void note_out_of_range(Register culprit, uint32_t value, uint32_t accepted);

 private:
  void adopt_one(Register name, double value);

  uint32_t values_[kParameterCount] = {};
};

}  // namespace stillpoint::firmware
