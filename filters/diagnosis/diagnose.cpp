#include "filters/diagnosis/diagnose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "filters/diagnosis/checks/chow_test.h"
#include "filters/diagnosis/checks/hausman_test.h"
#include "filters/diagnosis/checks/outliers.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/diagnosis/record/ramp.h"
#include "filters/diagnosis/record/reconstruct.h"
#include "filters/diagnosis/record/unused_channels.h"
#include "filters/diagnosis/report/findings.h"
#include "filters/diagnosis/report/held_out_part.h"
#include "filters/diagnosis/report/loop_rivals.h"
#include "filters/diagnosis/report/prediction.h"
#include "filters/diagnosis/report/series.h"
#include "filters/diagnosis/residual/hysteresis.h"
#include "filters/diagnosis/residual/lines.h"
#include "filters/diagnosis/residual/moving_line.h"
#include "filters/diagnosis/residual/record_lines.h"
#include "filters/diagnosis/residual/resonances.h"
#include "filters/diagnosis/residual/unexplained.h"
#include "filters/diagnosis/search/acceptance.h"
#include "filters/diagnosis/search/effective_tries.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {
namespace {

constexpr int kFolds = 4;
constexpr int kDwellFolds = 10;
constexpr double kWorse = 1.05;
constexpr double kWorseSlowly = 1.2;
constexpr double kOpposed = 2.5;     // standard deviations
constexpr double kUnsteady = 16.27;  // chi-square of three degrees of freedom, 0.1 %
constexpr double kUnsteadyShare = 0.2;

// A stuck device, or a placeholder: rounding would be all there is to explain.
void refuse_constant(const std::vector<Record>& records) {
  for (const Record& record : records) {
    const std::vector<double> error = error_of(record);
    const double first = error.empty() ? 0.0 : error.front();
    if (!std::all_of(error.begin(), error.end(), [&](double value) { return value == first; })) return;
  }
  throw std::invalid_argument(records.front().name +
                              ": the rate, less the reference if there is one, never changes; expected "
                              "measurements");
}

class Account {
 public:
  // records: as given. clean: with what the ramps explain taken out of the rate, and the ramps out of the
  // channels.
  Account(const std::vector<Record>& records, const std::vector<Record>& clean,
          const std::vector<RampFit>& ramps, const DiagnoseOptions& options)
      : records_(records), options_(options), ramps_(ramps), data_(cut_to_blocks(clean)) {
    const double sample_s = data_.grid.sample_s;
    for (std::size_t r = 0; r < records.size(); ++r) {
      EvenError error;
      error.start_s = records[r].time_s.front();
      error.before = on_even_grid(records[r], sample_s, error_of(records[r]));
      clean_.push_back(on_even_grid(records[r], sample_s, error_of(clean[r])));
      std::vector<double> held = error_of(records[r]);
      for (const RampFit& ramp : ramps) {
        for (std::size_t i = 0; i < held.size(); ++i) held[i] -= ramp.held_out[r][i];
      }
      clean_held_out_.push_back(on_even_grid(records[r], sample_s, held));
      errors_.push_back(std::move(error));
    }
  }

  Diagnosis run() {
    refuse_constant(records_);
    for (const Record& record : records_) result_.samples += record.time_s.size();
    const std::string unused = unused_channels(records_, data_);
    if (!unused.empty()) result_.remarks.push_back(unused);
    result_.sample_rate_hz = 1.0 / data_.grid.sample_s;
    SearchOptions search;
    search.significance = options_.significance;
    search.most_effects = options_.most_effects + (data_.grid.dwells ? 4 : 0);
    search.progress = options_.progress;
    found_ = search_effects(data_, search);
    take_effects();
    // Lines are looked for in what the effects leave; a slow one then competes with them in a second search.
    lines_ = coherent_lines(errors_, data_.grid, options_.significance / 200.0);
    if (data_.grid.dwells) lines_ = {};
    leave_out_periodic(data_, lines_);
    blame_rotation();
    while (!lines_.slow.empty()) {
      search.given = lines_.slow;
      found_ = search_effects(data_, search);
      const std::size_t before = lines_.slow.size();
      keep_proven_lines();
      if (lines_.slow.size() == before) break;
      if (lines_.slow.empty()) {
        search.given.clear();
        found_ = search_effects(data_, search);
      }
    }
    take_effects();
    clean_data_ = with_reconstructed_channels(data_);
    if (set_hysteresis_apart()) {
      found_ = search_effects(data_, search);
      take_effects();
    }
    drop_what_does_not_hold();
    fit_jointly();
    write_effects();
    write_figures();
    result_.series = series_of(data_, errors_, found_.chosen, result_.effects, parts_);
    return std::move(result_);
  }

 private:
  [[nodiscard]] Eigen::Index constant_columns() const { return static_cast<Eigen::Index>(records_.size()); }

  // Whether the effects make the error on held-out data smaller: what is quick, and what a heading is made
  // of, where chance has fewer pieces to average over.
  [[nodiscard]] bool holds() const {
    const auto grows = [&](double pieces, double most) {
      double before = 0.0;
      double after = 0.0;
      for (const EvenError& error : errors_) {
        const auto count = std::max<std::size_t>(
            1, static_cast<std::size_t>(static_cast<double>(error.before.size()) / pieces));
        before += variance_of(means_over(error.before, count));
        after += variance_of(means_over(error.held_out, count));
      }
      return after > most * before;
    };
    return !grows(2000.0, kWorse) && (!grows(20.0, kWorseSlowly) || slow_noise_may_oppose());
  }

  // Slow noise that happens to run against the effects hides them in the raw error, and their removal lays it
  // bare. That is no reason to leave them out where noise as large as the model's does it now and then.
  [[nodiscard]] bool slow_noise_may_oppose() const {
    if (found_.clean.empty()) return true;
    const Columns all = design(clean_data_, found_.clean);
    const Eigen::Index k = constant_columns();
    const Eigen::Index p = all.cols() - 1 - k;
    Columns columns(all.rows(), k + 2);
    columns << all.leftCols(1 + k), all.rightCols(p) * found_.clean_coefficients.tail(p);
    const Eigen::VectorXd taken = Eigen::VectorXd::Ones(k + 1);
    const Eigen::MatrixXd known = Eigen::MatrixXd::Zero(k + 1, k + 1);
    return disagreement(data_.grid, found_.noise, columns, k, taken, known) < kOpposed;
  }

  // A loop is no effect that the daemon corrects, but what it leaves is searched again without it.
  bool set_hysteresis_apart() {
    result_.hysteresis = certain_hysteresis(clean_data_, fit_loops(clean_data_, found_.clean, found_.noise),
                                            options_.significance);
    if (!result_.hysteresis) return false;
    for (std::size_t c = 0; c < data_.channels.size(); ++c) {
      if (data_.channels[c].name != result_.hysteresis->channel) continue;
      const Eigen::VectorXd loop = hysteresis_loop(clean_data_, c, result_.hysteresis->half_width);
      for (std::size_t b = 0; b < data_.grid.size(); ++b) {
        const auto row = static_cast<Eigen::Index>(b);
        if (data_.grid.valid[b]) data_.grid.error[row] -= result_.hysteresis->coefficient * loop[row];
      }
    }
    clean_data_.grid.error = data_.grid.error;
    return true;
  }

  // What a few outliers, a change of the noise or one part of the record make up is no effect.
  [[nodiscard]] bool stands(std::size_t i) const {
    const NoiseShape& shape = found_.noise.shape;
    const double ratio = std::min(ratio_without_outliers(clean_data_, found_.clean, i, shape),
                                  ratio_in_changing_noise(clean_data_, found_.clean, i, shape));
    if (tail(ratio, 1) * found_.tries >= options_.significance) return false;
    if (data_.grid.dwells) return true;  // there contiguous parts are held out in turn
    const Unsteadiness unsteady = unsteadiness(clean_data_, found_.clean, i, shape);
    return unsteady.square < kUnsteady || unsteady.share < kUnsteadyShare;
  }

  // The last word is the error on held-out data: effects that make it larger are no model, whatever their
  // p-values. The least certain goes first.
  void drop_what_does_not_hold() {
    std::string names;
    const auto drop = [&](std::size_t i) {
      const Effect effect = effect_of(data_, found_.chosen[i].candidate);
      names +=
          (names.empty() ? "" : ", ") + effect.form + (effect.channel.empty() ? "" : " of " + effect.channel);
      found_ = without_effect(data_, clean_data_, std::move(found_), i);
      take_effects();
    };
    for (std::size_t i = 0; i < found_.clean.size();) {
      if (found_.clean[i].channel == Candidate::kNone || stands(i))
        ++i;
      else
        drop(i);
    }
    while (!holds()) {
      std::size_t least = found_.chosen.size();
      for (std::size_t i = 0; i < found_.chosen.size(); ++i) {
        if (!carries_over(found_.chosen[i].candidate.form)) continue;
        if (least == found_.chosen.size() ||
            found_.chosen[i].likelihood_ratio < found_.chosen[least].likelihood_ratio)
          least = i;
      }
      if (least == found_.chosen.size()) break;
      drop(least);
    }
    if (names.empty()) return;
    result_.remarks.push_back(
        "the innovations suggest " + names +
        ", but a few knocks or a change of the noise make it seem so, it is not the same "
        "all along the record, or the error on held-out data would grow: left out");
  }

  void take_effects() {
    std::vector<Candidate> effects;
    for (const Chosen& chosen : found_.chosen) effects.push_back(chosen.candidate);
    columns_ = design(data_, effects);
    subtract();
  }

  // Lines that follow the rotation are the loop's own. Fixed lines cannot stand for them: they are reported,
  // with the channel to log, and not put into the model.
  void blame_rotation() {
    for (std::size_t r = 0; r < errors_.size() && !moving_ && ramps_.empty(); ++r) {
      const std::vector<SpectralLine> peaks =
          find_lines(errors_[r].after, errors_[r].start_s, data_.grid.sample_s, options_.significance);
      if (peaks.empty()) continue;
      const std::vector<double> rate(records_[r].rate_radps.begin(), records_[r].rate_radps.end());
      const std::vector<double> even = on_even_grid(records_[r], data_.grid.sample_s, rate);
      moving_ = find_moving_line(errors_[r].after, even, data_.grid.sample_s, peaks);
    }
    if (!moving_) return;
    const auto harmonic = [&](double frequency) {
      const double times = frequency / moving_->frequency_hz;
      return times > 0.5 && std::abs(times - std::round(times)) < 0.01 * std::max(1.0, times);
    };
    std::erase_if(lines_.slow, [&](const Candidate& line) { return harmonic(line.frequency_hz); });
    std::erase_if(lines_.fast, [&](const FastLine& line) { return harmonic(line.line.frequency_hz); });
  }

  void write_ramps() {
    for (const RampFit& ramp : ramps_) {
      FoundEffect found;
      found.effect = ramp.effect;
      found.effect.axis = options_.axis;
      found.p_value = ramp.p_value;
      found.likelihood_ratio = ramp.ratio;
      double explained = 0.0;
      double total = 0.0;
      for (std::size_t r = 0; r < errors_.size(); ++r) {
        explained += variance_of(ramp.correction[r]);
        total += variance_of(errors_[r].before);
      }
      found.variance_explained = total > 0.0 ? std::min(1.0, explained / total) : 0.0;
      result_.effects.push_back(std::move(found));
    }
  }

  // A peak that slow noise or an effect made is no line once both are in the fit.
  void keep_proven_lines() {
    const double tries = 0.5 * static_cast<double>(result_.samples);
    std::vector<Candidate> kept;
    for (std::size_t i = 0; i < lines_.slow.size(); ++i) {
      if (tries * std::exp(-0.5 * found_.chosen[i].likelihood_ratio) < options_.significance)
        kept.push_back(lines_.slow[i]);
    }
    lines_.slow = std::move(kept);
  }

  // Of a rate table ten contiguous parts; of a time series pieces in turn, so that slow channels are seen by
  // all.
  [[nodiscard]] int fold_count() const { return data_.grid.dwells ? kDwellFolds : kFolds; }
  [[nodiscard]] std::vector<int> fold_of_block() const {
    return data_.grid.dwells ? folds_of(data_.grid, kDwellFolds, 1) : folds_of(data_.grid, kFolds);
  }

  // Coefficients for each fold from the blocks of the others.
  std::vector<Eigen::VectorXd> crossed() const {
    std::vector<Eigen::VectorXd> coefficients;
    const std::vector<int> fold = fold_of_block();
    for (int f = 0; f < fold_count(); ++f) {
      // Whitened on all blocks, then fitted on the rows of the others: a fold is left out of the fit, not cut
      // out of the filter, which would start anew behind every gap.
      Columns white = columns_;
      Whitening(data_.grid, found_.noise.shape).apply(white);
      const Eigen::Index k = constant_columns();
      const Eigen::HouseholderQR<Eigen::MatrixXd> qr(white.middleCols(1, k));
      const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(white.rows(), k);
      white -= (q * (q.transpose() * white)).eval();
      const Eigen::Index p = white.cols() - 1 - k;
      const Eigen::VectorXd full = white.rightCols(p).colwise().norm().transpose().cwiseMax(1e-300);
      for (Eigen::Index i = 0; i < white.rows(); ++i) {
        if (fold[static_cast<std::size_t>(i)] == f) white.row(i).setZero();
      }
      const Columns x = white.rightCols(p);
      // What happened in the held-out fold alone, the others cannot know: no coefficient.
      Eigen::VectorXd scale = x.colwise().norm().transpose();
      for (Eigen::Index j = 0; j < p; ++j) scale[j] = scale[j] > 1e-3 * full[j] ? 1.0 / scale[j] : 0.0;
      const Eigen::MatrixXd scaled = x * scale.asDiagonal();
      const Eigen::VectorXd c =
          Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(scaled).solve(white.col(0));
      coefficients.push_back(scale.asDiagonal() * c);
    }
    return coefficients;
  }

  void subtract() {
    const Eigen::Index p = columns_.cols() - 1 - constant_columns();
    const Eigen::VectorXd whole = found_.coefficients.tail(p);
    const std::vector<Eigen::VectorXd> folds = p > 0 ? crossed() : std::vector<Eigen::VectorXd>{};
    const std::vector<int> fold = fold_of_block();
    const BlockGrid& grid = data_.grid;
    Eigen::VectorXd all = Eigen::VectorXd::Zero(columns_.rows());
    Eigen::VectorXd held = all;
    if (p > 0) {
      all = columns_.rightCols(p) * whole;
      // Each fold's fit has a constant of its own: without it a channel far from zero would step from fold to
      // fold.
      Columns centred = columns_.rightCols(p);
      for (std::size_t r = 0; r + 1 < grid.starts.size(); ++r) {
        auto rows = centred.middleRows(static_cast<Eigen::Index>(grid.starts[r]),
                                       static_cast<Eigen::Index>(grid.starts[r + 1] - grid.starts[r]));
        rows.rowwise() -= rows.colwise().mean().eval();
      }
      for (Eigen::Index b = 0; b < held.size(); ++b) {
        held[b] = centred.row(b).dot(folds[static_cast<std::size_t>(fold[static_cast<std::size_t>(b)])]);
      }
    }
    for (std::size_t r = 0; r < errors_.size(); ++r) {
      EvenError& error = errors_[r];
      error.after = clean_[r];
      error.held_out = clean_held_out_[r];
      for (const FastLine& fast : lines_.fast) {
        if (fast.record != r) continue;
        for (std::size_t i = 0; i < error.after.size(); ++i) {
          const double phase =
              2.0 * M_PI * fast.line.frequency_hz * (error.start_s + static_cast<double>(i) * grid.sample_s);
          const double value = fast.line.cosine * std::cos(phase) + fast.line.sine * std::sin(phase);
          error.after[i] -= value;
          error.held_out[i] -= value;
        }
      }
      for (std::size_t i = 0; i < error.after.size(); ++i) {
        const double at =
            static_cast<double>(i) * grid.sample_s / grid.block_s - 0.5 + 0.5 * grid.fine_s / grid.block_s;
        error.after[i] -= between(all, r, at);
        error.held_out[i] -= between(held, r, at);
      }
    }
  }

  // Linear between the middles of blocks of record r.
  [[nodiscard]] double between(const Eigen::VectorXd& values, std::size_t r, double at) const {
    const auto first = static_cast<double>(data_.grid.starts[r]);
    const auto last = static_cast<double>(data_.grid.starts[r + 1] - 1);
    const double place = std::clamp(first + at, first, last);
    const auto low = static_cast<Eigen::Index>(std::floor(place));
    const auto high = std::min(low + 1, static_cast<Eigen::Index>(last));
    const double share = place - std::floor(place);
    return values[low] + share * (values[high] - values[low]);
  }

  // Coefficients averaged over the noise the record allows, and their honest errors.
  void fit_jointly() {
    joint_ = settle(data_, clean_data_, found_);
    take_effects();
  }

  void write_effects() {
    Findings findings = findings_of(data_, clean_data_, found_, joint_, options_.axis);
    add_loop_rivals(clean_data_, fit_loops(clean_data_, found_.clean, found_.noise), found_.noise.shape,
                    options_.axis, findings);
    result_.effects = std::move(findings.effects);
    result_.indistinguishable = std::move(findings.pairs);
    result_.others = std::move(findings.others);
    result_.belief = joint_.noise;
    parts_ = std::move(findings.parts);
    const std::size_t jointly = result_.effects.size();
    write_ramps();
    for (const FastLine& fast : lines_.fast) {
      result_.effects.push_back(line_effect(fast.line, variance_of(errors_[fast.record].before)));
      result_.effects.back().effect.axis = options_.axis;
    }
    result_.covariance = covariance_of(result_.effects, joint_, constant_columns(), jointly);
    result_.ranges = ranges_of(data_, result_.effects);
  }

  void write_figures() {
    std::vector<std::map<std::string, double>> before;
    std::vector<std::map<std::string, double>> after;
    std::vector<double> weight;
    for (const EvenError& error : errors_) {
      before.push_back(error_figures(error.before, data_.grid.sample_s));
      after.push_back(error_figures(error.held_out, data_.grid.sample_s));
      weight.push_back(static_cast<double>(error.before.size()));
    }
    result_.before = pooled(before, weight);
    result_.after = pooled(after, weight);
    result_.noise = noise_terms(found_.noise.shape, found_.noise.white_variance, data_.grid.block_s);

    const auto longest = std::max_element(
        errors_.begin(), errors_.end(),
        [](const EvenError& a, const EvenError& b) { return a.before.size() < b.before.size(); });
    std::vector<SpectralLine> peaks;
    if (!data_.grid.dwells) {
      peaks = find_lines(longest->after, longest->start_s, data_.grid.sample_s, options_.significance);
    }
    result_.unexplained = describe_unexplained(longest->before, longest->after, longest->start_s,
                                               data_.grid.sample_s, found_.noise, data_.grid, peaks);
    if (moving_) describe_moving(*moving_, result_.unexplained);
    if (result_.hysteresis) describe_hysteresis(*result_.hysteresis, result_.unexplained);
    if (!moving_ && !data_.grid.dwells) {
      const std::string words = resonances_in_words(find_resonances(longest->after, data_.grid.sample_s));
      if (!words.empty()) result_.remarks.push_back(words);
    }
    if (data_.grid.dwells && !result_.effects.empty()) {
      result_.remarks.push_back(
          "coefficients were fitted without the part they are judged on; which effects to take was decided "
          "on "
          "all of the data");
    }
    predict();
  }

  // As if the next capture's channels ran like the longest record's.
  void predict() {
    const auto longest =
        std::max_element(records_.begin(), records_.end(), [](const Record& a, const Record& b) {
          return a.time_s.back() - a.time_s.front() < b.time_s.back() - b.time_s.front();
        });
    const double aligned = std::min(300.0, (longest->time_s.back() - longest->time_s.front()) / 10.0);
    result_.heading = predict_heading(result_, *longest, aligned, {60.0, 300.0, 600.0, 1800.0, 3600.0});
  }

  const std::vector<Record>& records_;
  const DiagnoseOptions& options_;
  const std::vector<RampFit>& ramps_;
  BlockData data_;
  BlockData clean_data_;  // the same with reconstructed channels
  std::vector<EvenError> errors_;
  std::vector<std::vector<double>> clean_, clean_held_out_;  // by record: less the ramps
  Lines lines_;
  std::optional<MovingLine> moving_;
  SearchResult found_;
  JointFit joint_;
  Columns columns_;
  std::vector<Eigen::VectorXd> parts_;
  Diagnosis result_;
};

}  // namespace

Diagnosis diagnose(const std::vector<Record>& records, const DiagnoseOptions& options) {
  if (!(options.fit_from < options.fit_to))
    throw std::invalid_argument("the part to fit ends before it begins, expected fit-from below fit-to");
  const bool partly = options.fit_from > 0.0 || options.fit_to < 1.0;
  const std::vector<Record> fitted = partly ? fitted_part(records, options) : records;
  const WithoutRamps parts = take_out_ramps(fitted, options.significance);
  Diagnosis diagnosis = Account(fitted, parts.clean, parts.ramps, options).run();
  if (partly) judge(records, options, diagnosis);
  return diagnosis;
}

}  // namespace ifog
