// SPDX-License-Identifier: Apache-2.0
// Runs all adaptation rules on one record with the same settings: at rest, in motion, heading, step response.
// Uses the daemon's causal Estimator. Values per sample are in files if the record is long.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filters/allan/deviation.h"
#include "filters/estimator/estimator.h"
#include "filters/series/samples.h"
#include "filters/settings/filter_settings.h"

namespace ifog {

// One record of a sensor: rates in rad/s, NaN if missing.
struct ComparisonInput {
  std::span<const double> time_s;                  // strictly increasing
  std::vector<std::span<const double>> rate;       // by axis, as long as time_s
  std::vector<std::span<const double>> reference;  // by axis; empty if there is none
  double period_s = 0.0;                           // nominal, > 0
  std::vector<Stretch> at_rest;                    // for std_radps and adev_radps; empty: all samples
};

// Averaging times of the compared Allan deviations.
inline constexpr const auto& kComparedTaus = kReportedTaus;

// Samples until the output reaches 90 % of a step added to the record; median over the places of the step.
struct StepResponse {
  double size_sigma = 0.0;        // in standard deviations of a sample, sqrt(R)
  std::optional<double> samples;  // nullopt: not reached within the window
};

struct ComparisonRow {
  std::string rule;  // "raw" for the record itself
  int axis = 0;
  std::optional<double> rmse_radps, bias_radps, lag_s;  // relative to the reference, if any
  double std_radps = 0.0;                               // at rest, like the deviations
  ReportedDeviations adev_radps;
  double heading_end_rad = 0.0;  // ∫(denoised − compensated)dt over the record
  double heading_max_rad = 0.0;  // its largest magnitude
  // From the innovations of the filter at rest outside manoeuvres, where the rule learns. nullopt if fewer
  // than forty samples are at rest.
  std::optional<double> whiteness_lag1;  // autocorrelation at lag 1, 0 if white
  // Σ n ρ_k² / 20 over lags 1 … 20: 1 if white, else larger (Box and Pierce)
  std::optional<double> whiteness_excess;
  // Innovation² / its variance, 1 if the rule knows its noise: the mean, sensitive to a few shocks, and the
  // median relative to a normal distribution's.
  std::optional<double> nis_mean, nis_typical;
  double share_at_rest = 1.0;  // share of the samples outside manoeuvres
  std::array<StepResponse, 2> step{};
};

struct ComparisonOptions {
  FilterSettings settings;  // `rule` is replaced by each of `rules`
  std::vector<std::string> rules;
  bool keep_denoised = false;
  std::function<void(std::size_t done, std::size_t total)> progress;
};

// Rows in the order of `rules`, "raw" first; by axis within a rule.
struct Comparison {
  std::vector<ComparisonRow> rows;
  // by rule (without raw), then axis; empty unless keep_denoised
  std::vector<std::vector<Samples>> denoised;
};

// Throws std::invalid_argument for an invalid setting or columns of unequal length.
Comparison compare_rules(const ComparisonInput& in, const ComparisonOptions& options);

// Variance of a record's white noise in any smooth motion, from the median square of third differences. Their
// variance is 1 + 9 + 9 + 1 = 20 times the noise's; the median square of a standard normal is 0.455. rate:
// rad/s, NaN if missing; 0: too short.
[[nodiscard]] double third_difference_noise(std::span<const double> rate);

}  // namespace ifog
