// SPDX-License-Identifier: Apache-2.0
// The test image: the firmware as it is, from start-up to Application, with the two serial lines replaced by two FIFOs
// that semihosting reads and writes (see sim/hil/campaign_record.hpp). The virtual processor stands while it waits for
// the host, so a campaign is repeatable to the bit, and an order faster than the serial lines.
//
// Two paces, chosen by the first record:
//   - lock: main reads a record, ticks, lets the background run, answers. With `-icount shift=0` TIM2 counts one an
//     instruction; what it counts over Application::tick goes into the answer.
//   - free SysTick: the chip's millisecond runs on, its handler ticks, and main is the background, interrupted
//     anywhere. A tick that has not ended when the next is due is counted.
//
// For the emulator only: no watchdog, no clock set-up, and a breakpoint instruction in every tick.
#include <stddef.h>
#include <stdint.h>

#include "firmware/application.hpp"
#include "firmware/default_axis.hpp"
#include "firmware/servo_link.hpp"
#include "firmware/target/stm32f405/registers.hpp"
#include "firmware/target/stm32f405/systick.hpp"
#include "shaper/axis/axis.hpp"
#include "shaper/base/ring_buffer.hpp"
#include "sim/hil/campaign_record.hpp"
#include "tests/support/semihosting.hpp"

namespace {

using namespace stillpoint;

constexpr uint32_t kCoreHz = 168000000;
constexpr uint32_t kPollsPerTick = 2;  // one may take a request, the next its answer

// TIM2's counter (RM0090 18.4). Its registers need no set-up in the emulator: prescaler 0, always counting.
uint32_t timer_counts() { return *reinterpret_cast<volatile uint32_t*>(0x40000024); }

struct Lines {
  sim::CampaignToChip in = {};
  sim::CampaignFromChip out = {};
  hal::ServoFeedback feedback = {};
  RingBuffer<uint8_t, 256> client_received = {};
  RingBuffer<uint8_t, 256> client_to_send = {};
  int32_t in_handle = 0;
  int32_t out_handle = 0;
  uint32_t late_ticks = 0;
  uint32_t counting_cost = 0;
};

class RecordPort final : public hal::ServoPort {
 public:
  explicit constexpr RecordPort(Lines& lines) : lines_(lines) {}
  void disable() override {}
  hal::ServoFeedback exchange(const hal::ServoCommand& command) override {
    servo_link::encode_reply({command, lines_.feedback.sequence}, lines_.out.reply);
    return lines_.feedback;
  }

 private:
  Lines& lines_;
};

class RecordStream final : public hal::ByteStream {
 public:
  explicit constexpr RecordStream(Lines& lines) : lines_(lines) {}
  bool read(uint8_t& byte) override { return lines_.client_received.pop(byte); }
  bool write(uint8_t byte) override { return lines_.client_to_send.push(byte); }

 private:
  Lines& lines_;
};

class NoWatchdog final : public hal::Watchdog {
 public:
  void feed() override {}
};

Lines lines;
Axis<firmware::kLineCapacity> axis;
firmware::Application application;
TuneMemory tune_memory;
firmware::FaultMemory fault_memory;
RecordPort servo_port(lines);
RecordStream client_stream(lines);
NoWatchdog watchdog;

// The marker is what tells this image from the production one.
[[noreturn]] void fail(const char* why) {
  semihosting::write0(STILLPOINT_CAMPAIGN_MARKER ": ");
  semihosting::write0(why);
  semihosting::write0("\n");
  semihosting::exit(1);
}

void put(uint8_t (&to)[4], uint32_t value) {
  for (size_t i = 0; i < 4; ++i) to[i] = static_cast<uint8_t>(value >> (8 * i));
}

// The host closing its end is the end of the campaign.
void read_record() {
  if (!semihosting::read(lines.in_handle, &lines.in, sizeof lines.in)) semihosting::exit(0);
  if (!servo_link::decode_sync(lines.in.sync, lines.feedback)) fail("a record with a bad CRC");
  for (size_t i = 0; i < lines.in.client_bytes && i < sizeof lines.in.client; ++i) {
    if (!lines.client_received.push(lines.in.client[i])) fail("client bytes lost");
  }
}

void write_record() {
  uint8_t count = 0;
  while (count < sizeof lines.out.client && lines.client_to_send.pop(lines.out.client[count])) ++count;
  lines.out.client_bytes = count;
  put(lines.out.late_ticks, lines.late_ticks);
  if (!semihosting::write(lines.out_handle, &lines.out, sizeof lines.out)) fail("FIFO closed");
}

void measured_tick() {
  application.own_timer_tick();
  const uint32_t before = timer_counts();
  application.tick();
  put(lines.out.timer_counts, timer_counts() - before - lines.counting_cost);
}

void open_lines() {
  lines.in_handle = semihosting::open(STILLPOINT_CAMPAIGN_IN, semihosting::Mode::kReadBinary);
  lines.out_handle = semihosting::open(STILLPOINT_CAMPAIGN_OUT, semihosting::Mode::kWriteBinary);
  if (lines.in_handle == semihosting::kNoHandle || lines.out_handle == semihosting::kNoHandle) {
    fail("no FIFOs " STILLPOINT_CAMPAIGN_IN ", " STILLPOINT_CAMPAIGN_OUT);
  }
}

[[noreturn]] void run_locked() {
  for (;;) {
    measured_tick();
    for (uint32_t i = 0; i < kPollsPerTick; ++i) application.poll();
    write_record();
    read_record();
  }
}

// The first record has been read already: its tick is SysTick's first.
[[noreturn]] void run_free() {
  stm32f405::start_systick(kCoreHz);
  for (;;) {
    for (uint32_t i = 0; i < kPollsPerTick; ++i) application.poll();
    __asm__ volatile("wfi" ::: "memory");
  }
}

}  // namespace

extern "C" {

void safe_state();
void safe_state() { fail("fault handler reached"); }

void systick_handler();
void systick_handler() {
  measured_tick();
  write_record();
  // Due again already: this one was late. (The read below takes no time on the chip's clock: it stands meanwhile.)
  if ((stm32f405::scb().ICSR & stm32f405::Scb::kIcsrSysTickPending) != 0) ++lines.late_ticks;
  read_record();
}

}  // extern "C"

int main() {
  if (!axis.configure(firmware::kDefaultAxis).ok()) fail("the axis refused its configuration");
  application.begin(axis, {&servo_port, &client_stream, &watchdog, &fault_memory, &tune_memory});
  open_lines();
  const uint32_t before = timer_counts();
  lines.counting_cost = timer_counts() - before;
  read_record();
  if (lines.in.pace == sim::kPaceFreeSysTick) run_free();
  run_locked();
}
