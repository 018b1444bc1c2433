// SPDX-License-Identifier: Apache-2.0
// Q, R and state model of a sensor at rest by maximum likelihood. The likelihood is that of the record
// (Kalman innovations). The model order is chosen by Schwarz' criterion (Annals of Statistics 6, 1978). The
// errors are from the curvature at the optimum.
//
// The likelihood has many local optima. Many starts are drawn from the spectrum and optimised in Whittle's
// approximation, which is cheap; the best few are then optimised in the exact likelihood.
//
// The effect on the published rate is tested separately: fitted to the first half of the record and judged by
// its prediction of the second half (choice.h).
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filters/settings/filter_settings.h"
#include "filters/tune/outcome.h"

namespace ifog {

struct TunedFigure {
  std::string name, unit;
  double value = 0.0;
  std::optional<double> std_error;  // nullopt: at a bound, or undetermined by the data
};

struct TunedModel {
  FilterSettings settings;  // state, process_noise, measurement_noise, state_parameters
  std::vector<TunedFigure> figures;
  int parameters = 0;
  double log_likelihood = 0.0;
  double bic = 0.0;  // parameters × ln n − 2 ln L; smaller is better
  // The walk is not distinguishable from none: process_noise is its upper limit (maximum.h), and all
  // figures except the likelihood are for this value.
  bool walk_is_bound = false;
  std::optional<Outcome> held_out;  // of the models that were tested
  std::string passed_over;          // reason, if a model is more likely than the chosen one
};

struct TuneOptions {
  std::vector<std::string> states;  // empty: default_candidates()
  bool hold_out = true;             // test the models on the second half of the record
  unsigned threads = 0;             // 0: number of processors; does not affect the result
  std::function<void(std::size_t done, std::size_t total)> progress;
};

struct Tuning {
  std::vector<TunedModel> models;  // by BIC, best first
  std::size_t samples = 0;         // used, all axes together
  std::size_t chosen = 0;          // index in `models`, by choose()
};

// axes: rad/s, NaN where missing, at period_s; they share one model because they share one gain. Throws
// std::invalid_argument: fewer than 200 samples, a constant record, an unknown state.
Tuning tune(std::span<const std::span<const double>> axes, double period_s, const TuneOptions& options);

}  // namespace ifog
