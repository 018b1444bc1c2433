// SPDX-License-Identifier: Apache-2.0
// A type of gyro as its members show it: the effects it has, how its parameters are spread, who stands out.
// Data, and the judgement of one effect.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "filters/population/random_effects.h"
#include "filters/population/robust.h"
#include "filters/population/two_groups.h"
#include "filters/population/type_effects.h"

namespace ifog {

// Fewer say nothing of a type.
inline constexpr std::size_t kFewestOfType = 5;

// One of the type's effects in one gyro.
struct EffectInGyro {
  std::size_t gyro = 0;
  std::optional<Estimate> own;    // by its captures alone
  std::string not_measured;       // why there is none
  double likelihood_ratio = 0.0;  // twice the log-likelihood its captures lose without it
  bool found_alone = false;       // its own diagnosis found it
  TypePrior others;               // what the other gyros say of it
  double probability = 0.0;       // that it has the effect
  double chance = 1.0;            // that a gyro without it shows as much
  bool found = false;
  std::optional<Estimate> with_prior;  // where found: what its captures and the type say together
};

struct TypeEffect {
  Effect effect;                // its coefficient the mean of those that have it, with the error of that
  std::size_t found_alone = 0;  // gyros
  std::size_t found = 0;        // gyros
  TypePrior prior;              // of those that do not stand out
  std::size_t set_aside = 0;    // gyros that have the effect and stand out of those that have it
  RandomEffects all;            // of all gyros, with the effect or without
  std::vector<EffectInGyro> gyros;
};

// Something that every gyro has a value of.
struct PopulationParameter {
  std::string name, axis, unit;  // "N", "" or "y", SI
  bool logarithmic = false;      // spread, and what stands out, by the logarithm
  std::vector<std::size_t> gyros;
  std::vector<Estimate> values;  // of those; the error zero where there is none
  std::vector<double> z;         // robust, of each
  RobustSpread robust;           // of the logarithm where that is meant
  std::optional<RandomEffects> spread;
};

struct StandingOut {
  std::size_t gyro = 0, parameter = 0;
  double z = 0.0;
};

struct Population {
  std::string type;
  double significance = 0.01;
  std::vector<std::string> serials;
  struct Failure {
    std::size_t gyro;
    std::string why;
  };
  std::vector<Failure> failed;
  std::vector<TypeEffect> effects;
  std::vector<PopulationParameter> parameters;
  std::vector<StandingOut> standing_out;  // the farthest first
  std::vector<FoundInGyro> own;           // effects that only single gyros have
  std::vector<std::string> remarks;
};

// Fills in everything but with_prior from effect.gyros' own estimates: the type's prior, and for each gyro
// what the others and its captures say. A gyro has the effect when one without it would show as much with a
// chance of no more than `level`, and having it is the likelier. Estimates fewer than two: nothing is found.
void judge(TypeEffect& effect, double level);

// Whether so many gyros would show this if none had it: chi-square of the prior's three numbers, twice the
// log-likelihood as `prior` has it.
bool is_of_type(const TypePrior& prior, double level);

// z, robust spread and, where errors are known, random effects of a parameter from its values.
void describe(PopulationParameter& parameter);

// Those among described parameters that stand out.
std::vector<StandingOut> standing_out(const std::vector<PopulationParameter>& parameters);

}  // namespace ifog
