// SPDX-License-Identifier: Apache-2.0
// Computes the properties of a type from the results of its gyros, and improves their models with them.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "filters/population/population.h"
#include "tools/ifog/fleet/results.h"

namespace ifog::tools {

// The diagnosed gyros with the content of their diagnoses.
struct Diagnosed {
  std::vector<std::size_t> gyros;
  std::map<std::size_t, Model> models;
  std::map<std::size_t, std::map<std::string, nlohmann::json>> noise;  // by axis: "noise" of the diagnoses
  std::vector<FoundInGyro> found;                                      // all effects of all models
};

// A gyro whose diagnosis or model cannot be read is in `failed`; the next run diagnoses it again.
Diagnosed gather_diagnosed(const Results& results, const Manifest& manifest, const std::string& options,
                           std::vector<Population::Failure>& failed);

// Noise parameters of every gyro and axis, from the diagnoses.
std::vector<PopulationParameter> noise_parameters(const Diagnosed& diagnosed);

// Measurements of the type's effects, by gyro. Failed ones, and those of other captures or options, are in
// `failed` instead.
std::map<std::size_t, GyroMeasured> gather_measured(const Results& results, const Manifest& manifest,
                                                    const std::string& options, const Diagnosed& diagnosed,
                                                    const TypeToMeasure& type,
                                                    std::vector<Population::Failure>& failed);

// Tests the type's effects; in the order of `type`. level: probability of a false effect in a gyro, for all
// of them together.
std::vector<TypeEffect> judged_effects(const TypeToMeasure& type,
                                       const std::map<std::size_t, GyroMeasured>& measured,
                                       const Diagnosed& diagnosed, double level);

// Revises the type's effects from the measurements. If `forms`: the form that explains most in all gyros
// becomes the first one. Otherwise drops the weakest insignificant effect. True if changed: measure again.
bool reconsider(TypeToMeasure& type, const std::vector<TypeEffect>& judged,
                const std::map<std::size_t, GyroMeasured>& measured, double level, bool forms);

// A value per gyro for each effect of the type.
std::vector<PopulationParameter> coefficient_parameters(const std::vector<TypeEffect>& effects);

// Schema ifog.fleet/1.
nlohmann::json fleet_json(const Population& population);

// The gyro's model with the type's effects that it has, and without those it does not have. Coefficients that
// were fitted with them are conditional on the type's distribution; lines, tables and other parts are
// unchanged. Sets with_prior of `effects` for this gyro.
Model model_with_prior(const Model& own, const TypeToMeasure& type, const GyroMeasured& measured,
                       std::size_t gyro, std::vector<TypeEffect>& effects);

}  // namespace ifog::tools
