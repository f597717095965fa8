// SPDX-License-Identifier: Apache-2.0
#include "firmware/parameter_entries.hpp"
#include "firmware/parameters.hpp"

namespace stillpoint::firmware {
namespace {

using entries::Entry;
using entries::kTable;

constexpr bool are_alike(const Parameter& a, const Parameter& b) {
  return a.type == b.type && a.access == b.access && a.lock == b.lock && a.effect == b.effect &&
         a.ceiling == b.ceiling && a.minimum == b.minimum && a.maximum == b.maximum && a.initial == b.initial &&
         a.allowed == b.allowed;
}

// Of the first that is like it.
constexpr size_t like(size_t index) {
  size_t first = 0;
  while (!are_alike(kTable[first], kTable[index])) ++first;
  return first;
}

constexpr size_t count_kinds() {
  size_t count = 0;
  for (size_t i = 0; i < kParameterCount; ++i) count += like(i) == i ? 1U : 0U;
  return count;
}

constexpr size_t kKindCount = count_kinds();
static_assert(kKindCount <= UINT8_MAX + 1);

// The numbers of the table, each once.
struct Numbers {
  size_t count;
  uint32_t of[4 * kParameterCount];

  // A new one is added.
  constexpr uint8_t place_of(uint32_t number) {
    size_t place = 0;
    while (place < count && of[place] != number) ++place;
    if (place == count) of[count++] = number;
    return static_cast<uint8_t>(place);
  }
};

// A parameter without its name, its numbers by their places.
struct Kind {
  Type type;
  Access access;
  Lock lock;
  Effect effect;
  Register ceiling;
  uint8_t minimum;
  uint8_t maximum;
  uint8_t initial;
  uint8_t allowed;
};

constexpr Kind kind_of(const Parameter& parameter, Numbers& numbers) {
  return {parameter.type,
          parameter.access,
          parameter.lock,
          parameter.effect,
          parameter.ceiling,
          numbers.place_of(parameter.minimum),
          numbers.place_of(parameter.maximum),
          numbers.place_of(parameter.initial),
          numbers.place_of(parameter.allowed)};
}

constexpr Numbers all_numbers() {
  Numbers numbers{};
  for (const Entry& entry : kTable) kind_of(entry, numbers);
  return numbers;
}

constexpr Numbers kNumbers = all_numbers();
static_assert(kNumbers.count <= UINT8_MAX + 1);

struct Rows {
  Register name[kParameterCount];
  uint8_t kind[kParameterCount];
  Kind kinds[kKindCount];
  uint32_t numbers[kNumbers.count];
};

constexpr Rows by_kind() {
  Rows rows{};
  Numbers numbers = kNumbers;
  size_t count = 0;
  for (size_t i = 0; i < kParameterCount; ++i) {
    rows.name[i] = kTable[i].name;
    if (like(i) == i) {
      rows.kinds[count] = kind_of(kTable[i], numbers);
      rows.kind[i] = static_cast<uint8_t>(count++);
    } else {
      rows.kind[i] = rows.kind[like(i)];
    }
  }
  for (size_t i = 0; i < kNumbers.count; ++i) rows.numbers[i] = kNumbers.of[i];
  return rows;
}

constexpr Rows kRows = by_kind();

struct Texts {
  ParameterText of[kParameterCount];
};

constexpr Texts texts() {
  Texts table{};
  for (size_t i = 0; i < kParameterCount; ++i) table.of[i] = kTable[i].told;
  return table;
}

constexpr Texts kTexts = texts();

constexpr bool addresses_rise_without_overlap() {
  for (size_t i = 1; i < kParameterCount; ++i) {
    if (address_of(kTable[i].name) < address_of(kTable[i - 1].name) + kTable[i - 1].words()) return false;
  }
  return true;
}

constexpr bool wide_values_are_even() {
  for (size_t i = 0; i < kParameterCount; ++i) {
    if (kTable[i].words() == 2 && address_of(kTable[i].name) % 2 != 0) return false;
  }
  return true;
}

static_assert(addresses_rise_without_overlap(), "find_parameter searches by halves; kParameterCount is their number");
static_assert(wide_values_are_even(), "a promise of the register map");

}  // namespace

Parameter ParameterTable::operator[](size_t index) const {
  const Kind& kind = kRows.kinds[kRows.kind[index]];
  const uint32_t* const numbers = kRows.numbers;
  return {kRows.name[index],     kind.type,
          kind.access,           kind.lock,
          kind.effect,           kind.ceiling,
          numbers[kind.minimum], numbers[kind.maximum],
          numbers[kind.initial], numbers[kind.allowed]};
}

const ParameterText& text_of(const Parameter& parameter) {
  return kTexts.of[find_parameter(address_of(parameter.name))];
}

size_t find_parameter(uint16_t address) {
  size_t low = 0;
  size_t high = kParameterCount;
  while (high - low > 1) {
    const size_t middle = (low + high) / 2;
    if (address_of(kRows.name[middle]) <= address) {
      low = middle;
    } else {
      high = middle;
    }
  }
  const Parameter found = kParameters[low];
  const bool covered = address >= address_of(found.name) && address < address_of(found.name) + found.words();
  return covered ? low : kNoParameter;
}

}  // namespace stillpoint::firmware
