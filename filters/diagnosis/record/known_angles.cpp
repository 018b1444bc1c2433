// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/known_angles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filters/allan/gapped_deviation.h"
#include "filters/allan/stretches.h"

namespace ifog {
namespace {

// Several axes are diagnosed at once, and each of them holds this many: 40 MiB.
constexpr std::size_t kAtOnce = kAnglesAtOnce / 4;

}  // namespace

const KnownAngles::Known& KnownAngles::known(std::span<const double> series) {
  return known_.of(series, [](std::span<const double> all) {
    return Known{AngleSum(all, stretches({}, all, {})), {}};
  });
}

std::vector<DeviationPoint> KnownAngles::points(std::span<const double> series,
                                                std::span<const std::size_t> m) {
  const Known& mine = known(series);
  std::vector<std::size_t> missing;
  for (const std::size_t each : m)
    if (!mine.points.contains(each)) missing.push_back(each);
  for (const DeviationPoint& point : deviation(mine.sum, missing, Deviation::kAllan, kAtOnce))
    mine.points[point.m] = point;
  std::vector<DeviationPoint> points;
  points.reserve(m.size());
  for (const std::size_t each : m) points.push_back(mine.points.at(each));
  return points;
}

std::vector<double> KnownAngles::gapped(std::span<const double> series, std::span<const std::size_t> m) {
  if (!std::all_of(series.begin(), series.end(), [](double v) { return std::isfinite(v); }) || series.empty())
    return gapped_deviation(series, m);
  std::vector<double> found;
  found.reserve(m.size());
  for (const DeviationPoint& point : points(series, m))
    found.push_back(series.size() < 3 * point.m ? std::numeric_limits<double>::quiet_NaN()
                                                : std::sqrt(point.variance));
  return found;
}

}  // namespace ifog
