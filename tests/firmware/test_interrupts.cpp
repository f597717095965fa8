// SPDX-License-Identifier: Apache-2.0
// The tick as a true interrupt: a timer signal runs it on this thread's stack, wherever the background is.
#include <signal.h>
#include <sys/time.h>

#include <utility>

#include "tests/firmware/rig.hpp"
#include "tests/support/shapers.hpp"
#include "tests/support/stream_check.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr int64_t kCount = int64_t{1} << 32;
constexpr size_t kRoom = 400000;  // so that the servo's log never allocates in the signal
constexpr int kPeriodUs = 100;

void start_signal(void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(SIGALRM, &action, nullptr);
  const itimerval period = {{0, kPeriodUs}, {0, kPeriodUs}};
  setitimer(ITIMER_REAL, &period, nullptr);
}

void stop_signal() {
  const itimerval none = {};
  setitimer(ITIMER_REAL, &none, nullptr);
  signal(SIGALRM, SIG_IGN);
}

struct Interrupted : Rig {
  static Interrupted* running;

  Interrupted() { servo.commands.reserve(kRoom); }
  ~Interrupted() { stop_signal(); }

  static void on_signal(int) {
    if (running->servo.commands.size() == kRoom) return;
    running->drive.tick();
    running->drive.own_timer_tick();
  }

  void start() {
    running = this;
    start_signal(on_signal);
  }

  // As Rig::exchange, but time goes on by itself.
  Bytes talk(const Bytes& pdu) {
    Bytes body{1};
    body.insert(body.end(), pdu.begin(), pdu.end());
    send(framed(body));
    while (line.from_drive.empty()) {
      if (servo.commands.size() == kRoom) FAIL("the drive did not answer");
      drive.poll();
    }
    return answer();
  }
  void write_word(uint32_t address, uint32_t word) {
    Bytes pdu{6};
    append_word(pdu, address);
    append_word(pdu, word);
    TEST_ASSERT_EQUAL_UINT32(0, exception_in(talk(pdu)));
  }
  std::vector<uint16_t> words_at(uint32_t first, uint32_t count) {
    const Bytes response = talk(read_request(first, count));
    TEST_ASSERT_EQUAL_UINT32(0, exception_in(response));
    std::vector<uint16_t> words;
    for (size_t i = 2; i < response.size(); i += 2) {
      words.push_back(static_cast<uint16_t>((response[i] << 8) | response[i + 1]));
    }
    return words;
  }
  void wait_for_status(uint32_t mask, uint32_t value) {
    while ((words_at(0x0041, 1)[0] & mask) != value) continue;
  }
  void move(int32_t target) {
    const auto high = static_cast<uint16_t>(target >> 16);
    TEST_ASSERT_EQUAL_UINT32(0, exception_in(talk(write_request(0x0044, {high, static_cast<uint16_t>(target)}))));
    write_word(0x0040, 0x1F);
    wait_for_status(0x1000, 0x1000);
    write_word(0x0040, 0x0F);
  }
};

Interrupted* Interrupted::running = nullptr;

int32_t wide(const std::vector<uint16_t>& words, size_t at) {
  return static_cast<int32_t>((uint32_t{words[at]} << 16) | words[at + 1]);
}

std::vector<int64_t> changes(const std::vector<hal::ServoCommand>& commands) {
  std::vector<int64_t> stream;
  for (size_t i = 1; i < commands.size(); ++i) {
    if (commands[i].setpoint != commands[i - 1].setpoint) stream.push_back(commands[i].setpoint);
  }
  return stream;
}

constexpr int32_t kTargets[] = {30000, -70001, 123457, 123456, -1, 500000};
const std::vector<uint16_t> kZv11Hz = {1, 0xADB0, 11000, 0, 1, 0, 0, 0};  // 110000e-4 Hz, 0.11

// A move to and fro for ever, watched through the snapshot alone: the servo follows exactly and the two tick counters
// go together, so a snapshot whose position is not its setpoint, or whose counters part, is of two ticks.
struct Watched {
  static Watched* running;

  Axis<64> axis;
  Servo servo;
  firmware::ControlLoop loop;
  int32_t target = 1000000;

  Watched() {
    TEST_ASSERT_OK(axis.configure(firmware::kDefaultAxis));
    servo.commands.reserve(kRoom);
    loop.begin(axis, servo);
    loop.tick();
    loop.request_enabled(true);
    loop.tick();
    running = this;
    start_signal([](int) { running->loop.tick(); });
  }
  ~Watched() { stop_signal(); }
};

Watched* Watched::running = nullptr;

TEST_F(Watched, a_snapshot_is_never_of_two_ticks) {
  uint32_t different = 0;
  uint32_t last_tick = 0;
  const firmware::LoopSnapshot first = loop.snapshot();
  while (different < 4000) {
    if (servo.commands.size() >= kRoom) FAIL("the background starves");
    const bool pending = axis.pending();  // before the snapshot: afterwards a move could begin between the two
    const firmware::LoopSnapshot seen = loop.snapshot();
    if (seen.position != seen.axis.setpoint) TEST_ASSERT_EQUAL_INT64(seen.axis.setpoint, seen.position);
    const uint32_t apart = seen.axis.tick - seen.ticks;
    if (apart != first.axis.tick - first.ticks) TEST_ASSERT_EQUAL_UINT32(first.axis.tick - first.ticks, apart);
    if (seen.ticks != last_tick) ++different;
    last_tick = seen.ticks;
    if (seen.axis.phase != AxisPhase::kAtRest || pending) continue;
    target = -target;
    TEST_ASSERT_OK(axis.command({target, ProfileKind::kSCurve, {1e7, 1e9, 1e9, 1e12}, 0.0, false}, nullptr));
  }
}

// Shapers exchanged in motion while ticks come at any instruction of the search.
struct Retuned {
  static Retuned* running;

  Axis<256> axis;
  std::vector<Signal> setpoints;
  uint32_t count = 0;  // of them, as the background may read it

  Retuned() {
    TEST_ASSERT_OK(axis.configure(firmware::kDefaultAxis));
    setpoints.resize(kRoom);
    running = this;
    start_signal([](int) {
      if (running->count == kRoom) return;
      running->setpoints[running->count] = running->axis.tick();
      store(running->count, running->count + 1);
    });
  }
  ~Retuned() { stop_signal(); }
};

Retuned* Retuned::running = nullptr;

TEST_F(Retuned, a_blend_keeps_the_limits_whenever_ticks_interrupt_its_search) {
  const AxisLimits limits{1.2e6, 20e6, 20e6, 600e6};
  ShaperDesign fast{};
  TEST_ASSERT_OK(add_shaper(ShaperKind::kZv, Mode{37.0, 0.0}, 1e-3, fast));
  const ShaperDesign slow = three_hump_ei(30.0, 1e-3);
  const uint64_t seed = 1;
  TEST_INFO("seed", seed);
  Random random(seed);
  std::vector<std::pair<uint32_t, bool>> moves;  // where in the log one begins, and whether forward
  uint32_t blended = 0;
  bool forward = false;
  for (int i = 0; i < 60; ++i) {
    forward = !forward;
    while (axis.pending() || axis.state().phase != AxisPhase::kAtRest) continue;
    moves.emplace_back(load(count), forward);
    const Move move{forward ? 900000 : 0, ProfileKind::kSCurve, limits, random.between(0.9, 1.4), false};
    TEST_ASSERT_OK(axis.command(move, nullptr));
    const uint32_t at = load(count) + static_cast<uint32_t>(random.integer(1, 600));
    while (load(count) < at) continue;
    TEST_ASSERT_OK(axis.set_shaper(axis.shaper().length_ticks() > 50 ? fast : slow, Retune::kBlended));
    while (axis.pending()) axis.service();
    if (axis.state().phase != AxisPhase::kAtRest) ++blended;
  }
  while (axis.state().phase != AxisPhase::kAtRest) continue;
  stop_signal();
  TEST_ASSERT_TRUE(count < kRoom);
  moves.emplace_back(count, forward);
  for (size_t i = 0; i + 1 < moves.size(); ++i) {
    TEST_INFO("move", i);
    const Signal start = signal_from_counts(moves[i].second ? 0 : 900000);
    StreamCheck check(start, moves[i].second, limits, 1e-3);
    for (uint32_t k = moves[i].first; k < moves[i + 1].first; ++k) check.next(setpoints[k]);
    TEST_ASSERT_TRUE(check.within(3));
    TEST_ASSERT_EQUAL_INT64(signal_from_counts(moves[i].second ? 900000 : 0), setpoints[moves[i + 1].first - 1]);
  }
  TEST_ASSERT_AT_LEAST_INT64(20, blended);
}

// The servo follows exactly, so a following error other than 0 would be a reading put together from two ticks.
TEST_F(Interrupted, the_setpoints_are_those_of_a_drive_never_interrupted_and_no_reading_is_torn) {
  Rig calm;
  calm.enable();
  TEST_ASSERT_EQUAL_UINT32(0, calm.write(0x0102, kZv11Hz));
  TEST_ASSERT_EQUAL_UINT32(0, calm.write_single(0x0100, 1));
  TEST_ASSERT_EQUAL_UINT32(0, calm.write_single(0x0130, 1));
  for (const int32_t target : kTargets) {
    TEST_ASSERT_EQUAL_UINT32(0, calm.write_wide(0x0044, target));
    calm.control(0x1F);
    calm.control(0x0F);
    calm.step(2000);
    TEST_ASSERT_EQUAL_INT64(target * kCount, calm.servo.setpoint());
  }

  start();
  for (const uint32_t word : {0x06U, 0x07U, 0x0FU}) write_word(0x0040, word);
  wait_for_status(0x006F, 0x0027);
  TEST_ASSERT_EQUAL_UINT32(0, exception_in(talk(write_request(0x0102, kZv11Hz))));
  write_word(0x0100, 1);
  write_word(0x0130, 1);
  uint32_t readings = 0;
  for (const int32_t target : kTargets) {
    TEST_INFO("target", target);
    move(target);
    for (;;) {
      const std::vector<uint16_t> words = words_at(0x0040, 16);
      ++readings;
      TEST_ASSERT_EQUAL_INT32(0, wide(words, 0xC));
      TEST_ASSERT_EQUAL_INT32(wide(words, 0x6), wide(words, 0xA));
      if ((words[1] & 0x0400) == 0) continue;
      TEST_ASSERT_EQUAL_INT32(target, wide(words, 0xA));
      break;
    }
  }
  stop_signal();
  TEST_ASSERT_AT_LEAST_INT64(100, readings);
  TEST_ASSERT_TRUE(changes(calm.servo.commands) == changes(servo.commands));
}

}  // namespace
