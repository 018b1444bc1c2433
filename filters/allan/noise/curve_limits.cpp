// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/curve_limits.h"

#include <algorithm>
#include <limits>

#include "filters/allan/confidence.h"

namespace ifog {
namespace {

constexpr double kConfidence = 0.998;  // two-sided
constexpr double kGoodPart = 0.3;      // of the measured variance

}  // namespace

CurveLimits::CurveLimits(const AngleSum& sum) : sum_(sum) {
  std::vector<std::size_t> m;
  for (std::size_t k = 1; 4 * k <= sum.longest(); k *= 2) m.push_back(k);
  points_ = deviation(sum, m);
}

void CurveLimits::assume(const TermVariances& noise) {
  const std::vector<AllanInterval> intervals =
      allan_intervals(sum_, Deviation::kAllan, points_, noise, kConfidence);
  octaves_.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const double upper = intervals[i].upper_radps;
    octaves_.push_back({points_[i].m, points_[i].variance, upper * upper});
  }
}

double CurveLimits::most(Term term) const {
  double most = std::numeric_limits<double>::infinity();
  for (const Octave& o : octaves_)
    most = std::min(most, o.upper / expected_variance(Deviation::kAllan, term, o.m));
  return most;
}

CurveLimits::Verdict CurveLimits::judge(Term term, double variance) const {
  Verdict verdict;
  double share = 0.0, fallen = 0.0;
  bool within = false;
  for (const Octave& o : octaves_) {
    const double part = variance * expected_variance(Deviation::kAllan, term, o.m);
    if (part > o.upper) {
      // Not suppressed by a filter, below which the curve rises, or quantisation.
      if (within || o.upper < fallen || term == kQ) return {true, o.m};
      if (o.measured < kGoodPart * part) fallen = o.measured;
      continue;
    }
    if (!within) verdict.from_m = o.m;
    within = true;
    share = std::max(share, part / o.measured);
  }
  verdict.refuted = verdict.from_m > 1 && share < kGoodPart;
  return verdict;
}

}  // namespace ifog
