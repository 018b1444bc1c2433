// SPDX-License-Identifier: Apache-2.0
// Noise coefficients with the field's names and units, the same in every command.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filters/allan/noise/noise_coefficients.h"
#include "filters/model_file/model.h"
#include "filters/rest/noise_change.h"

namespace ifog::report {

// The coefficients in the order Q N B K R: names, SI unit, field unit, and the factor between them.
struct NamedCoefficient {
  const char* letter;
  const char* meaning;
  const char* si_unit;
  const char* unit;
  double factor;
  NoiseCoefficient NoiseCoefficients::*member;
  std::optional<double> NoiseTerms::*term;  // the same in a model
};
const std::vector<NamedCoefficient>& named_coefficients();

// Two digits, rounded up, so that the printed bound holds.
std::string bound_text(double upper);

// One line each: value and error, or the bound of a term that is not significant.
std::string coefficient_lines(const NoiseCoefficients& found);

// {Q|N|B|K|R: {value, std_error, upper, unit, present, from_s}}, SI.
nlohmann::ordered_json coefficients_json(const NoiseCoefficients& found);

// {sigma_radps, correlation_s, lower_s, upper_s, K, K_until_s} of a correlated bias; null if not found.
nlohmann::ordered_json markov_json(const std::optional<MarkovNoise>& found);

// [{from_s, to_s, times, low_hz, high_hz}]; empty if the noise is constant.
nlohmann::ordered_json noise_changes_json(std::span<const NoiseChange> changes);

}  // namespace ifog::report
