// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/measure.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "filters/diagnosis/channels/derived_channels.h"
#include "filters/diagnosis/channels/reconstruct.h"
#include "filters/diagnosis/cleaning/prepared_records.h"
#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/uncertainty.h"
#include "filters/diagnosis/report/report.h"
#include "filters/effects/delayed_reading.h"
#include "filters/model_file/form.h"

namespace ifog {
namespace {

// Reason why the data cannot determine a coefficient; empty if they can.
std::string missing(const BlockData& data, const std::string& name) {
  const std::optional<std::size_t> channel = data.index_of(name);
  if (!channel) return "the captures have no " + name;
  return data.channels[*channel].varies ? "" : name + " does not change in the captures";
}

// Candidate that measures the effect; nullopt if the data cannot, for the reason in `not_measured`.
std::optional<Candidate> candidate_named(const BlockData& data, const Effect& effect,
                                         std::string& not_measured) {
  const std::optional<Form> form = form_named(effect.form);
  if (form && has_channel(*form)) not_measured = missing(data, effect.channel);
  if (form == Form::kProduct && not_measured.empty()) not_measured = missing(data, effect.with_channel);
  if (!not_measured.empty()) return std::nullopt;
  std::optional<Candidate> candidate = candidate_of(data, effect);
  if (!candidate)
    not_measured = "'" + effect.form + "' has no single coefficient to measure";
  else if (form == Form::kEarthRate)  // uses the regressor of acceleration
    candidate->first_reading = FirstReading::kEarthRateSubtracted;
  return candidate;
}

// The model does not name the capture of a step, so one candidate for each capture that may contain it.
std::vector<Candidate> steps_named(const BlockData& data, const Effect& effect) {
  const BlockGrid& grid = data.grid;
  Candidate step;
  step.form = Form::kStep;
  std::vector<Candidate> found;
  for (step.record = 0; step.record < grid.records.size(); ++step.record) {
    const BlockRange& record = grid.records[step.record];
    step.time_s = grid.origin_of(step.record).since(parameter(effect, "time_s"));
    if (step.time_s > grid.time_s[record.first] && step.time_s < grid.time_s[record.end - 1])
      found.push_back(step);
  }
  return found;
}

// Delays early channels by the daemon's code.
void wait_for_early(const std::vector<ChannelRange>& ranges, BlockData& data) {
  bool any = false;
  for (const ChannelRange& range : ranges) {
    const std::optional<std::size_t> channel = data.index_of(range.channel);
    if (!(range.early_s > 0.0) || !channel) continue;
    for (std::vector<double>* values : {&data.channels[*channel].values, &data.channels[*channel].power})
      for (const BlockRange& record : data.grid.records) {
        const BlockRange fine = data.grid.fine_steps(record);
        DelayedReading delayed(range.early_s);
        for (std::size_t k = fine.first; k < fine.end && !values->empty(); ++k)
          (*values)[k] = delayed.step((*values)[k], data.grid.fine_s);
      }
    any = true;
  }
  if (any) rebuild_differences(data);
}

class Measuring {
 public:
  Measuring(const BlockData& data, const EffectsToMeasure& wanted, const std::string& axis)
      : data_(data), wanted_(wanted), axis_(axis) {
    result_.together.resize(wanted.together.size());
    for (std::size_t i = 0; i < wanted.together.size(); ++i) take(i);
    for (const Effect& effect : wanted.others) take_other(effect);
  }

  MeasuredEffects run() {
    noise_ = fit_noise(data_.grid, design(data_, all()));
    for (std::size_t at = 0; at < place_.size(); ++at) weigh(at);
    report(joint_fit(data_, all(), noise_));
    return std::move(result_);
  }

 private:
  void take(std::size_t i) {
    MeasuredEffect& measured = result_.together[i];
    measured.effect = wanted_.together[i];
    const auto candidate = candidate_named(data_, measured.effect, measured.not_measured);
    if (!candidate) return;
    if (has_shape(model_, *candidate))
      throw std::invalid_argument("'" + wanted_.together[i].form + "' is to be measured twice");
    place_.push_back(i);
    model_.push_back(*candidate);
  }

  void take_other(const Effect& effect) {
    if (effect.form == name_of(Form::kStep)) {
      for (const Candidate& step : steps_named(data_, effect)) steps_.push_back(step);
      return;
    }
    std::string unused;
    const auto candidate = candidate_named(data_, effect, unused);
    if (candidate && !has_shape(model_, *candidate)) model_.push_back(*candidate);
  }

  // Likelihood loss without effect `at`, and gain of each alternative.
  void weigh(std::size_t at) {
    std::vector<Candidate> rest = all();
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(at));
    const NoiseFit without = fit_noise(data_.grid, design(data_, rest), noise_.shape);
    MeasuredEffect& measured = result_.together[place_[at]];
    measured.likelihood_ratio = 2.0 * (noise_.log_likelihood - without.log_likelihood);
    if (wanted_.instead.empty()) return;
    for (const Effect& effect : wanted_.instead[place_[at]]) {
      measured.instead.push_back(0.0);
      std::string unused;
      const auto other = candidate_named(data_, effect, unused);
      if (!other) continue;
      std::vector<Candidate> trial = rest;
      trial.push_back(*other);
      const NoiseFit noise = fit_noise(data_.grid, design(data_, trial), noise_.shape);
      measured.instead.back() = 2.0 * (noise.log_likelihood - without.log_likelihood);
    }
  }

  [[nodiscard]] std::vector<Candidate> all() const {
    std::vector<Candidate> effects = model_;
    effects.insert(effects.end(), steps_.begin(), steps_.end());
    return effects;
  }

  // What no measurement gives, such as the reach of a curve and the error of a time constant.
  static void keep_further(const Effect& given, Effect& effect) {
    effect.parameters.resize(1);
    for (const ModelParameter& each : given.parameters)
      if (each.name != effect.parameters.front().name) effect.parameters.push_back(each);
  }

  void report(const JointFit& joint) {
    const auto count = static_cast<Eigen::Index>(model_.size());
    const Eigen::Index first = data_.grid.constants();
    // Without a bias in the model, rates count from the mean that the effects leave.
    const Eigen::VectorXd means = means_of(data_, all());
    const Eigen::Index effects = means.size() - 1;
    const double rates_from = means[0] - means.tail(effects).dot(joint.values.segment(first, effects));
    std::vector<FoundEffect> found;
    for (Eigen::Index i = 0; i < count; ++i) {
      Effect effect = effect_of(data_, model_[static_cast<std::size_t>(i)]);
      effect.axis = axis_;
      if (is_reference_rate(effect.channel)) effect.reference = rates_from;
      if (is_reference_rate(effect.with_channel)) effect.with_reference = rates_from;
      effect.parameters.front().value = joint.values[first + i];
      effect.parameters.front().std_error = std::sqrt(joint.covariance(first + i, first + i));
      if (static_cast<std::size_t>(i) < place_.size()) {
        Effect& mine = result_.together[place_[static_cast<std::size_t>(i)]].effect;
        keep_further(mine, effect);
        mine = effect;
      } else {
        result_.others.push_back(effect);
      }
      found.push_back({effect, 1.0, 0.0, 0.0});
      result_.means.push_back(means[i + 1]);
      for (Eigen::Index j = 0; j < count; ++j)
        result_.covariance.push_back(joint.covariance(first + i, first + j));
    }
    result_.ranges = ranges_of(data_, found);
    for (ChannelRange& range : result_.ranges)
      for (const ChannelRange& known : wanted_.ranges)
        if (known.channel == range.channel) range.early_s = known.early_s;
  }

  const BlockData& data_;
  const EffectsToMeasure& wanted_;
  const std::string& axis_;
  std::vector<std::size_t> place_;  // index in `together` of the first effects of the model
  std::vector<Candidate> model_, steps_;
  NoiseFit noise_;
  MeasuredEffects result_;
};

}  // namespace

MeasuredEffects measure_effects(const std::vector<Record>& records, const EffectsToMeasure& wanted,
                                const std::string& axis, double significance) {
  if (!wanted.instead.empty() && wanted.instead.size() != wanted.together.size())
    throw std::invalid_argument("others in the place of effects, expected a list for each");
  const PreparedRecords prepared(records, {}, significance);
  BlockData data = cut_to_blocks(prepared.without_ramps.records);
  wait_for_early(wanted.ranges, data);
  const BlockData reconstructed = with_reconstructed_channels(data);
  return Measuring(reconstructed, wanted, axis).run();
}

}  // namespace ifog
