// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/acceptance.h"

#include <algorithm>

#include "filters/diagnosis/checks/cross_validation.h"
#include "filters/diagnosis/checks/hausman_test.h"
#include "filters/diagnosis/checks/proof.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/diagnosis/search/effective_tries.h"
#include "filters/diagnosis/search/fit_to_readings.h"

namespace ifog {
namespace {

constexpr double kWorse = 1.05;
constexpr double kWorseSlowly = 1.2;
constexpr double kOpposed = 2.5;  // standard deviations

// Slow noise that happens to run against the effects hides them in the raw error, and their removal lays it
// bare. That is no reason to leave them out where noise as large as the model's does it now and then. What is
// not corrected, a line say, leaves the error as it was, and is only beside them here: of a structure that
// sways it may be made in part, and then its size is not what a plain fit finds.
bool slow_noise_may_oppose(const BlockData& reconstructed, const SearchResult& found) {
  if (found.fitted.empty()) return true;
  const Columns all = design(reconstructed, found.fitted);
  const Eigen::Index k = reconstructed.grid.constants();
  Columns columns = all.leftCols(1 + k);
  Eigen::VectorXd corrected = Eigen::VectorXd::Zero(all.rows());
  Eigen::Index at = 1 + k;
  for (const Candidate& each : found.fitted) {
    const auto mine = all.middleCols(at, each.width());
    if (each.corrected()) {
      corrected += mine * found.fitted_coefficients.segment(at - 1, each.width());
    } else {
      columns.conservativeResize(Eigen::NoChange, columns.cols() + each.width());
      columns.rightCols(each.width()) = mine;
    }
    at += each.width();
  }
  columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
  columns.rightCols(1) = corrected;
  const Eigen::Index taken_out = columns.cols() - 1;
  const Eigen::VectorXd taken = Eigen::VectorXd::Ones(taken_out);
  const Eigen::MatrixXd known = Eigen::MatrixXd::Zero(taken_out, taken_out);
  return disagreement(reconstructed.grid, found.noise, columns, k, taken, known) < kOpposed;
}

// Beside the effects that came after it.
bool step_stands(const BlockData& reconstructed, const SearchResult& found, std::size_t at) {
  std::vector<Candidate> ordered = found.fitted;
  std::rotate(ordered.begin() + static_cast<std::ptrdiff_t>(at),
              ordered.begin() + static_cast<std::ptrdiff_t>(at) + 1, ordered.end());
  return step_persists(reconstructed, {ordered, found.noise});
}

}  // namespace

std::optional<std::size_t> least_certain(const std::vector<Chosen>& chosen) {
  std::optional<std::size_t> least;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i].candidate.corrected()) continue;
    if (!least || chosen[i].likelihood_ratio < chosen[*least].likelihood_ratio) least = i;
  }
  return least;
}

void subtract_found(const BlockData& data, const SearchResult& found, std::vector<EvenError>& errors) {
  subtract_effects(data, candidates_of(found.chosen), found.noise.shape, found.coefficients, errors);
}

SearchResult without_effect(const BlockData& data, const BlockData& reconstructed, SearchResult found,
                            std::size_t at) {
  found.chosen.erase(found.chosen.begin() + static_cast<std::ptrdiff_t>(at));
  found.fitted.erase(found.fitted.begin() + static_cast<std::ptrdiff_t>(at));
  std::erase_if(found.alternatives, [&](const Alternative& other) { return other.of == at; });
  for (Alternative& other : found.alternatives) other.of -= other.of > at ? 1 : 0;
  for (std::size_t i = 0; i < found.chosen.size(); ++i) found.chosen[i].candidate = found.fitted[i];
  const Columns columns = design(reconstructed, found.fitted);
  found.noise = fit_noise(reconstructed.grid, columns, found.noise.shape);
  found.coefficients = solve(reconstructed.grid, found.noise.shape, columns, &found.covariance);
  found.fitted_coefficients = found.coefficients;
  fit_to_readings(data, reconstructed, found);
  return found;
}

bool holds(const BlockData& reconstructed, const SearchResult& found, const std::vector<EvenError>& errors,
           SharedSamples EvenError::*after) {
  if (std::all_of(errors.begin(), errors.end(),
                  [&](const EvenError& error) { return (error.*after).is(error.before); }))
    return true;
  const auto grows = [&](double pieces, double most) {
    double without = 0.0;
    double with = 0.0;
    for (const EvenError& error : errors) {
      const auto count = std::max<std::size_t>(
          1, static_cast<std::size_t>(static_cast<double>(error.before.size()) / pieces));
      without += variance_of(means_over(error.before, count));
      with += variance_of(means_over(error.*after, count));
    }
    return with > most * without;
  };
  return !grows(2000.0, kWorse) &&
         (!grows(20.0, kWorseSlowly) || slow_noise_may_oppose(reconstructed, found));
}

std::vector<Effect> drop_what_does_not_hold(const BlockData& data, const BlockData& reconstructed,
                                            SearchResult& found, std::vector<EvenError>& errors) {
  std::vector<Effect> dropped;
  const auto drop = [&](std::size_t i) {
    dropped.push_back(effect_of(data, found.chosen[i].candidate));
    found = without_effect(data, reconstructed, std::move(found), i);
    subtract_found(data, found, errors);
  };
  for (std::size_t i = 0; i < found.fitted.size();) {
    const bool proven = found.fitted[i].form != Form::kStep || step_stands(reconstructed, found, i);
    if (proven)
      ++i;
    else
      drop(i);
  }
  while (!holds(reconstructed, found, errors, &EvenError::held_out)) {
    // The one without which least is left on held-out data.
    std::optional<std::size_t> worst;
    double least = 0.0;
    for (std::size_t i = 0; i < found.chosen.size(); ++i) {
      if (!found.chosen[i].candidate.corrected()) continue;
      const SearchResult rest = without_effect(data, reconstructed, found, i);
      subtract_found(data, rest, errors);
      double left = 0.0;
      for (const EvenError& error : errors) left += variance_of(error.held_out);
      if (!worst || left < least) worst = i, least = left;
    }
    if (!worst) break;
    drop(*worst);
  }
  return dropped;
}

}  // namespace ifog
