// SPDX-License-Identifier: Apache-2.0
// The noise coefficients of a record in the words and units of the field, the same from every command.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filters/allan/noise/noise_coefficients.h"
#include "filters/rest/noise_change.h"

namespace ifog::report {

// The coefficients in order Q N B K R with the units of the field: name, value in SI, and the factor to
// people's unit.
struct NamedCoefficient {
  const char* letter;
  const char* meaning;
  const char* si_unit;
  const char* unit;
  double factor;
  NoiseCoefficient NoiseCoefficients::*member;
};
const std::vector<NamedCoefficient>& named_coefficients();

// Two digits, never below the value: a bound that is printed has to hold as printed.
std::string bound_text(double upper);

// A line each: value and error bar, or the bound of a term that is not seen.
std::string coefficient_lines(const NoiseCoefficients& found);

// {Q|N|B|K|R: {value, std_error, upper, unit, present, from_s}}, SI.
nlohmann::ordered_json coefficients_json(const NoiseCoefficients& found);

// {sigma_radps, correlation_s, lower_s, upper_s, K, K_until_s} of a correlated bias; null where none is seen.
nlohmann::ordered_json markov_json(const std::optional<MarkovNoise>& found);

// [{from_s, to_s, times, low_hz, high_hz}], empty where the noise is the same all along.
nlohmann::ordered_json noise_changes_json(std::span<const NoiseChange> changes);

}  // namespace ifog::report
