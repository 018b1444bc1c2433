// SPDX-License-Identifier: Apache-2.0
// Uncertainty of the fit. A coefficient's error depends on the slow noise, of which a record has few
// independent pieces. With the most likely noise alone the intervals would be too narrow, especially if the
// most likely walk is zero. So coefficients are averaged over the possible noise parameters, weighted by
// restricted likelihood. Searched time constants are free parameters (Gauss-Newton).
#pragma once

#include <string_view>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Parameter of an effect that the search optimised: a time constant, or a transition's half width or centre.
struct SearchedParameter {
  std::size_t effect = 0;
  double Candidate::*value = nullptr;

  // The candidate with this parameter moved, in units in which the fit is linear: the logarithm of a time constant
  // or half width, a centre in half widths.
  [[nodiscard]] Candidate moved(Candidate candidate, double by) const;
  // Name in the effect; "" for a centre, which is the effect's reference.
  [[nodiscard]] std::string_view name_in(const Effect& of) const;
};

struct JointFit {
  NoisePosterior noise;
  // Nuisances (one constant per record), one coefficient per effect, then `searched`, in their units.
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
  // Covariance of the coefficients with the searched parameters fixed. It decides on significance, since
  // without an effect time constants have no influence.
  Eigen::MatrixXd of_coefficients;
  std::vector<SearchedParameter> searched;

  // Index in `values` of the first searched parameter.
  [[nodiscard]] Eigen::Index first_searched() const {
    return values.size() - static_cast<Eigen::Index>(searched.size());
  }
};

// effects: as the search left them; best: most likely noise; coefficients: of the effects, without which the searched
// parameters are fixed.
JointFit joint_fit(const BlockData& data, const std::vector<Candidate>& effects, const NoiseFit& best,
                   const Eigen::VectorXd* coefficients = nullptr);

}  // namespace ifog
