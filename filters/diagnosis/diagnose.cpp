// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/diagnose.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "filters/diagnosis/channels/motion.h"
#include "filters/diagnosis/channels/reconstruct.h"
#include "filters/diagnosis/checks/checks.h"
#include "filters/diagnosis/cleaning/prepared_records.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/report/prediction.h"
#include "filters/diagnosis/report/report.h"
#include "filters/diagnosis/residual/lines.h"
#include "filters/diagnosis/residual/periodogram.h"
#include "filters/diagnosis/residual/residual.h"
#include "filters/diagnosis/search/first_reading.h"
#include "filters/linear/projection.h"

namespace ifog {
namespace {

constexpr double kOfLines = 1.0 / 200.0;  // share of the significance; every frequency is a try

// One diagnosis, step by step. Each step removes what it finds from the errors for the next.
class Run {
 public:
  Run(const PreparedRecords& prepared, const DiagnoseOptions& options)
      : records_(prepared.fitted),
        lines_of_a_ramp_(prepared.without_ramps.remark),
        options_(options),
        data_(cut_to_blocks(prepared.without_ramps.records)),
        errors_(even_errors(records_, data_.grid.sample_s)),
        of_samples_(prepared.without_ramps.ramps) {}

  Diagnosis run() {
    refuse_constant(records_);
    look_at_channels();
    separate_dead_zone();
    search();
    separate_lines();
    separate_hysteresis();
    drop_what_a_capture_denies();
    fit_jointly();
    while (const std::optional<std::size_t> harmful = what_makes_it_worse()) {
      const bool by_chance = least_proven().has_value();
      if (by_chance || !smooth(*harmful)) {
        say(harmful_in_words(result_.effects[*harmful].effect, by_chance));
        drop(*harmful);
      }
      fit_jointly();
    }
    refuse_other_unit(result_);
    report_figures();
    report_rest();
    return std::move(result_);
  }

 private:
  void look_at_channels() {
    for (const Record& record : records_) result_.samples += record.time_s.size();
    result_.sample_rate_hz = 1.0 / data_.grid.sample_s;
    say(unused_channels(records_, data_, of_samples_));
    for (auto& each : mark_motion(records_, data_, options_.allow_motion_channels)) say(std::move(each));
    reconstructed_ = with_reconstructed_channels(data_);
  }

  void search() {
    const bool again = std::exchange(searched_, true);
    found_ = search_effects(reconstructed_, options_, again ? &found_.noise.shape : nullptr);
    read_as_earth_rate(reconstructed_, options_, found_);
    if (!options_.allow_proxies) doubt_proxies(reconstructed_, found_);
    for (Chosen& each : found_.chosen)
      if (long_past_s(data_.grid, each.candidate) > 0.0)
        each.candidate.first_reading = FirstReading::kSettlingShown;
  }

  // Subtracts the effects from the errors.
  void subtract_found() {
    result_.effects.clear();
    for (const Chosen& each : found_.chosen)
      result_.effects.emplace_back().effect =
          effect_with(data_, each.candidate, each.coefficient, options_.axis);
    for (const FoundEffect& each : of_samples_) result_.effects.push_back(each);
    result_.ranges = ranges_of(data_, result_.effects);
    const Eigen::VectorXd means = corrected_means();
    const double left = means[0] - means.tail(means.size() - 1).dot(coefficients_of(found_.chosen));
    if (data_.reference >= 0) result_.bias = ModelParameter{"coefficient", left, 0.0, "rad/s"};
    result_.means.clear();
    subtract_effects(records_, data_, found_, result_, errors_);
  }

  // Means of the error and of the effects, zero for those that are not corrected.
  [[nodiscard]] Eigen::VectorXd corrected_means() const {
    Eigen::VectorXd means = means_of(data_, candidates_of(found_.chosen));
    for (std::size_t i = 0; i < found_.chosen.size(); ++i)
      if (!found_.chosen[i].candidate.corrected()) means[static_cast<Eigen::Index>(i) + 1] = 0.0;
    return means;
  }

  // Removes effect `at` and fits the others again.
  void drop(std::size_t at) {
    found_.chosen.erase(found_.chosen.begin() + static_cast<std::ptrdiff_t>(at));
    std::erase_if(found_.alternatives, [&](const Alternative& other) { return other.of == at; });
    for (Alternative& other : found_.alternatives) other.of -= other.of > at ? 1 : 0;
    const Columns columns = design(reconstructed_, candidates_of(found_.chosen));
    found_.noise = fit_noise(reconstructed_.grid, columns, found_.noise.shape);
    fit_coefficients(reconstructed_, found_);
  }

  // Before the search, which would explain part of it by a nonlinearity.
  void separate_dead_zone() {
    if (data_.reference < 0 || data_.grid.dwells || data_.grid.noisy_reference) return;
    const std::string& channel = data_.channels[static_cast<std::size_t>(data_.reference)].name;
    if (auto zone = take_out_dead_zone(records_, channel, options_.significance, data_.grid, errors_)) {
      of_samples_.push_back(std::move(*zone));
      reconstructed_.grid.error = data_.grid.error;
    }
  }

  // Looks for lines in the residual of the effects, then repeats the search without them.
  void separate_lines() {
    if (data_.grid.dwells) return;
    subtract_found();
    if (std::ranges::any_of(errors_, [](const auto& one) { return one.before->size() > kMostTransformed; }))
      say("lines are sought in the first " + std::to_string(kMostTransformed) + " samples of a record");
    std::vector<FoundEffect> lines = take_out_lines(options_.significance * kOfLines, data_.grid, errors_);
    if (lines.empty()) return;
    std::ranges::move(lines, std::back_inserter(of_samples_));
    reconstructed_.grid.error = data_.grid.error;
    search();
  }

  // Which effects there are is decided without the loop, which looks like other forms. The daemon does not correct the
  // loop, so what those effects can describe of it stays in the error, to which their coefficients are fitted.
  void separate_hysteresis() {
    result_.hysteresis =
        find_hysteresis(reconstructed_, candidates_of(found_.chosen), found_.noise, options_.significance);
    if (!result_.hysteresis) return;
    Eigen::VectorXd& error = reconstructed_.grid.error;
    const Eigen::VectorXd with_loop = error;
    take_out(*result_.hysteresis, reconstructed_, reconstructed_.grid);
    search();
    Eigen::VectorXd loop = with_loop - error;
    const Columns columns = design(reconstructed_, candidates_of(found_.chosen));
    Projection(columns.rightCols(columns.cols() - 1)).take_out_of(loop);
    error = with_loop - loop;
    data_.grid.error = error;
  }

  void drop_what_a_capture_denies() {
    while (const auto denied =
               denied_by_a_capture(reconstructed_, candidates_of(found_.chosen), found_.noise)) {
      std::vector<Effect> effects;
      for (const std::size_t i : denied->effects)
        effects.push_back(effect_of(data_, found_.chosen[i].candidate));
      say(denied_in_words(effects, *denied, records_));
      for (std::size_t k = denied->effects.size(); k-- > 0;) drop(denied->effects[k]);
    }
  }

  void fit_jointly() {
    joint_ = settle(reconstructed_, found_);
    report_effects();
    const Eigen::VectorXd means = corrected_means();
    if (data_.reference >= 0)
      name_bias(data_.grid, joint_, means, options_.axis, result_);
    else
      result_.means = means_of_corrections(result_.effects, result_.ranges, means.tail(means.size() - 1));
    result_.covariance = covariance_of(result_.effects, joint_, data_.grid, parts_.size());
    subtract_effects(records_, data_, found_, result_, errors_);
    write_before_and_after(errors_, data_.grid.sample_s, data_.reference >= 0, result_);
  }

  // The effect that is most likely chance according to its error bar, if any.
  [[nodiscard]] std::optional<std::size_t> least_proven() const {
    std::optional<std::size_t> least;
    for (std::size_t i = 0; i < found_.chosen.size(); ++i) {
      const double p = result_.effects[i].p_value;
      if (p > options_.significance && (!least || p > result_.effects[*least].p_value)) least = i;
    }
    return least;
  }

  // Index of the effect to drop because the daemon's correction increases an error on blocks that were not
  // fitted; nullopt if there is none.
  std::optional<std::size_t> what_makes_it_worse() {
    if (const auto uncertain = least_proven()) return uncertain;
    if (!grows_over_many(result_, errors_)) return std::nullopt;
    return least_missed_effect(records_, result_, found_.chosen.size(), data_.grid.sample_s);
  }

  // Once for each rate of change: the readings are noisier than the channel that was rebuilt from them.
  bool smooth(std::size_t at) {
    Candidate& effect = found_.chosen[at].candidate;
    if (effect.form != Form::kRate || std::exchange(effect.smoothed, true)) return false;
    const double longest_s = time_constants(data_.grid, effect.form).back();
    effect.time_constant_s = smoothing_s(records_, result_, at, longest_s, data_.grid.sample_s);
    return true;
  }

  void report_effects() {
    parts_ = write_findings(data_, found_, joint_, options_.axis, result_);
    result_.noise_posterior = joint_.noise;
    for (const FoundEffect& each : of_samples_) {
      result_.effects.push_back(each);
      result_.effects.back().effect.axis = options_.axis;
    }
    result_.ranges = ranges_of(data_, result_.effects);
  }

  void report_figures() {
    write_noise(records_, errors_, data_.grid, found_.noise, result_);
    result_.series = series_of(data_, errors_, found_.chosen, result_.effects, parts_, result_.noise);
    result_.heading = predict_like_longest(result_, records_);
  }

  void report_rest() {
    result_.unexplained = describe_rest(records_, errors_, of_samples_, found_.noise, data_.grid,
                                        options_.significance, result_.noise_changes);
    say(earth_rate_in_words(options_, reconstructed_, found_));
    say(proxies_in_words(reconstructed_, found_));
    if (!data_.grid.dwells) say(unlike_reference_in_words(records_, errors_, data_.grid.sample_s));
    say(far_zeros_in_words(result_));
    say(unexplained_despite_claims(result_, records_.size()));
    // With a held-out part, judge() checks it.
    if (TimeShare{options_.fit_from, options_.fit_to}.whole())
      say(grown_in_words(result_, samples_of(errors_)));
    say(lines_of_a_ramp_);
    if (result_.hysteresis) describe_hysteresis(*result_.hysteresis, result_.unexplained);
    balance_shares(parts_.size(), result_);
    if (data_.grid.dwells && !result_.effects.empty()) {
      say("coefficients were fitted without the part they are judged on; which effects to take was decided "
          "on all of the data");
    }
  }

  void say(std::string remark) {
    if (!remark.empty()) result_.remarks.push_back(std::move(remark));
  }

  const std::vector<Record>& records_;
  const std::string& lines_of_a_ramp_;  // remark, or empty
  const DiagnoseOptions& options_;
  BlockData data_;           // without ramps
  BlockData reconstructed_;  // the same with reconstructed channels
  std::vector<EvenError> errors_;
  std::vector<FoundEffect> of_samples_;  // ramps, dead zone, lines: found outside the joint fit
  SearchResult found_;
  bool searched_ = false;
  JointFit joint_;
  std::vector<Eigen::VectorXd> parts_;  // contribution by block, one per effect of found_
  Diagnosis result_;
};

}  // namespace

Diagnosis diagnose(const std::vector<Record>& records, const DiagnoseOptions& options) {
  if (!(options.fit_from < options.fit_to))
    throw std::invalid_argument("the part to fit ends before it begins, expected fit-from below fit-to");
  const TimeShare share{options.fit_from, options.fit_to};
  const PreparedRecords prepared(records, share, options.significance);
  Diagnosis diagnosis = Run(prepared, options).run();
  diagnosis.reference_delays = prepared.whole.delays;
  diagnosis.remarks.insert(diagnosis.remarks.begin(), prepared.whole.remarks.begin(),
                           prepared.whole.remarks.end());
  if (!share.whole()) judge(prepared.whole.records, share, diagnosis);
  return diagnosis;
}

}  // namespace ifog
