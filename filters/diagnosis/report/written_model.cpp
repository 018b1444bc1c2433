// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/report.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filters/diagnosis/checks/checks.h"
#include "filters/diagnosis/record/compensated_error.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/diagnosis/report/prediction.h"
#include "filters/distributions/chi_squared.h"
#include "filters/effects/meaning.h"
#include "filters/model_file/form.h"

namespace ifog {
namespace {

// Variance that the daemon's correction leaves in means over 1/pieces of each record, summed.
double left_in(const std::vector<Record>& records, const Diagnosis& diagnosis, double sample_s,
               std::size_t pieces) {
  Model model;
  add_to_model(diagnosis, "", model);
  double sum = 0.0;
  for (const Record& record : records) {
    const Samples error = on_even_grid(record, sample_s, compensated_error(record, model));
    sum += variance_of(means_over(error, std::max<std::size_t>(1, error.size() / pieces)));
  }
  return sum;
}

}  // namespace

void name_bias(const BlockGrid& grid, const JointFit& joint, const Eigen::VectorXd& means,
               const std::string& axis, Diagnosis& diagnosis) {
  constexpr double kClear = 5.0;  // in standard deviations
  std::vector<double> spans_s;
  for (const BlockRange& record : grid.records)
    spans_s.push_back(static_cast<double>(record.size()) * grid.block_s);
  const double by_noise = mean_variance(joint.noise, spans_s);
  const Eigen::Index first = grid.constants(), count = means.size() - 1;
  const Eigen::VectorXd of_effects = means.tail(count);
  const double value = means[0] - of_effects.dot(joint.values.segment(first, count));
  const double variance =
      by_noise +
      std::max(0.0, of_effects.dot(joint.covariance.block(first, first, count, count) * of_effects));
  const double sigma = std::sqrt(variance);
  const bool clear = std::abs(value) > kClear * sigma;
  // A bias that noise may have caused is corrected by the share of its square above the noise's. The effects'
  // errors are left out: these effects are corrected too, and their sum is known where it was measured.
  const double share = clear ? 1.0 : value * value / (value * value + by_noise);
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

namespace {

// Linear between the centres of a record's blocks. at: sample.
double between_blocks(const BlockGrid& grid, const BlockRange& record, const Eigen::VectorXd& values,
                      std::size_t at) {
  const double blocks = (static_cast<double>(at) * grid.sample_s + 0.5 * grid.fine_s) / grid.block_s - 0.5;
  const double place = std::clamp(blocks, 0.0, static_cast<double>(record.size() - 1));
  const Eigen::Index low = record.row() + static_cast<Eigen::Index>(place);
  const Eigen::Index high = std::min(low + 1, record.row() + record.rows() - 1);
  return values[low] + (place - std::floor(place)) * (values[high] - values[low]);
}

// Effects that are not corrected online: steps at their times, shown ones by their blocks.
class Uncorrected {
 public:
  Uncorrected(const BlockData& data, const SearchResult& found)
      : grid_(data.grid), shown_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(data.grid.size()))) {
    for (const Chosen& each : found.chosen) {
      const Candidate& effect = each.candidate;
      if (effect.shown())
        shown_ += each.coefficient * regressor(data, effect);
      else if (!effect.corrected())
        steps_.push_back({effect.record, effect.time_s, each.coefficient});
    }
  }

  // Value for a record's sample at this time.
  [[nodiscard]] double at(std::size_t record, std::size_t sample, double time_s) const {
    double sum = between_blocks(grid_, grid_.records[record], shown_, sample);
    for (const Step& each : steps_)
      if (each.record == record && time_s > each.time_s) sum += each.size;
    return sum;
  }

 private:
  struct Step {
    std::size_t record;
    double time_s, size;
  };
  const BlockGrid& grid_;
  Eigen::VectorXd shown_;
  std::vector<Step> steps_;
};

}  // namespace

void subtract_effects(const std::vector<Record>& records, const BlockData& data, const SearchResult& found,
                      const Diagnosis& diagnosis, std::vector<EvenError>& errors) {
  const BlockGrid& grid = data.grid;
  Model model;
  add_to_model(diagnosis, "", model);
  const Uncorrected uncorrected(data, found);
  Eigen::VectorXd change = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(grid.size()));
  if (!found.chosen.empty())
    change =
        held_out_change(data, candidates_of(found.chosen), found.noise.shape, coefficients_of(found.chosen));
  for (std::size_t r = 0; r < errors.size(); ++r) {
    EvenError& error = errors[r];
    error.written = error.before;
    if (!model.effects.empty())
      error.written = std::make_shared<const Samples>(
          on_even_grid(records[r], grid.sample_s, compensated_error(records[r], model)));
    error.after = error.rest;
    error.held_out = error.written;
    if (model.effects.empty() && found.chosen.empty()) continue;
    Samples after = *error.rest;
    for (std::size_t i = 0; i < after.size(); ++i) {
      const double time_s = error.start_s + static_cast<double>(i) * grid.sample_s;
      after[i] -= (*error.before)[i] - (*error.written)[i] + uncorrected.at(r, i, time_s);
    }
    error.after = std::make_shared<const Samples>(std::move(after));
    if (found.chosen.empty()) continue;
    Samples held_out = *error.written;
    for (std::size_t i = 0; i < held_out.size(); ++i)
      held_out[i] -= between_blocks(grid, grid.records[r], change, i);
    error.held_out = std::make_shared<const Samples>(std::move(held_out));
  }
}

std::optional<std::size_t> least_missed_effect(const std::vector<Record>& records, const Diagnosis& diagnosis,
                                               std::size_t candidates, double sample_s) {
  constexpr std::size_t kPieces = 2000;
  double least = std::numeric_limits<double>::infinity();
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < candidates; ++i) {
    const std::optional<Form> form = form_named(diagnosis.effects[i].effect.form);
    if (!form || !carries_over(*form) || diagnosis.effects[i].effect.shown_only) continue;
    Diagnosis without = diagnosis;
    without.effects[i].effect.shown_only = true;
    const double left = left_in(records, without, sample_s, kPieces);
    if (left < least) least = left, found = i;
  }
  return found;
}

double smoothing_s(const std::vector<Record>& records, const Diagnosis& diagnosis, std::size_t at,
                   double most_s, double sample_s) {
  const std::string_view name = time_constant_name(diagnosis.effects[at].effect);
  Diagnosis trial = diagnosis;
  double& trial_s =
      std::ranges::find(trial.effects[at].effect.parameters, name, &ModelParameter::name)->value;
  double least = std::numeric_limits<double>::infinity(), best_s = trial_s;
  for (; trial_s <= most_s; trial_s *= 1.5) {
    const double left = left_in(records, trial, sample_s, SIZE_MAX);
    if (left < least) least = left, best_s = trial_s;
  }
  return best_s;
}

}  // namespace ifog
