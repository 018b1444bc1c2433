// Q, R and the state model of a sensor at rest by maximum likelihood. The likelihood is exact (Kalman
// innovations), the order is chosen by Schwarz' criterion (Annals of Statistics 6, 1978), the errors come
// from the curvature at the optimum.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filters/settings/filter_settings.h"

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
};

struct TuneOptions {
  std::vector<std::string> states;  // empty: default_candidates()
  std::function<void(std::size_t done, std::size_t total)> progress;
};

struct Tuning {
  std::vector<TunedModel> models;  // best first
  std::size_t samples = 0;         // used, all axes together
};

// axes: rad/s, NaN where missing, evenly spaced at period_s; they share one model because they will share one
// gain. Throws std::invalid_argument: fewer than 200 samples, a record that never changes, an unknown state.
Tuning tune(std::span<const std::span<const double>> axes, double period_s, const TuneOptions& options);

}  // namespace ifog
