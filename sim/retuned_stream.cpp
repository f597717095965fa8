// SPDX-License-Identifier: Apache-2.0
#include "sim/retuned_stream.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "shaper/axis/blend.hpp"
#include "shaper/shaping/shaper.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::sim {
namespace {

constexpr uint32_t kLeastOrder = 1;
constexpr uint32_t kMostOrder = 9;

struct Window {
  size_t begin;  // the last tick of the old shaper alone
  uint32_t order;
  size_t end() const { return begin + BlendRamp::ticks(order); }
};

// In LSB/tick^n, allowance for roundings included: two shapers' and the blend's.
struct Bounds {
  double velocity;
  double acceleration;
  double deceleration;
  double jerk;
  double rounding;

  static Bounds make(const AxisLimits& limits, double tick_s, uint32_t stages) {
    const double lsb_tick = tick_s * static_cast<double>(kSignalPerCount);
    const double rounding = stages + 2.0;
    return {limits.velocity * lsb_tick + rounding, limits.acceleration * lsb_tick * tick_s + 2.0 * rounding,
            limits.deceleration * lsb_tick * tick_s + 2.0 * rounding,
            limits.jerk * lsb_tick * tick_s * tick_s + 4.0 * rounding, rounding};
  }
};

// Steps beyond 2^63 LSB are outside the range of steps; they wrap.
double step_between(Signal before, Signal after) {
  return static_cast<double>(static_cast<int64_t>(static_cast<uint64_t>(after) - static_cast<uint64_t>(before)));
}

// A sample's differences, magnitudes but for the first.
struct Differences {
  double step;
  double faster;  // the second while speeding up
  double slower;  // the second while slowing down
  double jerk;

  Differences(Signal newest, Signal before, Signal before_that, Signal oldest) {
    step = step_between(before, newest);
    const double last_step = step_between(before_that, before);
    const double change = step - last_step;
    const bool speeds_up = std::abs(step) > std::abs(last_step);
    faster = speeds_up ? std::abs(change) : 0.0;
    slower = speeds_up ? 0.0 : std::abs(change);
    jerk = std::abs(change - (last_step - step_between(oldest, before_that)));
  }
  bool keeps(const Bounds& bounds) const {
    return std::abs(step) <= bounds.velocity && faster <= bounds.acceleration && slower <= bounds.deceleration &&
           jerk <= bounds.jerk;
  }
  void raise(Bounds& bounds) const {
    bounds.velocity = std::max(bounds.velocity, std::abs(step) + bounds.rounding);
    bounds.acceleration = std::max(bounds.acceleration, faster + 2.0 * bounds.rounding);
    bounds.deceleration = std::max(bounds.deceleration, slower + 2.0 * bounds.rounding);
    bounds.jerk = std::max(bounds.jerk, jerk + 4.0 * bounds.rounding);
  }
};

// What a shaper makes of the input from a tick on, its line filled with what stood before.
class Shaped {
 public:
  Shaped(const std::vector<Signal>& input, size_t from, size_t to, const ShaperDesign& design)
      : from_(from), before_(from == 0 ? 0 : input[from - 1]) {
    std::vector<LineSample> memory(Shaper::memory_needed(design) + 1, LineSample{0, 0});
    Shaper shaper;
    require(shaper.configure(design, memory.data(), memory.size(), before_));
    output_.reserve(to - from);
    for (size_t tick = from; tick < to; ++tick) output_.push_back(shaper.tick(input[tick]));
  }
  Signal at(size_t tick) const {
    return tick < from_ || output_.empty() ? before_ : output_[std::min(tick - from_, output_.size() - 1)];
  }
  Differences differences(size_t tick) const {
    const auto back = [&](size_t ticks) { return tick < ticks ? Signal{0} : at(tick - ticks); };
    return {at(tick), back(1), back(2), back(3)};
  }

 private:
  size_t from_;
  Signal before_;
  std::vector<Signal> output_;
};

class BlendFinder {
 public:
  BlendFinder(const Shaped& from, const Shaped& to, size_t first, size_t last, const Bounds& bounds)
      : from_(from), to_(to), first_(first), bounds_(bounds), loosest_(bounds) {
    for (size_t tick = first; tick <= last; ++tick) {
      from.differences(tick).raise(loosest_);
      to.differences(tick).raise(loosest_);
      const bool breaks = !from.differences(tick).keeps(bounds) || !to.differences(tick).keeps(bounds);
      broken_.push_back((broken_.empty() ? 0 : broken_.back()) + (breaks ? 1U : 0U));
    }
  }

  // The one that ends first, at `last` or before.
  std::optional<Window> find() const {
    std::optional<Window> best;
    size_t end = first_ + broken_.size();
    for (size_t begin = first_; begin + BlendRamp::ticks(kLeastOrder) < end; ++begin) {
      for (uint32_t order = kLeastOrder; order <= kMostOrder; ++order) {
        const Window window{begin, order};
        if (window.end() >= end) break;
        if (!fits(window)) continue;
        best = window;
        end = window.end();
      }
    }
    return best;
  }

 private:
  bool fits(const Window& window) const {
    if (keeps(window, bounds_)) return true;
    if (broken_[window.end() - first_] == broken_[window.begin - first_]) return false;
    if (!keeps(window, loosest_)) return false;
    Bounds raised = bounds_;
    for (size_t tick = window.begin + 1; tick <= window.end(); ++tick) {
      from_.differences(tick).raise(raised);
      to_.differences(tick).raise(raised);
    }
    return keeps(window, raised);
  }

  // And never turns round where neither of the two does.
  bool keeps(const Window& window, const Bounds& bounds) const {
    BlendRamp ramp;
    ramp.begin(window.order);
    const auto back = [&](size_t ticks) { return window.begin < ticks ? Signal{0} : from_.at(window.begin - ticks); };
    Signal last[3] = {back(0), back(1), back(2)};
    for (size_t tick = window.begin + 1; tick <= window.end(); ++tick) {
      const Signal next = ramp.tick(from_.at(tick), to_.at(tick));
      const Differences own(next, last[0], last[1], last[2]);
      if (!own.keeps(bounds)) return false;
      const double from_step = step_between(from_.at(tick - 1), from_.at(tick));
      const double to_step = step_between(to_.at(tick - 1), to_.at(tick));
      if (from_step >= 0.0 && to_step >= 0.0 && own.step < -bounds.rounding) return false;
      if (from_step <= 0.0 && to_step <= 0.0 && own.step > bounds.rounding) return false;
      last[2] = last[1];
      last[1] = last[0];
      last[0] = next;
    }
    return true;
  }

  const Shaped& from_;
  const Shaped& to_;
  size_t first_;
  Bounds bounds_;
  Bounds loosest_;                // raised by every tick: what does not keep these need not be looked at closely
  std::vector<uint32_t> broken_;  // ticks from `first_` on, so far, at which one of the two is outside the limits
};

class Retuner {
 public:
  Retuner(const std::vector<Signal>& input, const ShaperDesign& first, const std::vector<StreamRetune>& retunes,
          const AxisLimits& limits, double tick_s)
      : input_(input), given_(input.size()), design_(first), limits_(limits), tick_s_(tick_s) {
    // Behind the last value there is time for every shaper to come to rest.
    size_t longest = first.length_ticks();
    for (const StreamRetune& retune : retunes) longest = std::max<size_t>(longest, retune.design.length_ticks());
    input_.insert(input_.end(), longest, input.empty() ? 0 : input.back());
    shaped_.emplace(input_, 0, input_.size(), design_);
  }

  void retune(const StreamRetune& retune, RetunedStream& out) {
    const size_t due = std::max(retune.tick, out.output.size());
    emit(due, out);
    const size_t rest = rest_after(due);
    if (rest > due && blend(retune.design, due, rest, out)) return;
    emit(rest, out);
    design_ = retune.design;
    anchor_ = rest;
    shaped_.emplace(input_, anchor_, input_.size(), design_);
    out.active_from.push_back(rest);
  }

  void emit(size_t until, RetunedStream& out) const {
    for (size_t tick = out.output.size(); tick < until; ++tick) out.output.push_back(shaped_->at(tick));
  }

  // The first tick from `tick` on at which all that came before has arrived, by the shaper in force.
  size_t rest_after(size_t tick) const {
    const size_t length = design_.length_ticks();
    const bool since_filled = tick < anchor_ + length;
    size_t at = since_filled ? anchor_ : tick - length;
    size_t stood = since_filled ? length : 0;  // ticks in a row before `at` whose input was that of the tick before
    for (; at < tick || stood < length; ++at) {
      const Signal before = at == 0 ? 0 : input_at(at - 1);
      stood = input_at(at) == before ? stood + 1 : 0;
    }
    return at;
  }
  // The first tick at which there is nothing left to come.
  size_t end(const RetunedStream& out) const { return rest_after(std::max(given_, out.output.size())); }

 private:
  Signal input_at(size_t tick) const {
    return tick < input_.size() ? input_[tick] : input_.empty() ? 0 : input_.back();
  }

  bool blend(const ShaperDesign& design, size_t due, size_t rest, RetunedStream& out) {
    const size_t first = due + design.length_ticks();
    if (first + BlendRamp::ticks(kLeastOrder) >= rest) return false;
    Shaped next(input_, anchor_, input_.size(), design);
    const Bounds bounds = Bounds::make(limits_, tick_s_, std::max(design.stage_count, design_.stage_count));
    const auto window = BlendFinder(*shaped_, next, first, rest - 1, bounds).find();
    if (!window) return false;
    emit(window->begin + 1, out);
    BlendRamp ramp;
    ramp.begin(window->order);
    while (!ramp.done()) {
      const size_t tick = out.output.size();
      out.output.push_back(ramp.tick(shaped_->at(tick), next.at(tick)));
    }
    design_ = design;
    shaped_.emplace(std::move(next));
    out.active_from.push_back(window->end());
    return true;
  }

  std::vector<Signal> input_;
  size_t given_;
  ShaperDesign design_;
  AxisLimits limits_;
  double tick_s_;
  size_t anchor_ = 0;  // from when the shaper in force has run, its line filled before
  std::optional<Shaped> shaped_;
};

}  // namespace

RetunedStream retuned(const std::vector<Signal>& input, const ShaperDesign& first,
                      const std::vector<StreamRetune>& retunes, const AxisLimits& limits, double tick_s) {
  RetunedStream out;
  Retuner retuner(input, first, retunes, limits, tick_s);
  for (const StreamRetune& retune : retunes) {
    if (retune.tick >= retuner.end(out)) break;
    retuner.retune(retune, out);
  }
  retuner.emit(retuner.end(out), out);
  return out;
}

}  // namespace stillpoint::sim
