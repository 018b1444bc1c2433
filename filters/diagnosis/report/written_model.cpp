// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/written_model.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/record/compensated_error.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/distributions/chi_squared.h"
#include "filters/effects/form.h"
#include "filters/effects/meaning.h"

namespace ifog {
namespace {

constexpr std::size_t kPieces = 2000;

double error_in_means(std::span<const double> error) {
  return variance_of(means_over(error, std::max<std::size_t>(1, error.size() / kPieces)));
}

// Of what the effects leave; each record counts by its samples.
double bias_of(const std::vector<EvenError>& errors) {
  const auto [sum, n] = sum_of(errors, &EvenError::after);
  return n > 0.0 ? sum / n : 0.0;
}

}  // namespace

void name_bias(const BlockGrid& grid, const JointFit& joint, const std::vector<EvenError>& errors,
               double uncorrected, const std::string& axis, Diagnosis& diagnosis) {
  constexpr double kClear = 5.0;  // standard deviations
  // A walk from zero has a third of its last variance on the mean; each Gauss-Markov process keeps its own.
  const double span_s = static_cast<double>(grid.used()) * grid.block_s;
  double variance = joint.covariance(0, 0) / static_cast<double>(grid.records.size());
  for (const NoisePosterior::Part& part : joint.noise.parts)
    variance += part.weight * (part.white / span_s + part.walk * span_s / 3.0 + part.markov +
                               part.flicker * static_cast<double>(joint.noise.flicker_s.size()));
  const double value = bias_of(errors) + uncorrected, sigma = std::sqrt(variance);
  const bool clear = std::abs(value) > kClear * sigma;
  // One that the noise may have made is corrected by the share of its square that is beyond the noise's.
  const double share = clear ? 1.0 : value * value / (value * value + variance);
  diagnosis.bias = ModelParameter{"coefficient", share * value, sigma, "rad/s"};
  if (!clear) return;
  FoundEffect found;
  found.effect.form = name_of(Form::kBias);
  found.effect.axis = axis;
  found.effect.meaning = meaning_of(found.effect);
  found.effect.parameters = {*diagnosis.bias};
  found.likelihood_ratio = value * value / variance;
  found.p_value = chi_squared_above(found.likelihood_ratio, 1.0);
  diagnosis.effects.push_back(std::move(found));
}

void count_rates_from_the_bias(const std::vector<EvenError>& errors, std::vector<FoundEffect>& effects,
                               bool corrected) {
  const double bias = corrected ? 0.0 : bias_of(errors);
  for (FoundEffect& found : effects) {
    if (is_reference_rate(found.effect.channel)) found.effect.reference = bias;
    if (is_reference_rate(found.effect.with_channel)) found.effect.with_reference = bias;
  }
}

void run_written_model(const std::vector<Record>& records, const Diagnosis& diagnosis, double sample_s,
                       std::vector<EvenError>& errors) {
  Model model;
  add_to_model(diagnosis, "", model);
  for (std::size_t r = 0; r < records.size(); ++r)
    errors[r].written = model.effects.empty()
                            ? errors[r].before
                            : on_even_grid(records[r], sample_s, compensated_error(records[r], model));
}

void leave_as_written(std::vector<EvenError>& errors) {
  for (EvenError& error : errors) {
    if (!error.rest.is(error.before) || error.written.is(error.before)) continue;
    if (error.held_in.size() != error.written.size()) continue;
    double sum = 0.0;
    double n = 0.0;
    for (std::size_t i = 0; i < error.written.size(); ++i) {
      const double between = error.written[i] - error.held_in[i];
      if (!std::isfinite(between)) continue;
      sum += between;
      n += 1.0;
    }
    const double mean = n > 0.0 ? sum / n : 0.0;
    Samples& held_out = error.held_out.own();
    Samples& after = error.after.own();
    for (std::size_t i = 0; i < after.size(); ++i) {
      const double between = error.written[i] - error.held_in[i] - mean;
      held_out[i] += between;
      after[i] += between;
    }
  }
}

std::optional<std::size_t> most_harmful_effect(const std::vector<Record>& records, const Diagnosis& diagnosis,
                                               std::size_t candidates, double sample_s,
                                               const std::vector<EvenError>& errors) {
  double least = 0.0;
  for (const EvenError& error : errors) least += error_in_means(error.written);
  std::optional<std::size_t> harmful;
  for (std::size_t i = 0; i < candidates; ++i) {
    const std::optional<Form> form = form_named(diagnosis.effects[i].effect.form);
    if (!form || !carries_over(*form) || diagnosis.effects[i].effect.shown_only) continue;
    Model model;
    for (std::size_t j = 0; j < diagnosis.effects.size(); ++j) {
      if (j == i || diagnosis.effects[j].effect.shown_only) continue;
      model.effects.push_back(diagnosis.effects[j].effect);
      model.effects.back().axis.clear();
    }
    model.ranges = diagnosis.ranges;
    double without = 0.0;
    for (const Record& record : records)
      without += error_in_means(on_even_grid(record, sample_s, compensated_error(record, model)));
    if (without >= least) continue;
    least = without;
    harmful = i;
  }
  return harmful;
}

}  // namespace ifog
