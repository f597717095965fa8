// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/stepped_sine.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

constexpr int kMostLooks = 4;

bool are_alike(const Identification& a, const Identification& b) {
  if (a.mode_count != b.mode_count) return false;
  for (size_t k = 0; k < a.mode_count; ++k) {
    const IdentifiedMode& mode = a.mode[k];
    if (math::abs(mode.frequency_hz - b.mode[k].frequency_hz) > mode.frequency_std_hz) return false;
    if (math::abs(mode.damping_ratio - b.mode[k].damping_ratio) > mode.damping_std) return false;
  }
  return true;
}

}  // namespace

Status identify_stepped(const SteppedBins& bins, const Excitation& excitation, double tick_s,
                        const ResponseConfig& config, BinAnswer* answers, ResponseScratch& scratch,
                        Identification& result, const Meanwhile& meanwhile) {
  result = Identification{};
  for (int look = 0; look < kMostLooks; ++look) {
    bins.answers(excitation, tick_s, result, answers, meanwhile);
    Identification next{};
    const Status status = identify_response(answers, excitation.steps(), config, scratch, next, meanwhile);
    if (!status.ok()) return status;
    if (look > 0 && next.finding != Finding::kFound) break;
    const bool settled = next.finding != Finding::kFound || (look > 0 && are_alike(next, result));
    result = next;
    if (settled) break;
  }
  return kOk;
}

}  // namespace stillpoint
