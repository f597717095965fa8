// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/saturation.hpp"

namespace stillpoint {

namespace {

// A smooth top that looks flat for n samples, because it is rounded to steps, has fallen by this many steps at half as
// many beyond either end: 9 for two samples, at most 5.4 for more, and a little for noise.
constexpr float kSmoothPair = 40.0F;
constexpr float kSmoothTop = 8.0F;

float distance(float a, float b) { return a > b ? a - b : b - a; }

// The smallest step between neighbours: the sensor's resolution, or nothing worth mentioning.
float smallest_step(const Record& record) {
  float step = 0.0F;
  for (size_t n = 1; n < record.count; ++n) {
    const float here = distance(record.samples[n], record.samples[n - 1]);
    if (here > 0.0F && (step == 0.0F || here < step)) step = here;
  }
  return step;
}

// Whether the samples [first, end), all at the extreme, are cut off.
bool is_cut(const Record& record, size_t first, size_t end, float step) {
  const size_t flat = end - first;
  const size_t reach = flat / 2;
  if (flat < 2 || (first < reach && end + reach > record.count)) return false;
  const float smooth = (flat == 2 ? kSmoothPair : kSmoothTop) * step;
  const float extreme = record.samples[first];
  const bool before = first < reach || distance(record.samples[first - reach], extreme) > smooth;
  const bool after = end + reach > record.count || distance(record.samples[end + reach - 1], extreme) > smooth;
  return before && after;
}

bool is_cut_at(const Record& record, float extreme, float step) {
  const auto is_there = [&](size_t n) { return !(record.samples[n] < extreme) && !(record.samples[n] > extreme); };
  for (size_t n = 0; n < record.count; ++n) {
    if (!is_there(n)) continue;
    const size_t first = n;
    while (n < record.count && is_there(n)) ++n;
    if (is_cut(record, first, n, step)) return true;
  }
  return false;
}

}  // namespace

bool is_saturated(const Record& record) {
  if (record.count == 0) return false;
  float low = record.samples[0], high = record.samples[0];
  for (size_t n = 0; n < record.count; ++n) {
    low = record.samples[n] < low ? record.samples[n] : low;
    high = record.samples[n] > high ? record.samples[n] : high;
  }
  const float step = smallest_step(record);
  return is_cut_at(record, high, step) || is_cut_at(record, low, step);
}

namespace {

constexpr double kTop = 0.9;  // of the record's extreme
constexpr double kFlatSlope = 0.6;
constexpr double kSure = 4.0;
constexpr size_t kLeastInTop = 10;

// What oscillates: of the record, without the model's straight line, and of the model.
template <typename Visit>
void visit_each(const Record& record, const DecayModel& model, Visit visit) {
  const DecayModel line{model.offset, model.drift, 0, {}};
  ModelSamples lines(line, record.count);
  ModelSamples samples(model, record.count);
  for (size_t n = 0; n < record.count; ++n) {
    const double straight = lines.next();
    visit(static_cast<double>(record.samples[n]) - straight, samples.next() - straight);
  }
}

bool is_flat_on(const Record& record, const DecayModel& model, double sign) {
  double extreme = 0.0;
  visit_each(record, model, [&](double y, double) { extreme = sign * y > extreme ? sign * y : extreme; });
  double count = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  visit_each(record, model, [&](double measured, double fitted) {
    const double beyond = sign * fitted - kTop * extreme;
    if (beyond < 0.0) return;
    const double height = sign * measured - kTop * extreme;
    count += 1.0;
    x += beyond;
    y += height;
    xx += beyond * beyond;
    xy += beyond * height;
    yy += height * height;
  });
  if (count < static_cast<double>(kLeastInTop)) return false;
  xx -= x * x / count;
  xy -= x * y / count;
  yy -= y * y / count;
  if (!(xx > 0.0)) return false;
  const double slope = xy / xx;
  const double left = yy - slope * xy;
  const double spread = left > 0.0 ? math::sqrt(left / ((count - 2.0) * xx)) : 0.0;
  return slope + kSure * spread < kFlatSlope;
}

}  // namespace

bool is_flattened(const Record& record, const DecayModel& model) {
  return is_flat_on(record, model, 1.0) || is_flat_on(record, model, -1.0);
}

}  // namespace stillpoint
