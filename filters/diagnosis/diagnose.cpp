// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/diagnose.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "filters/diagnosis/checks/channel_delay.h"
#include "filters/diagnosis/checks/predicted_capture.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/record/own_rotation.h"
#include "filters/diagnosis/record/prepared_records.h"
#include "filters/diagnosis/record/reconstruct.h"
#include "filters/diagnosis/record/stuck_blocks.h"
#include "filters/diagnosis/record/turned.h"
#include "filters/diagnosis/record/unused_channels.h"
#include "filters/diagnosis/report/balanced_shares.h"
#include "filters/diagnosis/report/before_and_after.h"
#include "filters/diagnosis/report/findings.h"
#include "filters/diagnosis/report/grown_figures.h"
#include "filters/diagnosis/report/held_out_part.h"
#include "filters/diagnosis/report/hidden_causes.h"
#include "filters/diagnosis/report/left_out.h"
#include "filters/diagnosis/report/loop_rivals.h"
#include "filters/diagnosis/report/noise.h"
#include "filters/diagnosis/report/prediction.h"
#include "filters/diagnosis/report/sample_effects.h"
#include "filters/diagnosis/report/series.h"
#include "filters/diagnosis/report/written_model.h"
#include "filters/diagnosis/residual/dead_zone.h"
#include "filters/diagnosis/residual/hysteresis.h"
#include "filters/diagnosis/residual/record_lines.h"
#include "filters/diagnosis/residual/resonances.h"
#include "filters/diagnosis/residual/two_states.h"
#include "filters/diagnosis/residual/unexplained.h"
#include "filters/diagnosis/search/acceptance.h"
#include "filters/diagnosis/search/complete_laws.h"
#include "filters/diagnosis/search/earth_rate.h"

namespace ifog {
namespace {

constexpr double kOfLines = 1.0 / 200.0;  // of the significance: every frequency is tried
// Twice the log-likelihood that a channel's delay has to gain, its tries included.
constexpr double kLate = 24.0;
constexpr std::size_t kMostDelays = 2;    // channels
constexpr std::size_t kMoreOnDwells = 4;  // effects: a scale factor comes with its powers and products

// One diagnosis, step by step. What each step finds is out of the errors for the next.
class Run {
 public:
  // whole: nothing of the records is kept back.
  Run(const PreparedRecords& prepared, bool whole, const DiagnoseOptions& options)
      : records_(prepared.fitted()),
        as_logged_(whole ? prepared.as_logged() : nullptr),
        stuck_(prepared.stuck()),
        ramps_(prepared.without_ramps().ramps),
        no_ramp_because_(prepared.without_ramps().remark),
        options_(options),
        earth_{options.subtract_earth_rate, options.latitude_rad, options.axis},
        data_(cut_to_blocks(prepared.without_ramps().records)),
        errors_(even_errors(records_, prepared.without_ramps(), data_.grid.sample_s)) {}

  Diagnosis run() {
    refuse_constant(records_);
    look_at_channels();
    search({});
    align_channels();
    subtract_found(data_, found_, errors_);
    separate_dead_zone();
    separate_lines();
    separate_hysteresis();
    drop_steps_of_two_states();
    drop_what_changes_sign();
    drop_what_a_capture_denies();
    drop_what_stands_twice();
    drop_what_is_not_proven();
    complete_laws(data_, reconstructed_, found_);
    fit_jointly();
    while (const std::optional<std::size_t> harmful = what_makes_it_worse()) {
      say(harmful_in_words(result_.effects[*harmful].effect));
      found_ = without_effect(data_, reconstructed_, std::move(found_), *harmful);
      fit_jointly();
    }
    report_figures();
    report_rest();
    return std::move(result_);
  }

 private:
  void look_at_channels() {
    for (const Record& record : records_) result_.samples += record.time_s.size();
    result_.sample_rate_hz = 1.0 / data_.grid.sample_s;
    std::vector<std::string> ramps;
    for (const RampFit& ramp : ramps_) ramps.push_back(ramp.effect.channel);
    say(unused_channels(records_, data_, ramps));
    for (std::string& each : mark_own_rotation(data_)) say(std::move(each));
    reconstructed_ = with_reconstructed_channels(data_);
  }

  // Noise and effects together, beside lines that are given.
  void search(const std::vector<Candidate>& given) {
    SearchOptions search;
    search.significance = options_.significance;
    search.most_effects = options_.most_effects + (data_.grid.dwells ? kMoreOnDwells : 0);
    search.progress = options_.progress;
    search.given = given;
    ask_stuck_channels(search);
    do {
      found_ = search_effects(data_, reconstructed_, search);
    } while (left_out_stuck());
    read_as_earth_rate(reconstructed_, earth_, found_);
  }

  // What was stuck may explain nothing until those blocks are out, and then it is used.
  void ask_stuck_channels(const SearchOptions& search) {
    if (stuck_.empty() || std::exchange(stuck_asked_, true)) return;
    std::vector<std::string> all;
    for (const StuckStretch& each : stuck_) all.push_back(each.channel);
    BlockData read = data_;
    BlockData without = reconstructed_;
    leave_out_stuck(stuck_, all, read.grid);
    if (leave_out_stuck(stuck_, all, without.grid).empty()) return;
    found_ = search_effects(read, without, search);
    left_out_stuck();
  }

  // Of the channels that the model uses; whether there was any that had been in the fit.
  bool left_out_stuck() {
    std::vector<std::string> used;
    for (const Candidate& each : found_.fitted)
      for (const std::size_t channel : {each.channel, each.with_channel})
        if (channel != Candidate::kNone) used.push_back(data_.channels[channel].name);
    leave_out_stuck(stuck_, used, reconstructed_.grid);
    const std::vector<std::string> said = leave_out_stuck(stuck_, used, data_.grid);
    for (const std::string& each : said) say(each);
    return !said.empty();
  }

  // A delay is a parameter of the channel, and has to pay for itself: all effects sought anew with the
  // channel as it was must be that much likelier.
  void align_channels() {
    if (data_.grid.dwells) return;
    for (std::size_t round = 0; round < kMostDelays; ++round) {
      const auto delay = most_delayed_channel(reconstructed_, found_.fitted, found_.noise.shape);
      if (!delay || delay->gain < kLate) return;
      const BlockData before = reconstructed_, read_before = data_;
      const std::size_t said = result_.remarks.size();
      SearchResult found = found_;
      undo_delay(data_.grid, delay->delay_s, reconstructed_.channels[delay->channel]);
      rebuild_differences(reconstructed_);
      if (delay->delay_s < 0.0) {  // which the daemon can wait for
        undo_delay(data_.grid, delay->delay_s, data_.channels[delay->channel]);
        rebuild_differences(data_);
      }
      search({});
      const bool used = std::any_of(found_.fitted.begin(), found_.fitted.end(),
                                    [&](const Candidate& each) { return each.uses(delay->channel); });
      if (!used || score_of(found_) < score_on(reconstructed_.grid, before, found) + kLate) {
        reconstructed_ = before;
        data_ = read_before;
        found_ = std::move(found);
        result_.remarks.resize(said);
        return;
      }
      result_.channel_delays.push_back(
          {data_.channels[delay->channel].name, delay->delay_s, delay->std_error_s});
    }
  }

  // The forms of the search may have taken a part of it for a nonlinearity.
  void separate_dead_zone() {
    if (data_.reference < 0 || data_.grid.dwells) return;
    FoundZone found;
    for (const Record& record : records_)
      found.rates.push_back(on_even_grid(record, data_.grid.sample_s, record.reference_radps));
    const auto zone = find_dead_zone(errors_, found.rates, data_.grid.sample_s, options_.significance);
    if (!zone) return;
    found.zone = *zone;
    found.channel = data_.channels[static_cast<std::size_t>(data_.reference)].name;
    zone_ = std::move(found);
    take_out(*zone, zone_->rates, data_.grid, errors_);
    reconstructed_.grid.error = data_.grid.error;
    search({});
    subtract_found(data_, found_, errors_);
  }

  // Lines are looked for in what the effects leave; a slow one then competes with them in a second search. A
  // peak that slow noise or an effect made is no line once both are in the fit. Lines that follow the
  // rotation are the closed loop's own: reported, with the channel to log, and not put into the model.
  void separate_lines() {
    if (!data_.grid.dwells)
      lines_ = coherent_lines(errors_, data_.grid, options_.significance * kOfLines, periodograms_);
    leave_out_periodic(data_, lines_);
    if (ramps_.empty())
      moving_ =
          line_of_the_rotation(records_, errors_, data_.grid.sample_s, options_.significance, periodograms_);
    if (moving_) leave_out_harmonics(*moving_, lines_);
    take_out(lines_.fast, data_.grid.sample_s, errors_);
    while (!lines_.slow.empty()) {
      search(lines_.slow);
      const std::size_t before = lines_.slow.size();
      keep_proven(found_, result_.samples, options_.significance, lines_);
      if (lines_.slow.size() == before) break;
      if (lines_.slow.empty()) search({});
    }
    subtract_found(data_, found_, errors_);
  }

  // A loop is no effect that the daemon corrects, but what it leaves is searched again without it.
  void separate_hysteresis() {
    result_.hysteresis = certain_hysteresis(
        reconstructed_, fit_loops(reconstructed_, found_.fitted, found_.noise), options_.significance);
    if (!result_.hysteresis) return;
    take_out(*result_.hysteresis, reconstructed_, data_.grid);
    reconstructed_.grid.error = data_.grid.error;
    search(lines_.slow);
    subtract_found(data_, found_, errors_);
  }

  void drop_steps_of_two_states() {
    if (data_.grid.dwells || was_turned(records_) || !steps_are_jumps(errors_, data_.grid, found_)) return;
    for (std::size_t i = found_.chosen.size(); i-- > 0;)
      if (found_.chosen[i].candidate.form == Form::kStep)
        found_ = without_effect(data_, reconstructed_, std::move(found_), i);
    subtract_found(data_, found_, errors_);
  }

  void drop_what_stands_twice() {
    for (;;) {
      auto twice = standing_twice(found_.chosen);
      if (!twice) twice = cancelling(data_, found_);
      if (!twice) return;
      found_ = without_effect(data_, reconstructed_, std::move(found_), *twice);
      subtract_found(data_, found_, errors_);
    }
  }

  void drop_what_is_not_proven() {
    const std::vector<Effect> dropped =
        drop_what_does_not_hold(data_, reconstructed_, options_.significance, found_, errors_);
    if (!dropped.empty()) say(dropped_in_words(dropped));
  }

  // What has one sign in one capture and the other in another is not of the channel's making.
  void drop_what_changes_sign() {
    for (;;) {
      const std::vector<ByCapture> all = compare_captures(reconstructed_, found_.fitted, found_.noise);
      // The Earth's rate does, from heading to heading.
      const auto worst = std::find_if(all.begin(), all.end(), [&](const ByCapture& by) {
        return by.changes_sign() && found_.fitted[by.effect].first_reading == FirstReading::kError;
      });
      if (worst == all.end()) return;
      say(change_in_words(effect_of(data_, found_.fitted[worst->effect]), *worst, records_));
      found_ = without_effect(data_, reconstructed_, std::move(found_), worst->effect);
      subtract_found(data_, found_, errors_);
    }
  }

  void drop_what_a_capture_denies() {
    while (const auto denied = denied_by_a_capture(reconstructed_, found_.fitted, found_.noise)) {
      std::vector<Effect> effects;
      for (const std::size_t i : denied->effects) effects.push_back(effect_of(data_, found_.fitted[i]));
      say(denied_in_words(effects, *denied, records_));
      for (std::size_t k = denied->effects.size(); k-- > 0;)
        found_ = without_effect(data_, reconstructed_, std::move(found_), denied->effects[k]);
      subtract_found(data_, found_, errors_);
    }
  }

  void report_changes_of_size() {
    for (const ByCapture& by : compare_captures(reconstructed_, found_.fitted, found_.noise))
      if (by.changes()) say(change_in_words(effect_of(data_, found_.fitted[by.effect]), by, records_));
  }

  void fit_jointly() {
    joint_ = settle(data_, reconstructed_, found_);
    subtract_found(data_, found_, errors_);
    report_effects();
    count_rates_from_the_bias(errors_, result_.effects);
    run_written_model(records_, result_, data_.grid.sample_s, errors_);
    leave_as_written(errors_);
    if (as_logged_) run_as_logged(records_, *as_logged_, result_, data_.grid.sample_s, errors_);
  }

  // Of the effects as they are now written, by runs of the daemon's own correction and on blocks that were
  // left out of the fit: index of the one to leave out, none when they make no error larger.
  std::optional<std::size_t> what_makes_it_worse() {
    if (holds(reconstructed_, found_, errors_, &EvenError::written) &&
        holds(reconstructed_, found_, errors_, &EvenError::held_out) &&
        (!as_logged_ || holds(reconstructed_, found_, errors_, &EvenError::logged))) {
      write_before_and_after(errors_, data_.grid.sample_s, figures_, angles_, result_);
      if (!grows_over_many(result_, errors_)) return std::nullopt;
    }
    if (const auto harmful =
            most_harmful_effect(records_, result_, found_.chosen.size(), data_.grid.sample_s, errors_))
      return harmful;
    return least_certain(found_.chosen);
  }

  void report_effects() {
    Findings findings = findings_of(data_, reconstructed_, found_, joint_, options_.axis);
    add_loop_rivals(reconstructed_, fit_loops(reconstructed_, found_.fitted, found_.noise),
                    found_.noise.shape, options_.axis, findings);
    result_.effects = std::move(findings.effects);
    result_.indistinguishable = std::move(findings.pairs);
    result_.others = std::move(findings.others);
    result_.noise_posterior = joint_.noise;
    const std::size_t jointly = result_.effects.size();
    for (FoundEffect& each : sample_effects(ramps_, zone_, lines_.fast, errors_, options_.axis))
      result_.effects.push_back(std::move(each));
    result_.covariance = covariance_of(result_.effects, joint_, data_.grid.constants(), jointly);
    result_.ranges = ranges_of(data_, result_.effects, result_.channel_delays);
    parts_ = std::move(findings.parts);
  }

  void report_figures() {
    result_.series =
        series_of(data_, errors_, found_.chosen, result_.effects, parts_, periodograms_, angles_);
    write_before_and_after(errors_, data_.grid.sample_s, figures_, angles_, result_);
    write_noise(records_, errors_, data_.grid, found_.noise, angles_, result_);
    add_allan_band(errors_.front(), data_.grid.sample_s, result_.noise, angles_, result_.series);
    const bool as_cut = records_.size() == 1 && ramps_.empty();  // with nothing taken out of its channels
    result_.heading = predict_like_longest(result_, records_, as_cut ? &data_ : nullptr);
  }

  void report_rest() {
    for (const ChannelDelay& delay : result_.channel_delays) say(delay_in_words(delay));
    result_.unexplained =
        describe_rest(errors_, found_.noise, data_.grid, options_.significance, periodograms_);
    report_changes_of_size();
    say(earth_rate_in_words(reconstructed_, earth_, found_));
    say(unexplained_beside_claims(result_, records_.size()));
    say(grown_in_words(result_, samples_of(errors_)));
    if (as_logged_) say(faults_in_words(result_, errors_));
    if (moving_)
      describe_moving(*moving_, result_.unexplained);
    else
      say(no_ramp_because_);
    if (result_.hysteresis)
      describe_hysteresis(*result_.hysteresis, result_.unexplained);
    else
      describe_two_states(errors_, data_.grid, was_turned(records_), result_.unexplained);
    balance_shares(parts_.size(), result_);
    say(slow_beside(errors_, data_.grid, result_.unexplained));
    if (!moving_ && !data_.grid.dwells)
      say(resonances_in_words(find_resonances(longest_of(errors_).after, data_.grid.sample_s)));
    say(judged_beside(found_.noise.shape.harmonics.size()));
    if (data_.grid.dwells && !result_.effects.empty()) {
      say("coefficients were fitted without the part they are judged on; which effects to take was decided "
          "on all of the data");
    }
  }

  void say(std::string remark) {
    if (!remark.empty()) result_.remarks.push_back(std::move(remark));
  }

  const std::vector<Record>& records_;    // as given
  const std::vector<Record>* as_logged_;  // with channels before their faults were repaired; null: no faults
  const std::vector<StuckStretch>& stuck_;
  bool stuck_asked_ = false;
  const std::vector<RampFit>& ramps_;
  const std::string& no_ramp_because_;  // empty, or a sentence
  const DiagnoseOptions& options_;
  const EarthRateOptions earth_;
  BlockData data_;           // without the ramps
  BlockData reconstructed_;  // the same with reconstructed channels
  std::vector<EvenError> errors_;
  KnownPeriodograms periodograms_;
  KnownFigures figures_{64};
  KnownAngles angles_;
  std::optional<FoundZone> zone_;
  Lines lines_;
  std::optional<MovingLine> moving_;
  SearchResult found_;
  JointFit joint_;
  std::vector<Eigen::VectorXd> parts_;  // of the error by block, one an effect of found_
  Diagnosis result_;
};

}  // namespace

Diagnosis diagnose(const std::vector<Record>& records, const DiagnoseOptions& options,
                   const PreparedChannels* channels) {
  if (!(options.fit_from < options.fit_to))
    throw std::invalid_argument("the part to fit ends before it begins, expected fit-from below fit-to");
  const TimeShare share{options.fit_from, options.fit_to};
  const PreparedRecords prepared(records, share, options.significance, channels);
  Diagnosis diagnosis = Run(prepared, share.whole(), options).run();
  diagnosis.reference_delays = prepared.delays();
  const std::vector<std::string> remarks = prepared.remarks();
  diagnosis.remarks.insert(diagnosis.remarks.begin(), remarks.begin(), remarks.end());
  if (!share.whole()) judge(prepared.whole(), share, diagnosis);
  return diagnosis;
}

}  // namespace ifog
