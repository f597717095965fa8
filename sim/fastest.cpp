// SPDX-License-Identifier: Apache-2.0
#include "sim/fastest.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "shaper/profile/matched.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::sim {
namespace {

constexpr ProfileKind kOtherKinds[] = {ProfileKind::kSCurve, ProfileKind::kSin2, ProfileKind::kPoly5,
                                       ProfileKind::kPoly7, ProfileKind::kMatched};

std::vector<SpecifiedShaper> one_a_mode(ShaperKind kind, const std::vector<Mode>& modes) {
  std::vector<SpecifiedShaper> shapers;
  for (const Mode& mode : modes) shapers.push_back(shaper_spec(kind, mode));
  return shapers;
}

std::vector<Combination> combinations(const FastestQuestion& question) {
  const SpecifiedProfile& own = question.task.profile;
  std::vector<Combination> all = {{own, {}, false, false}};
  for (uint32_t kind = 0; kind < kShaperKinds; ++kind) {
    const auto shaper = static_cast<ShaperKind>(kind);
    if (shaper == ShaperKind::kNone || shaper == ShaperKind::kCustom) continue;
    for (const bool zero_delay : {false, true}) {
      all.push_back({own, one_a_mode(shaper, question.modes), zero_delay, false});
    }
  }
  if (own.kind == ProfileKind::kSCurve) all.push_back({own, {}, false, true});
  // Without a jerk limit there is none to plan the others with.
  if (!own.jerk_limited()) return all;
  for (const ProfileKind kind : kOtherKinds) {
    if (kind == own.kind || (kind == ProfileKind::kMatched && question.modes.size() != 1)) continue;
    SpecifiedProfile other;
    other.kind = kind;
    if (kind == ProfileKind::kMatched) {
      const Mode& mode = question.modes.front();
      other.detail = {nullptr, mode.frequency_hz, mode.damping_ratio, plan_matched};
    }
    all.push_back({other, {}, false, false});
    if (kind != ProfileKind::kMatched) {
      all.push_back({other, one_a_mode(ShaperKind::kZv, question.modes), true, false});
    }
  }
  return all;
}

std::string name_of(const Combination& combination) {
  std::string name = profile_text(combination.profile);
  for (size_t i = 0; i < combination.shapers.size(); ++i) {
    name += (i == 0 ? " + " : "+") + spec_text(combination.shapers[i]);
  }
  if (combination.still) name = "still " + name;
  return combination.zero_delay ? name + ", zero delay" : name;
}

class Judge {
 public:
  Judge(const FastestQuestion& question, const Recording& plain)
      : question_(question), plain_peak_(rest_of(plain.setpoints, question.task, question.arm).residual_peak) {}

  FastestCandidate candidate(const Combination& combination, const Recording& recording, uint32_t stages) const {
    const double tick_s = question_.task.tick_s;
    const Rest rest = rest_of(recording.setpoints, question_.task, question_.arm);
    FastestCandidate result{combination,
                            name_of(combination),
                            recording.report.timing,
                            0,
                            {},
                            0.0,
                            evaluate_stream(recording.setpoints, question_.task, stages)};
    result.move_ticks = static_cast<uint32_t>(std::llround(rest.move_time_s / tick_s));
    result.residual_ratio = plain_peak_ > 0.0 ? rest.residual_peak / plain_peak_ : 0.0;
    const std::optional<double> settling = settling_time_s(rest, question_.tolerance * plain_peak_);
    if (settling) {
      result.still_ticks = result.move_ticks + static_cast<uint32_t>(std::ceil(*settling / tick_s * (1.0 - 1e-9)));
    }
    return result;
  }

 private:
  const FastestQuestion& question_;
  double plain_peak_;
};

bool is_sooner(const FastestCandidate& a, const FastestCandidate& b) {
  const auto rank = [](const FastestCandidate& one) {
    const bool useless = !one.stream.within_limits || !one.still_ticks;
    return std::make_tuple(useless, one.still_ticks.value_or(UINT32_MAX), one.residual_ratio);
  };
  return rank(a) < rank(b);
}

}  // namespace

FastestAnswer find_fastest(const FastestQuestion& question, const OnProgress& on_progress) {
  FastestAnswer answer;
  MoveTask task = question.task;
  task.duration_s = 0.0;
  task.zero_delay = false;
  answer.plain = run_axis(task, {});
  const Judge judge(question, answer.plain);
  const std::vector<Combination> all = combinations(question);
  for (size_t i = 0; i < all.size(); ++i) {
    if (on_progress) on_progress(static_cast<double>(i) / static_cast<double>(all.size()));
    task.profile = all[i].profile;
    task.zero_delay = all[i].zero_delay;
    try {
      const ShaperDesign design = design_for(all[i].shapers, task.tick_s);
      Recording recording = all[i].still ? run_still(task, question.modes) : run_axis(task, design);
      FastestCandidate candidate = judge.candidate(all[i], recording, design.stage_count);
      if (answer.candidates.empty() || is_sooner(candidate, answer.candidates.front())) {
        answer.best = std::move(recording);
        answer.design = design;
        answer.candidates.insert(answer.candidates.begin(), std::move(candidate));
      } else {
        answer.candidates.push_back(std::move(candidate));
      }
    } catch (const Refusal&) {  // a shaper that the mode or the ticks do not allow, a kind that is not there
    }
  }
  std::stable_sort(answer.candidates.begin() + 1, answer.candidates.end(), is_sooner);
  return answer;
}

}  // namespace stillpoint::sim
