// SPDX-License-Identifier: Apache-2.0
// All adaptation rules on one record, with the same settings: what each does at rest, in motion, to the
// heading, and after a change of rate. The figures are of the causal Estimator the daemon runs, not of a
// copy. What is kept of a sample is in files where the record is long.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filters/allan/stretches.h"
#include "filters/estimator/estimator.h"
#include "filters/series/samples.h"
#include "filters/settings/filter_settings.h"

namespace ifog {

// One record of a sensor: rates in rad/s, NaN where a sample is missing.
struct ComparisonInput {
  std::span<const double> time_s;                  // strictly increasing
  std::vector<std::span<const double>> rate;       // by axis, as long as time_s
  std::vector<std::span<const double>> reference;  // by axis; empty where there is none
  double period_s = 0.0;                           // nominal, > 0
  std::vector<Stretch> at_rest;                    // std_radps and adev_radps are of these; none: of all
};

// The averaging times at which the Allan deviation is compared, s.
inline constexpr std::array<double, 4> kComparedTaus{0.1, 1.0, 10.0, 100.0};

// Samples until the output has made 90 % of a step added to the record, median over the places it was added
// at.
struct StepResponse {
  double size_sigma = 0.0;        // in sigma of one sample, sqrt(R)
  std::optional<double> samples;  // nothing: not reached within the window looked at
};

struct ComparisonRow {
  std::string rule;  // "raw" for the record itself
  int axis = 0;
  std::optional<double> rmse_radps, bias_radps, lag_s;  // against the reference, where there is one
  double std_radps = 0.0;                               // at rest, as the deviations
  std::array<std::optional<double>, kComparedTaus.size()>
      adev_radps;                // nothing: the record is too short or too coarse
  double heading_end_rad = 0.0;  // ∫(denoised − compensated)dt over the record
  double heading_max_rad = 0.0;  // its largest excursion
  // By the innovations of the filter at rest, outside manoeuvres: within one its rule learns nothing and the
  // output is not its own. Nothing when fewer than forty samples are at rest.
  std::optional<double> whiteness_lag1;  // lag-1 autocorrelation, 0 when white
  // Σ n ρ_k² / 20 over lags 1 … 20: 1 when white, larger when not (Box and Pierce)
  std::optional<double> whiteness_excess;
  // Innovation² over its own variance, 1 when the rule knows its noise: the mean, which a few blows can carry
  // away, and the median over the median of a normal law's.
  std::optional<double> nis_mean, nis_typical;
  double share_at_rest = 1.0;  // of the samples, outside manoeuvres
  std::array<StepResponse, 2> step{};
};

struct ComparisonOptions {
  FilterSettings settings;  // the rule's name is replaced by each of `rules`
  std::vector<std::string> rules;
  bool keep_denoised = false;
  std::function<void(std::size_t done, std::size_t total)> progress;
};

// Rows in the order of `rules`, "raw" first, by axis within a rule.
struct Comparison {
  std::vector<ComparisonRow> rows;
  // by rule (without raw), then axis; empty unless they are to be kept
  std::vector<std::vector<Samples>> denoised;
};

// Throws std::invalid_argument: a setting the estimator refuses, columns of unequal length.
Comparison compare_rules(const ComparisonInput& in, const ComparisonOptions& options);

// Variance of the white noise of a record, whatever smooth motion there is, by the median square of third
// differences. They have 1 + 9 + 9 + 1 = 20 times its variance, and the median square of a standard normal is 0.455.
// rate: rad/s, NaN where missing; 0: too short.
[[nodiscard]] double third_difference_noise(std::span<const double> rate);

}  // namespace ifog
