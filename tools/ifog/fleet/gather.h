// SPDX-License-Identifier: Apache-2.0
// From the result files of single gyros to what their type is.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "filters/population/population.h"
#include "tools/ifog/fleet/results.h"

namespace ifog::tools {

// Gyros that are diagnosed, with what their diagnoses wrote.
struct Diagnosed {
  std::vector<std::size_t> gyros;
  std::map<std::size_t, Model> models;
  std::map<std::size_t, std::map<std::string, nlohmann::json>> noise;  // by axis: "noise" of the diagnoses
  std::vector<FoundInGyro> found;                                      // all effects of all models
};

// A gyro whose diagnosis or model cannot be read is among `failed`, and diagnosed again by the next run.
Diagnosed gather_diagnosed(const Results& results, const Manifest& manifest, const std::string& options,
                           std::vector<Population::Failure>& failed);

// The noise of every gyro on every axis, by the diagnoses.
std::vector<PopulationParameter> noise_parameters(const Diagnosed& diagnosed);

// The measurements of the type's effects, by gyro. Those that failed, or belong to other captures or
// options, are among `failed` instead.
std::map<std::size_t, GyroMeasured> gather_measured(const Results& results, const Manifest& manifest,
                                                    const std::string& options, const Diagnosed& diagnosed,
                                                    const TypeToMeasure& type,
                                                    std::vector<Population::Failure>& failed);

// The type's effects, judged; in the order of `type`. level: of a false effect in a gyro, for all of them.
std::vector<TypeEffect> judged_effects(const TypeToMeasure& type,
                                       const std::map<std::size_t, GyroMeasured>& measured,
                                       const Diagnosed& diagnosed, double level);

// What the measurements say of the choice: of each effect the form that explains most in all gyros together
// comes first (where `forms` may change), and the least of those that chance would not show is
// dropped. Returns whether anything changed: then it has to be measured again.
bool reconsider(TypeToMeasure& type, const std::vector<TypeEffect>& judged,
                const std::map<std::size_t, GyroMeasured>& measured, double level, bool forms);

// A value of every gyro for each effect of the type.
std::vector<PopulationParameter> coefficient_parameters(const std::vector<TypeEffect>& effects);

}  // namespace ifog::tools
