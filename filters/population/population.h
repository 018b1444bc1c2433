// SPDX-License-Identifier: Apache-2.0
// Statistics of a type of gyro: its effects, the spread of its parameters, outliers; and the decision on one
// effect.
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

// Fewer members give no statistics.
inline constexpr std::size_t kFewestOfType = 5;

// One effect of the type in one gyro.
struct EffectInGyro {
  std::size_t gyro = 0;
  std::optional<Estimate> own;    // from its captures alone
  std::string not_measured;       // reason if there is no estimate
  double likelihood_ratio = 0.0;  // loss of twice the log-likelihood without it
  bool found_alone = false;       // its own diagnosis found it
  TypePrior others;               // prior from the other gyros
  double probability = 0.0;       // posterior probability of the effect
  double chance = 1.0;            // probability that a gyro without it shows as much
  bool found = false;
  std::optional<Estimate> with_prior;  // posterior estimate, if found
};

struct TypeEffect {
  Effect effect;                // its coefficient is the mean of those that have it, with standard error
  std::size_t found_alone = 0;  // gyros
  std::size_t found = 0;        // gyros
  TypePrior prior;              // of the gyros that are no outliers
  std::size_t set_aside = 0;    // number of outliers among those that have the effect
  RandomEffects all;            // of all gyros, with or without the effect
  std::vector<EffectInGyro> gyros;
};

// A parameter that every gyro has.
struct PopulationParameter {
  std::string name, axis, unit;  // "N", "" or "y", SI
  bool logarithmic = false;      // spread and outliers are of the logarithm
  std::vector<std::size_t> gyros;
  std::vector<Estimate> values;  // of these gyros; error zero if unknown
  std::vector<double> z;         // robust z of each
  RobustSpread robust;           // of the logarithm if `logarithmic`
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
  std::vector<StandingOut> standing_out;  // largest first
  std::vector<FoundInGyro> own;           // effects of single gyros only
  std::vector<std::string> remarks;
};

// Sets everything except with_prior from the gyros' own estimates: the type's prior and each gyro's result. A
// gyro has the effect if one without it would show as much with probability `level` at most, and if having it
// is more likely. With fewer than two estimates nothing is found.
void judge(TypeEffect& effect, double level);

// True if chance does not explain the effect's frequency: chi-square with the prior's three parameters, for
// its likelihood ratio.
bool is_of_type(const TypePrior& prior, double level);

// Sets z, robust spread and, if errors are known, random effects of a parameter.
void describe(PopulationParameter& parameter);

// Outliers among described parameters.
std::vector<StandingOut> standing_out(const std::vector<PopulationParameter>& parameters);

}  // namespace ifog
