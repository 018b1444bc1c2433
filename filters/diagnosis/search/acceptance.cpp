// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/acceptance.h"

#include <algorithm>

#include "filters/diagnosis/checks/chow_test.h"
#include "filters/diagnosis/checks/cross_validation.h"
#include "filters/diagnosis/checks/hausman_test.h"
#include "filters/diagnosis/checks/outliers.h"
#include "filters/diagnosis/checks/proof.h"
#include "filters/diagnosis/checks/start_of_record.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/diagnosis/search/effective_tries.h"
#include "filters/diagnosis/search/fit_to_readings.h"

namespace ifog {
namespace {

constexpr double kWorse = 1.05;
constexpr double kWorseSlowly = 1.2;
constexpr double kOpposed = 2.5;     // standard deviations
constexpr double kUnsteady = 16.27;  // chi-square of three degrees of freedom, 0.1 %
constexpr double kUnsteadyShare = 0.2;
constexpr double kCancel = 0.2;  // of either band power, what is left of both together

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

// Beside the effects that came after it, and without the blocks that no model explains: where a sensor was
// knocked about, a step fits some of it.
bool step_stands(const BlockData& reconstructed, const SearchResult& found, std::size_t at,
                 double significance) {
  std::vector<Candidate> ordered = found.fitted;
  std::rotate(ordered.begin() + static_cast<std::ptrdiff_t>(at),
              ordered.begin() + static_cast<std::ptrdiff_t>(at) + 1, ordered.end());
  const double ratio = ratio_without_outliers(reconstructed, found.fitted, at, found.noise.shape);
  return tail(ratio, 1) * found.tries < significance && step_persists(reconstructed, {ordered, found.noise});
}

bool warm_up_stands(const BlockData& reconstructed, const SearchResult& found, std::size_t at,
                    double significance) {
  const double ratio = ratio_beside_the_start(reconstructed, found.fitted, at, found.noise.shape);
  return tail(ratio, 1) * found.tries < significance;
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

std::optional<std::size_t> standing_twice(const std::vector<Chosen>& chosen) {
  constexpr double kNear = 1.1;
  const auto near = [](double a, double b) {
    return a == b || (a > 0.0 && b > 0.0 && std::max(a, b) < kNear * std::min(a, b));
  };
  for (std::size_t j = 1; j < chosen.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) {
      const Candidate &a = chosen[i].candidate, &b = chosen[j].candidate;
      if (a.searched() && a.same_shape(b) && near(a.time_constant_s, b.time_constant_s) &&
          near(a.second_time_constant_s, b.second_time_constant_s) && near(a.half_width, b.half_width))
        return chosen[i].likelihood_ratio < chosen[j].likelihood_ratio ? i : j;
    }
  return std::nullopt;
}

std::optional<std::size_t> cancelling(const BlockData& data, const SearchResult& found) {
  const BlockGrid& grid = data.grid;
  std::vector<Eigen::VectorXd> parts;
  Eigen::Index at = grid.constants();
  for (const Chosen& each : found.chosen) {
    parts.push_back(regressors(data, each.candidate).col(0) * found.coefficients[at]);
    centre_records(grid, parts.back());
    at += each.candidate.width();
  }
  for (std::size_t j = 1; j < parts.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) {
      const Candidate &a = found.chosen[i].candidate, &b = found.chosen[j].candidate;
      if (a.form != Form::kBandPower || !a.same_shape(b)) continue;
      if ((parts[i] + parts[j]).norm() < kCancel * std::min(parts[i].norm(), parts[j].norm()))
        return found.chosen[i].likelihood_ratio < found.chosen[j].likelihood_ratio ? i : j;
    }
  return std::nullopt;
}

void subtract_found(const BlockData& data, const SearchResult& found, std::vector<EvenError>& errors) {
  subtract_effects(data, candidates_of(found.chosen), found.noise.shape, found.coefficients, errors);
}

double score_on(const BlockGrid& grid, const BlockData& channels, const SearchResult& found) {
  if (grid.valid == channels.grid.valid) return score_of(found);
  BlockData data = channels;
  data.grid.valid = grid.valid;
  SearchResult there = found;
  there.noise = fit_noise(data.grid, design(data, found.fitted), found.noise.shape);
  return score_of(there);
}

SearchResult without_effect(const BlockData& data, const BlockData& reconstructed, SearchResult found,
                            std::size_t at) {
  found.chosen.erase(found.chosen.begin() + static_cast<std::ptrdiff_t>(at));
  found.fitted.erase(found.fitted.begin() + static_cast<std::ptrdiff_t>(at));
  std::erase_if(found.alternatives, [&](const Alternative& other) { return other.of == at; });
  for (Alternative& other : found.alternatives) other.of -= other.of > at ? 1 : 0;
  for (std::size_t i = 0; i < found.chosen.size(); ++i) found.chosen[i].candidate = found.fitted[i];
  const Columns columns = design(reconstructed, found.fitted);
  found.noise = fit_noise(reconstructed.grid, columns);
  found.coefficients = solve(reconstructed.grid, found.noise.shape, columns, &found.covariance);
  found.fitted_coefficients = found.coefficients;
  fit_to_readings(data, reconstructed, found);
  return found;
}

bool stands(const BlockData& reconstructed, const SearchResult& found, std::size_t at, double significance) {
  const NoiseShape& shape = found.noise.shape;
  const double ratio = std::min(ratio_without_outliers(reconstructed, found.fitted, at, shape),
                                ratio_in_changing_noise(reconstructed, found.fitted, at, shape));
  if (tail(ratio, 1) * found.tries >= significance) return false;
  if (reconstructed.grid.dwells) return true;  // there contiguous parts are held out in turn
  const Unsteadiness unsteady = unsteadiness(reconstructed, found.fitted, at, shape);
  return unsteady.square < kUnsteady || unsteady.share < kUnsteadyShare;
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
                                            double significance, SearchResult& found,
                                            std::vector<EvenError>& errors) {
  std::vector<Effect> dropped;
  const auto drop = [&](std::size_t i) {
    dropped.push_back(effect_of(data, found.chosen[i].candidate));
    found = without_effect(data, reconstructed, std::move(found), i);
    subtract_found(data, found, errors);
  };
  for (std::size_t i = 0; i < found.fitted.size();) {
    const Candidate& each = found.fitted[i];
    const bool proven = each.form == Form::kStep     ? step_stands(reconstructed, found, i, significance)
                        : each.form == Form::kWarmUp ? warm_up_stands(reconstructed, found, i, significance)
                                                     : each.channel == Candidate::kNone ||
                                                           stands(reconstructed, found, i, significance);
    if (proven)
      ++i;
    else
      drop(i);
  }
  while (!holds(reconstructed, found, errors, &EvenError::held_out)) {
    const std::optional<std::size_t> least = least_certain(found.chosen);
    if (!least) break;
    drop(*least);
  }
  return dropped;
}

}  // namespace ifog
