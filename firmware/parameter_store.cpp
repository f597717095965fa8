// SPDX-License-Identifier: Apache-2.0
#include "firmware/parameter_store.hpp"

#include "firmware/crc32.hpp"

namespace stillpoint::firmware {
namespace {

constexpr uint32_t kHeaderWords = 3;
constexpr uint32_t kKeyOfSetInForce = ShaperSettings::kSetInForce << 16 | address_of(Register::kShaperSet);

// Words can be counted without memory, then programmed.
struct Writer {
  hal::Nonvolatile* memory;
  size_t page;
  uint32_t words;
  uint32_t crc;
  bool good;

  void put(uint32_t word) {
    if (memory != nullptr) good = good && memory->program(page, 4 * words, word);
    crc = crc32_update(crc, word);
    ++words;
  }
};

void put_parameters(const Parameters& parameters, const ShaperSettings& shaper, Writer& writer) {
  for (size_t i = 0; i < kParameterCount; ++i) {
    if (!stored(kParameters[i])) continue;
    const uint32_t sets = of_shaper_set(kParameters[i]) ? kShaperSets + (shaper.shapes() ? 1U : 0U) : 1;
    for (uint32_t set = 0; set < sets; ++set) {
      writer.put(set << 16 | address_of(kParameters[i].name));
      writer.put(sets == 1 ? parameters.value(i) : shaper.staged(set, kParameters[i].name));
    }
  }
  if (!shaper.shapes()) return;
  writer.put(kKeyOfSetInForce);
  writer.put(shaper.set_in_force());
}

void take_entry(uint32_t key, uint32_t value, Parameters& parameters, ShaperSettings& shaper, uint32_t& in_force) {
  const size_t index = find_parameter(static_cast<uint16_t>(key));
  const uint32_t set = key >> 16;
  const Parameter parameter = kParameters[index == kNoParameter ? 0 : index];  // 0, which is not stored, for none
  const bool of_set = of_shaper_set(parameter);
  const bool known =
      stored(parameter) && address_of(parameter.name) == (key & 0xFFFFU) && set <= (of_set ? kShaperSets : 0);
  uint32_t accepted = value;
  const bool good = (known || key == kKeyOfSetInForce) && in_range(parameter, parameter.maximum, value, accepted);
  // What is less than a mode may be is what a client may ask for; the auto-tune may have found it.
  if (!good && !(parameter.unused_or_more() && accepted > value)) {
    parameters.note_out_of_range(static_cast<Register>(key & 0xFFFFU), value, accepted);
  } else if (of_set) {
    shaper.stage(set, parameter.name, value);
  } else if (known) {
    parameters.set_value(index, value);
  } else {
    in_force = value;
  }
}

bool newer(uint32_t sequence, uint32_t than) { return static_cast<int32_t>(sequence - than) > 0; }

}  // namespace

bool stored(const Parameter& parameter) {
  return parameter.access == Access::kReadWrite && parameter.effect != Effect::kControlword &&
         parameter.effect != Effect::kShaperSet && parameter.name != Register::kTargetPosition &&
         parameter.name != Register::kTargetVelocity && parameter.minimum != parameter.maximum;
}

bool of_shaper_set(const Parameter& parameter) {
  const uint32_t address = address_of(parameter.name);
  return address == address_of(Register::kModeCount) ||
         (address >= address_of(Register::kFirstMode) &&
          address < address_of(Register::kFirstMode) + kMaxModes * kModeStride);
}

bool ParameterStore::word_at(size_t page, uint32_t index, uint32_t& word) const {
  uint8_t bytes[4];
  if (!memory_->read(page, 4 * index, bytes, sizeof bytes)) return false;
  word = uint32_t{bytes[3]} << 24 | uint32_t{bytes[2]} << 16 | uint32_t{bytes[1]} << 8 | bytes[0];
  return true;
}

// Magic 0 where nothing has been begun.
void ParameterStore::inspect(size_t page, Header& header) const {
  header = {};
  if (memory_ == nullptr || page >= memory_->page_count() || !word_at(page, 0, header.magic)) return;
  if (header.magic != kImageMagic) {
    header.magic = 0;
    return;
  }
  if (!word_at(page, 1, header.kind) || !word_at(page, 2, header.sequence)) return;
  const uint32_t end = kHeaderWords + header.payload_words();
  if (4 * (end + 1) > memory_->page_bytes()) return;
  uint32_t crc = kCrc32Initial;
  uint32_t word = 0;
  for (uint32_t i = 0; i < end; ++i) {
    if (!word_at(page, i, word)) return;
    crc = crc32_update(crc, word);
  }
  header.whole = word_at(page, end, word) && word == ~crc;
}

// The image that a start takes, or else the newest whole one: what must outlive a save. Any, where none is whole.
[[gnu::noinline]] size_t ParameterStore::page_to_keep(Header (&images)[kPages]) const {
  for (size_t page = 0; page < kPages; ++page) inspect(page, images[page]);
  const int ahead = images[0].rank() - images[1].rank();
  return ahead > 0 || (ahead == 0 && newer(images[0].sequence, images[1].sequence)) ? 0 : 1;
}

Loaded ParameterStore::load(Parameters& parameters, ShaperSettings& shaper) const {
  Header images[kPages];
  const size_t best = page_to_keep(images);
  const Header& newest = images[best];
  const Header& other = images[1 - best];
  if (!newest.whole) return (newest.magic | other.magic) != 0 ? Loaded::kBad : Loaded::kNothing;
  if (!newest.known()) return Loaded::kUnknownVersion;
  uint32_t key = 0;
  uint32_t value = 0;
  uint32_t in_force = 0;
  for (uint32_t i = kHeaderWords; i + 1 < kHeaderWords + newest.payload_words(); i += 2) {
    if (word_at(best, i, key) && word_at(best, i + 1, value)) take_entry(key, value, parameters, shaper, in_force);
  }
  shaper.restore(in_force);
  return other.whole && newer(other.sequence, newest.sequence) ? Loaded::kOlderImage : Loaded::kImage;
}

bool ParameterStore::save(const Parameters& parameters, const ShaperSettings& shaper) {
  if (memory_ == nullptr || memory_->page_count() < kPages) return false;
  Header images[kPages];
  const size_t kept = page_to_keep(images);
  const size_t page = 1 - kept;
  const uint32_t sequence = images[kept].whole ? images[kept].sequence + 1 : 0;
  Writer count = {};
  put_parameters(parameters, shaper, count);
  if (4 * (kHeaderWords + count.words + 1) > memory_->page_bytes() || !memory_->erase(page)) return false;
  Writer writer = {memory_, page, 0, kCrc32Initial, true};
  writer.put(kImageMagic);
  writer.put(uint32_t{kImageVersion} << 16 | count.words);
  writer.put(sequence);
  put_parameters(parameters, shaper, writer);
  writer.put(~writer.crc);
  Header& written = images[page];
  inspect(page, written);
  return writer.good && written.whole && written.sequence == sequence;
}

}  // namespace stillpoint::firmware
