// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/known_angles.h"

#include <cmath>
#include <limits>

#include "filters/allan/gapped_deviation.h"
#include "filters/series/series_view.h"

namespace ifog {
namespace {

// Several axes are diagnosed at once, and each of them holds this many: 40 MiB.
constexpr std::size_t kAtOnce = kAnglesAtOnce / 4;

bool all_finite(std::span<const double> series) {
  bool finite = !series.empty();
  for_each_piece(series, 0, series.size(), [&](std::span<const double> some, std::size_t) {
    bool all = true;  // without a branch
    for (const double each : some) all = all && std::isfinite(each);
    finite = finite && all;
  });
  return finite;
}

}  // namespace

const KnownAngles::Known& KnownAngles::known(const AskedSeries& series) {
  return known_.of(series, [](std::span<const double> all) {
    if (all_finite(all)) return Known{{{0, all.size()}}, true, {}, {}};
    return Known{stretches({}, all, {}), false, {}, {}};
  });
}

const AngleSum& KnownAngles::sum_of(const Known& mine, const AskedSeries& series) {
  if (!mine.sum) mine.sum.emplace(series.values(), mine.present);
  return *mine.sum;
}

std::vector<DeviationPoint> KnownAngles::points(const AskedSeries& series, std::span<const std::size_t> m) {
  const Known& mine = known(series);
  std::vector<std::size_t> missing;
  for (const std::size_t each : m)
    if (!mine.points.contains(each)) missing.push_back(each);
  for (const DeviationPoint& point : deviation(sum_of(mine, series), missing, Deviation::kAllan, kAtOnce))
    mine.points[point.m] = point;
  std::vector<DeviationPoint> points;
  points.reserve(m.size());
  for (const std::size_t each : m) points.push_back(mine.points.at(each));
  return points;
}

std::vector<double> KnownAngles::gapped(const AskedSeries& series, std::span<const std::size_t> m) {
  if (!known(series).finite) return gapped_deviation(series.values(), m);
  std::vector<double> found;
  found.reserve(m.size());
  for (const DeviationPoint& point : points(series, m))
    found.push_back(series.size() < 3 * point.m ? std::numeric_limits<double>::quiet_NaN()
                                                : std::sqrt(point.variance));
  return found;
}

}  // namespace ifog
