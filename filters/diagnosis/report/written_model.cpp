// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/written_model.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/record/compensated_error.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/effects/form.h"

namespace ifog {
namespace {

constexpr std::size_t kPieces = 2000;

double error_in_means(std::span<const double> error) {
  return variance_of(means_over(error, std::max<std::size_t>(1, error.size() / kPieces)));
}

// Of what the effects leave, NaN left out; each record counts by its samples.
double bias_of(const std::vector<EvenError>& errors) {
  double sum = 0.0;
  double n = 0.0;
  for (const EvenError& error : errors)
    for (const double value : error.after) {
      if (!std::isfinite(value)) continue;
      sum += value;
      n += 1.0;
    }
  return n > 0.0 ? sum / n : 0.0;
}

}  // namespace

void count_rates_from_the_bias(const std::vector<EvenError>& errors, std::vector<FoundEffect>& effects) {
  const double bias = bias_of(errors);
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

void run_as_logged(const std::vector<Record>& records, const std::vector<Record>& logged,
                   const Diagnosis& diagnosis, double sample_s, std::vector<EvenError>& errors) {
  Model model;
  add_to_model(diagnosis, "", model);
  for (std::size_t r = 0; r < records.size(); ++r) {
    Record record = records[r];
    for (RecordChannel& channel : record.channels)
      if (const auto values = values_of(logged[r], channel.name); !values.empty()) channel.values = values;
    errors[r].logged = model.effects.empty()
                           ? errors[r].before
                           : on_even_grid(records[r], sample_s, compensated_error(record, model));
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
