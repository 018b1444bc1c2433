// Which filter settings are in force: what the configuration or the command line says key by key, over what
// the model file says, over the defaults.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filters/estimator/settings.h"

namespace ifog {

// Empty: not said. Meanings and units as in FilterSettings.
struct FilterChoice {
  std::optional<std::string> rule, state, weights;
  std::optional<double> process_noise, measurement_noise, floor;
  std::optional<std::vector<double>> state_parameters;
  std::optional<int> window, draws;
  std::optional<bool> follow_manoeuvres, conserve_angle;
  std::optional<std::uint64_t> seed;
};

[[nodiscard]] FilterSettings settings_in_force(const FilterChoice& choice, FilterSettings base);

}  // namespace ifog
