// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/fit_to_readings.h"

#include <cmath>

namespace ifog {
namespace {

// Share of the effect's RMS that readings may add before anything is changed for their sake.
constexpr double kMatters = 0.1;
constexpr double kLongest_s = 3600.0;
constexpr double kLeastGain = 0.8;  // and what the change must leave of it

Eigen::VectorXd centred(const BlockGrid& grid, Eigen::VectorXd values) {
  centre_records(grid, values);
  return values;
}

struct Match {
  double left = 0.0;   // RMS of what the correction leaves, over that of the effect
  double share = 1.0;  // of the coefficient
};

Match match(const BlockData& recorded, const Candidate& candidate, const Eigen::VectorXd& effect, bool free) {
  const Eigen::VectorXd seen = centred(recorded.grid, regressors(recorded, candidate).col(0));
  Match found;
  if (free) found.share = seen.dot(effect) / std::max(seen.squaredNorm(), 1e-300);
  found.left = (found.share * seen - effect).norm() / std::max(effect.norm(), 1e-300);
  return found;
}

}  // namespace

void fit_to_readings(const BlockData& recorded, const BlockData& reconstructed, SearchResult& result) {
  Eigen::Index at = recorded.grid.constants();
  for (Chosen& chosen : result.chosen) {
    const Eigen::Index place = at;
    at += chosen.candidate.width();
    const bool memory = chosen.candidate.form == Form::kRate || chosen.candidate.form == Form::kSecondRate ||
                        chosen.candidate.form == Form::kLagged;
    if (!memory) continue;
    const Eigen::VectorXd effect =
        centred(reconstructed.grid, regressors(reconstructed, chosen.candidate).col(0));
    const Match as_found = match(recorded, chosen.candidate, effect, false);
    if (as_found.left < kMatters) continue;
    Candidate best = chosen.candidate;
    Match closest = match(recorded, best, effect, true);
    const auto attempt = [&](double factor) {
      Candidate trial = best;
      trial.time_constant_s *= factor;
      const Match found = match(recorded, trial, effect, true);
      if (!(found.left < closest.left)) return false;
      closest = found;
      best = trial;
      return true;
    };
    // Wider only: readings make a correction worse, not slower.
    for (const double factor : {2.0, 1.414, 1.189, 1.091}) {
      while (best.time_constant_s < kLongest_s && attempt(factor)) {
      }
    }
    if (closest.left > kLeastGain * as_found.left) continue;
    chosen.candidate = best;
    result.coefficients[place] *= closest.share;
    result.covariance.row(place) *= closest.share;
    result.covariance.col(place) *= closest.share;
  }
}

}  // namespace ifog
