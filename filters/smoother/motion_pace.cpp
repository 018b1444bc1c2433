// SPDX-License-Identifier: Apache-2.0
#include "filters/smoother/motion_pace.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace ifog {
namespace {

// Index of a memory, half a decade apart like the trackers'; for a sample, the number of memories accepted.
using Level = std::uint8_t;
constexpr Level kLevels = 12;
double memory_of(Level level) { return std::pow(10.0, 0.5 * (level - 1)) / 0.7; }

// Half of the window in units of the longer memory. If both are equally good the sum of risk differences is
// -11 +- 3.5 noise variances. A false rejection shortens the memory for as long as it takes to grow again, so
// its probability must be below 1e-6.
constexpr double kHalfWindow = 6.0;
constexpr double kAsGood = 24.0;
constexpr double kUsed = 0.8;
// Growth of the memory per sample after faster motion.
constexpr float kGrows = 0.1F;
// Estimated squared error of each sample / R, without a common constant. Level 0: the measurement itself.
std::vector<double> risks(const RateCourse& part, double noise, Level level) {
  const std::size_t length = part.rate.size();
  std::vector<double> risk(length, 2.0);
  if (level == 0) return risk;
  const std::vector<float> memories(length, static_cast<float>(memory_of(level)));
  RateCourse all = part;
  all.memories = memories;
  const Smoothed smoothed = smooth_course(all, noise);
  for (std::size_t i = 0; i < length; ++i) {
    const double apart = part.rate[i] - smoothed.rate_radps[i];
    risk[i] = (apart * apart + 2.0 * smoothed.variance_rad2ps2[i]) / noise;
  }
  return risk;
}

// Marks samples at which the longer memory is accepted like all before it; returns their number.
std::size_t compare(const RateCourse& part, const std::vector<double>& shorter,
                    const std::vector<double>& longer, Level level, std::vector<Level>& levels) {
  const std::size_t length = part.rate.size();
  std::vector<double> sum(length + 1);
  for (std::size_t i = 0; i < length; ++i)
    sum[i + 1] = sum[i] + (std::isfinite(part.rate[i]) ? longer[i] - shorter[i] : 0.0);
  const auto half = static_cast<std::size_t>(std::ceil(kHalfWindow * memory_of(level)));
  std::size_t taken = 0;
  for (std::size_t i = 0; i < length; ++i) {
    if (levels[i] + 1 != level) continue;
    const std::size_t begin = i > half ? i - half : 0, end = std::min(length, i + half + 1);
    if (sum[end] - sum[begin] > kAsGood) continue;
    levels[i] = level;
    ++taken;
  }
  return taken;
}

std::vector<Level> levels_of(const RateCourse& part, double noise, double longest) {
  std::vector<Level> levels(part.rate.size());
  std::vector<double> shorter = risks(part, noise, 0);
  for (Level level = 1; level < kLevels && memory_of(level) <= longest; ++level) {
    std::vector<double> longer = risks(part, noise, level);
    if (compare(part, shorter, longer, level, levels) == 0) break;
    shorter = std::move(longer);
  }
  return levels;
}

RateCourse part_of(const RateCourse& course, std::size_t begin, std::size_t end) {
  const std::size_t length = end - begin;
  return {course.rate.subspan(begin, length),
          course.walk.subspan(begin, length),
          course.steps.empty() ? course.steps : course.steps.subspan(begin, length),
          {}};
}

// Determines the memories in one run of motion.
void find_in(const RateCourse& run, double noise, double longest, std::span<float> memories) {
  const std::size_t length = memories.size();
  const std::vector<Level> levels = levels_of(run, noise, longest);
  for (std::size_t i = 0; i < length; ++i)
    memories[i] = levels[i] == 0 ? pace::kBroken : static_cast<float>(kUsed * memory_of(levels[i]));
  for (std::size_t i = 1; i < length; ++i) memories[i] = std::min(memories[i], memories[i - 1] + kGrows);
  for (std::size_t i = length - 1; i-- > 0;) memories[i] = std::min(memories[i], memories[i + 1] + kGrows);
}

}  // namespace

void find_paces(const RateCourse& course, double noise, double longest, std::span<float> memories) {
  for (std::size_t begin = 0; begin < memories.size();) {
    std::size_t end = begin;
    while (end < memories.size() && memories[end] > pace::kRest) ++end;
    if (end > begin)
      find_in(part_of(course, begin, end), noise, longest, memories.subspan(begin, end - begin));
    begin = end + 1;
  }
}

}  // namespace ifog
