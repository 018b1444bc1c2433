// SPDX-License-Identifier: Apache-2.0
// Q, R and the state model of a sensor at rest by maximum likelihood. The likelihood is that of the record
// (Kalman innovations), the order is chosen by Schwarz' criterion (Annals of Statistics 6, 1978), the errors
// come from the curvature at the optimum.
//
// The likelihood of such models has many local optima. The starts come from the spectrum: many are drawn and
// followed in Whittle's approximation, which costs next to nothing, and the best few of its optima are then
// followed in the likelihood itself.
//
// The likelihood says which model describes the record. What a model does to the rate that is published is
// another question, and is tried: fitted to the first half of the record, the estimator run with it, judged
// on the second half by what the published rate foretells of the measurements to come (choice.h).
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
  std::optional<double> std_error;  // nothing: the optimum lies at a bound or the data do not tell
};

struct TunedModel {
  FilterSettings settings;  // state, process_noise, measurement_noise, state_parameters
  std::vector<TunedFigure> figures;
  int parameters = 0;
  double log_likelihood = 0.0;
  double bic = 0.0;  // parameters × ln n − 2 ln L; smaller is better
  // The record does not tell the walk from none: process_noise is the quickest that it might hide
  // (hidden_walk.h), where the figures of this struct but the likelihood are.
  bool walk_is_bound = false;
  std::optional<Outcome> held_out;  // of the models that were tried
  std::string passed_over;          // why, of a model that is likelier than the one chosen
};

struct TuneOptions {
  std::vector<std::string> states;  // empty: default_candidates()
  bool hold_out = true;             // try the models on the second half of the record
  unsigned threads = 0;             // 0: as many as the machine has; the result does not depend on it
  std::function<void(std::size_t done, std::size_t total)> progress;
};

struct Tuning {
  std::vector<TunedModel> models;  // best by BIC first
  std::size_t samples = 0;         // used, all axes together
  std::size_t chosen = 0;          // of `models`: by choose()
};

// axes: rad/s, NaN where missing, evenly spaced at period_s; they share one model because they will share one
// gain. Throws std::invalid_argument: fewer than 200 samples, a record that never changes, an unknown state.
Tuning tune(std::span<const std::span<const double>> axes, double period_s, const TuneOptions& options);

}  // namespace ifog
