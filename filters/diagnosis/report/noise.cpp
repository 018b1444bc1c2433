// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/report.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "filters/allan/noise/noise_coefficients.h"
#include "filters/diagnosis/record/even_grid.h"

namespace ifog {
namespace {

void put(const NoiseCoefficient& found, std::optional<double>& value, std::optional<double>& error) {
  if (!found.present) return;
  value = found.value;
  error = found.std_error;
}

// Residual of a record at rest, NaN elsewhere.
Samples error_at_rest(const Record& record, const EvenError& error, double sample_s) {
  Samples left = *error.after;
  if (record.at_rest.empty()) return left;
  Samples resting(record.time_s.size(), std::nan(""));
  for (const Stretch& part : record.at_rest)
    std::fill(resting.begin() + part.begin, resting.begin() + part.end, 1.0);
  const Samples rests = on_even_grid(record, sample_s, resting);
  for (std::size_t i = 0; i < left.size(); ++i)
    if (std::isnan(rests[i])) left[i] = std::nan("");
  return left;
}

// All records in sequence.
NoiseCoefficients coefficients_at_rest(const std::vector<Record>& records,
                                       const std::vector<EvenError>& errors, double sample_s) {
  Samples all;
  std::vector<Stretch> parts;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Samples left = error_at_rest(records[r], errors[r], sample_s);
    for (const Stretch& part : stretches({}, left, {}))
      parts.push_back({all.size() + part.begin, all.size() + part.end, part.lost});
    all.append(left);
  }
  return noise_coefficients(AngleSum(all, parts), sample_s);
}

void write_changes(const std::vector<Record>& records, const std::vector<EvenError>& errors, double sample_s,
                   Diagnosis& diagnosis) {
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Samples left = error_at_rest(records[r], errors[r], sample_s);
    const std::vector<NoiseChange> found =
        noise_changes(left, stretches({}, left, {}), sample_s, [&](std::size_t i) {
          return errors[r].origin.in_s(errors[r].start_s + static_cast<double>(i) * sample_s);
        });
    for (const NoiseChange& change : found) diagnosis.noise_changes.push_back({records[r].name, change});
    if (const std::string words = in_words(found); !words.empty())
      diagnosis.remarks.push_back((records.size() > 1 ? records[r].name + ": " : "") + words);
  }
}

// Adds the Gauss-Markov alternatives to the posterior, as the regression models that bias as a random walk.
void weigh_return(const NoiseCoefficients& found, double sample_s, NoisePosterior& posterior) {
  if (!found.markov) return;
  posterior.parts.clear();
  for (const GaussMarkovChance& chance : found.markov->chances) {
    const double flicker = chance.variances[kB] * std::log(kFlickerSpacing) / std::numbers::pi;
    posterior.parts.push_back({chance.weight, chance.variances[kN] * sample_s, 0.0, flicker,
                               0.5 * chance.variances[kK] * chance.correlation,
                               chance.correlation * sample_s});
  }
}

}  // namespace

void write_noise(const std::vector<Record>& records, const std::vector<EvenError>& errors,
                 const BlockGrid& grid, const NoiseFit& regression, Diagnosis& diagnosis) {
  NoiseTerms &value = diagnosis.noise, &error = diagnosis.noise_error;
  if (grid.dwells) {
    value = noise_terms(regression.shape, regression.white_variance, grid.block_s);
    // Degrees of freedom of the dwells' scatter about the fit.
    double degrees = static_cast<double>(grid.used()) - static_cast<double>(grid.constants());
    for (const FoundEffect& found : diagnosis.effects)
      degrees -= static_cast<double>(found.effect.parameters.size());
    error.N = *value.N / std::sqrt(2.0 * std::max(1.0, degrees));
    return;
  }
  write_changes(records, errors, grid.sample_s, diagnosis);
  try {
    const NoiseCoefficients found = coefficients_at_rest(records, errors, grid.sample_s);
    put(found.Q, value.Q, error.Q);
    put(found.N, value.N, error.N);
    put(found.B, value.B, error.B);
    put(found.K, value.K, error.K);
    put(found.R, value.R, error.R);
    if (const std::string markov = markov_in_words(found); !markov.empty())
      diagnosis.remarks.push_back(markov);
    diagnosis.markov = found.markov;
    weigh_return(found, grid.sample_s, diagnosis.noise_posterior);
  } catch (const std::invalid_argument& reason) {
    diagnosis.remarks.push_back(std::string("no noise terms: ") + reason.what());
  }
}

}  // namespace ifog
