// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/unbroken_part.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/record/figures.h"
#include "filters/diagnosis/record/record_clock.h"
#include "filters/series/series_view.h"

namespace ifog {
namespace {

constexpr std::size_t kLeastSamples = 4096;
constexpr std::size_t kMostSamples = 131072;
constexpr double kSlowerThan = 512.0;
constexpr double kStroboscope = 0.01;  // cycles a sample
constexpr double kHole = 1.5;          // steps

Stretch longest_without_hole(const Record& record, double step_s) {
  Stretch longest{0, 0};
  std::size_t begin = 0;
  ReadingAhead times(record.time_s), rates(record.rate_radps);
  for (std::size_t i = 0; i <= record.time_s.size(); ++i) {
    times.at(i);
    rates.at(i);
    const bool missing = i == record.time_s.size() || !std::isfinite(record.rate_radps[i]) ||
                         (!record.reference_radps.empty() && !std::isfinite(record.reference_radps[i]));
    const bool hole = i > begin && !missing && record.time_s[i] - record.time_s[i - 1] > kHole * step_s;
    if (!missing && !hole) continue;
    if (i - begin > longest.end - longest.begin) longest = {begin, i};
    begin = missing ? i + 1 : i;
  }
  return longest;
}

}  // namespace

double UnbrokenPart::mean_turn_rad() const {
  return size() < 2 ? 0.0 : (angle_rad.back() - angle_rad.front()) / static_cast<double>(size() - 1);
}

bool UnbrokenPart::stroboscopic(double cycles_per_rad, std::size_t harmonic) const {
  const double turn = std::abs(cycles_per_rad * mean_turn_rad()) * static_cast<double>(harmonic);
  return turn > 0.5 && std::abs(turn - std::round(turn)) < kStroboscope;
}

UnbrokenPart evenly_turned(UnbrokenPart part) {
  const double first = part.angle_rad.front(), turn = part.mean_turn_rad();
  for (std::size_t i = 0; i < part.size(); ++i) part.angle_rad[i] = first + turn * static_cast<double>(i);
  return part;
}

UnbrokenPart unbroken_part(const Record& record) {
  UnbrokenPart part;
  if (record.time_s.size() < kLeastSamples) return part;
  part.sample_s = usual_step_of(record);
  Stretch where = longest_without_hole(record, part.sample_s);
  where.end = std::min(where.end, where.begin + kMostSamples);
  if (where.end - where.begin < kLeastSamples) return part;
  part.first = where.begin;
  double slow = 0.0;
  double weight = 0.0;
  double angle = 0.0;
  for (std::size_t i = where.begin; i < where.end; ++i) {
    double error = record.rate_radps[i];
    if (!record.reference_radps.empty()) error -= record.reference_radps[i];
    if (i > where.begin) angle += record.rate_radps[i] * (record.time_s[i] - record.time_s[i - 1]);
    part.angle_rad.push_back(angle);
    part.error_radps.push_back(i > where.begin ? error - slow : 0.0);
    weight = std::min(weight + 1.0, kSlowerThan);
    slow += (error - slow) / weight;
  }
  return part;
}

}  // namespace ifog
