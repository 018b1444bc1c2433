#include "filters/diagnosis/search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "filters/diagnosis/consistent.h"
#include "filters/diagnosis/online_twin.h"
#include "filters/diagnosis/reconstruct.h"
#include "filters/diagnosis/scan.h"
#include "filters/diagnosis/tries.h"

namespace ifog {
namespace {

constexpr std::size_t kShortlist = 4;  // candidates of different shape that are refined at each step
constexpr double kSwapGain = 3.0;      // twice the log-likelihood a swap or a pair has to gain
constexpr double kLikeness = 6.0;      // loss below which another effect cannot be told from the chosen one
constexpr double kWorse = 1.25;  // chance makes slow noise and an effect run together or against each other
constexpr double kTrialFactor = 1.3;  // noise parameters need no more precision before the shape is refined
constexpr double kShareOfChannels = 0.7;  // of the significance; the rest is for steps
constexpr double kDisagree = 3.0;         // standard deviations
constexpr double kAlike = 0.98;           // or this correlation of the whitened regressors

class Loop {
 public:
  Loop(const BlockData& data, const SearchOptions& options)
      : data_(data), options_(options), scan_(data, library(data)), model_(options.given) {}

  SearchResult run() {
    SearchResult result;
    noise_ = fit_noise(data_.grid, design(data_, model_));
    result.noise_without = noise_;
    count_tries();
    while (model_.size() < options_.most_effects + options_.given.size()) {
      if (options_.progress) options_.progress(model_.size(), options_.most_effects + 1);
      if (!add_one() && !add_pair()) break;
      revise();
    }
    drop_what_slow_denies();
    finish(result);
    return result;
  }

 private:
  // The chance of a false effect is shared out between channels and steps.
  void count_tries() {
    const double level = 20.0;  // near what will be asked for
    tries_of_channels_ = scan_.independent(model_, noise_.shape) / kShareOfChannels;
    tries_of_steps_ = independent_steps(data_.grid, noise_.shape, level) / (1.0 - kShareOfChannels);
    if (data_.grid.dwells) tries_of_channels_ *= kShareOfChannels;
    least_ratio_ = 1.0;
    while (tail(least_ratio_, 1) * tries_of_channels_ > options_.significance) least_ratio_ += 0.25;
  }

  [[nodiscard]] double p_value(const Candidate& candidate, double ratio) const {
    const int columns = candidate.form == Form::kLine ? 2 : 1;
    const double tries = candidate.form == Form::kStep ? tries_of_steps_ : tries_of_channels_;
    return std::min(1.0, tail(ratio, columns) * tries);
  }

  struct Trial {
    std::vector<Candidate> model;
    NoiseFit noise;
    double score = -1e300;  // twice the log-likelihood less complexity
  };

  static double penalty(const std::vector<Candidate>& model) {
    double sum = 0.0;
    for (const Candidate& candidate : model) sum += complexity(candidate);
    return sum;
  }

  Trial refined(std::vector<Candidate> model, std::size_t at, const NoiseShape& start) const {
    Trial trial;
    if (model[at].searched()) refine(model, at, start);
    trial.noise = fit_noise(data_.grid, design(data_, model), start, kTrialFactor);
    if (model[at].searched()) refine(model, at, trial.noise.shape);
    trial.noise = fit_noise(data_.grid, design(data_, model), trial.noise.shape);
    trial.score = 2.0 * trial.noise.log_likelihood - penalty(model);
    trial.model = std::move(model);
    return trial;
  }

  // Golden section in the logarithm of the time constant, noise held.
  void refine(std::vector<Candidate>& model, std::size_t at, const NoiseShape& shape) const {
    Columns columns = design(data_, model);
    Eigen::Index place = 1 + constants(data_.grid).cols();
    for (std::size_t i = 0; i < at; ++i) place += model[i].form == Form::kLine ? 2 : 1;
    const auto value = [&](double log_tau) {
      Candidate trial = model[at];
      trial.time_constant_s = std::exp(log_tau);
      columns.col(place) = regressors(data_, trial).col(0);
      return fit_whitened(data_.grid, shape, columns).log_likelihood;
    };
    constexpr double kGolden = 0.6180339887498949;
    double low = std::log(model[at].time_constant_s / 2.5);
    double high = std::log(model[at].time_constant_s * 2.5);
    const double least = std::log(2.0 * data_.grid.fine_s);
    low = std::max(low, least);
    const std::vector<double> tried = time_constants(data_.grid, model[at].form);
    const double most = tried.empty() ? 3600.0 : std::min(3600.0, 1.6 * tried.back());
    high = std::min(std::max(high, least), std::log(most));
    low = std::min(low, high);
    double a = high - kGolden * (high - low);
    double b = low + kGolden * (high - low);
    double fa = value(a);
    double fb = value(b);
    while (high - low > 0.01) {
      if (fa > fb) {
        high = b;
        b = a;
        fb = fa;
        a = high - kGolden * (high - low);
        fa = value(a);
      } else {
        low = a;
        a = b;
        fa = fb;
        b = low + kGolden * (high - low);
        fb = value(b);
      }
    }
    model[at].time_constant_s = std::exp(0.5 * (low + high));
  }

  // The best of the shortlist, fully fitted, as an addition to `base`.
  Trial best_addition(const std::vector<Candidate>& base, const NoiseFit& noise, bool thorough) const {
    Trial best;
    std::vector<Scored> scored = scan_.score(base, noise, thorough);
    if (thorough && !data_.grid.dwells) {
      for (const Scored& step : scan_.steps(base, noise)) scored.push_back(step);
    }
    std::sort(scored.begin(), scored.end(), [](const Scored& a, const Scored& b) {
      return a.ratio - complexity(a.candidate) > b.ratio - complexity(b.candidate);
    });
    std::vector<Candidate> tried;
    for (const Scored& each : scored) {
      if (tried.size() >= kShortlist || each.ratio < 0.5 * least_ratio_) break;
      const auto alike = [&](const Candidate& other) { return other.same_shape(each.candidate); };
      if (std::any_of(tried.begin(), tried.end(), alike) || std::any_of(base.begin(), base.end(), alike))
        continue;
      tried.push_back(each.candidate);
      std::vector<Candidate> model = base;
      model.push_back(each.candidate);
      const Trial trial = refined(model, base.size(), each.shape);
      if (trial.score > best.score) best = trial;
    }
    return best;
  }

  bool add_one() {
    Trial best = best_addition(model_, noise_, true);
    if (best.model.empty()) return false;
    const double ratio = 2.0 * (best.noise.log_likelihood - noise_.log_likelihood);
    const Candidate& added = best.model.back();
    if (p_value(added, ratio - complexity(added)) > options_.significance) return false;
    if (added.form == Form::kStep ? !stays(best) : !predicts(best)) return false;
    model_ = best.model;
    noise_ = best.noise;
    return true;
  }

  // A correction must not make the error larger than slow noise makes it by chance: where it does grow, the
  // coefficient that plain least squares finds has to agree with the one found in innovations. Judged when
  // all effects are in: one of two that oppose each other makes the error larger until the other comes.
  void drop_what_slow_denies() {
    for (std::size_t i = options_.given.size(); i < model_.size();) {
      std::vector<Candidate> rest = model_;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      std::vector<Candidate> ordered = rest;
      ordered.push_back(model_[i]);
      const NoiseFit without = fit_noise(data_.grid, design(data_, rest), noise_.shape);
      if (left_over(ordered, noise_.shape) <= kWorse * left_over(rest, without.shape)) {
        ++i;
        continue;
      }
      const Columns columns = design(data_, ordered);
      Eigen::MatrixXd covariance;
      const Eigen::VectorXd c = solve(data_.grid, noise_.shape, columns, &covariance);
      if (disagreement(data_.grid, noise_, columns, constants(data_.grid).cols(), c, covariance) <
          kDisagree) {
        ++i;
        continue;
      }
      model_ = rest;
      noise_ = without;
      i = options_.given.size();
    }
  }

  // Sum of squares of the block means less the effects, about each record's mean.
  double left_over(const std::vector<Candidate>& model, const NoiseShape& shape) const {
    const Columns columns = design(data_, model);
    const Eigen::Index p = columns.cols() - 1 - constants(data_.grid).cols();
    const Eigen::VectorXd c = solve(data_.grid, shape, columns);
    Eigen::VectorXd left = columns.col(0);
    if (p > 0) left -= columns.rightCols(p) * c.tail(p);
    double sum = 0.0;
    for (std::size_t r = 0; r + 1 < data_.grid.starts.size(); ++r) {
      double mean = 0.0;
      double square = 0.0;
      double n = 0.0;
      for (std::size_t b = data_.grid.starts[r]; b < data_.grid.starts[r + 1]; ++b) {
        if (!data_.grid.valid[b]) continue;
        const double value = left[static_cast<Eigen::Index>(b)];
        n += 1.0;
        const double step = value - mean;
        mean += step / n;
        square += step * (value - mean);
      }
      sum += square;
    }
    return sum;
  }

  // A knock makes innovations like a step's. A step is still there later: the means before and after differ
  // by it.
  bool stays(const Trial& trial) const {
    const BlockGrid& grid = data_.grid;
    const Candidate& step = trial.model.back();
    const Columns columns = design(data_, trial.model);
    const Eigen::VectorXd c = solve(grid, trial.noise.shape, columns);
    const Eigen::Index last = columns.cols() - 1;
    const std::size_t from = grid.starts[step.record];
    const std::size_t to = grid.starts[step.record + 1];
    const std::size_t window = std::max<std::size_t>(8, (to - from) / 20);
    std::array<double, 2> sum{};
    std::array<double, 2> count{};
    for (std::size_t b = from; b < to; ++b) {
      const double away = std::abs(grid.time_s[b] - step.time_s) / grid.block_s;
      if (!grid.valid[b] || away < 3.0 || away > static_cast<double>(window)) continue;
      const auto row = static_cast<Eigen::Index>(b);
      const std::size_t side = grid.time_s[b] > step.time_s ? 1 : 0;
      sum[side] += columns(row, 0) - columns.row(row).segment(1, last - 1).dot(c.head(last - 1));
      count[side] += 1.0;
    }
    if (count[0] < 4.0 || count[1] < 4.0) return false;
    const double found = sum[1] / count[1] - sum[0] / count[0];
    return found * c[last - 1] > 0.0 && std::abs(found) > 0.4 * std::abs(c[last - 1]);
  }

  // Two effects that hide each other: neither passes alone, or a third stood for both.
  bool add_pair() {
    const auto pair = scan_.best_pair(model_, noise_);
    if (!pair) return false;
    std::vector<Candidate> model = model_;
    model.push_back(pair->first);
    model.push_back(pair->second);
    Trial trial = refined(model, model.size() - 1, noise_.shape);
    trial = refined(trial.model, model.size() - 2, trial.noise.shape);
    const double ratio = 2.0 * (trial.noise.log_likelihood - noise_.log_likelihood);
    // Tries grow as the square, and so does what two have to bring.
    if (ratio < 2.0 * least_ratio_ + penalty({trial.model.end() - 2, trial.model.end()}) || !predicts(trial))
      return false;
    model_ = trial.model;
    noise_ = trial.noise;
    return true;
  }

  // Effects chosen early were chosen without the later ones: try each one's removal and replacement.
  void revise() {
    const std::size_t first = options_.given.size();
    for (std::size_t i = first; i < model_.size() && model_.size() > first + 1;) {
      std::vector<Candidate> rest = model_;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      const NoiseFit without = fit_noise(data_.grid, design(data_, rest), noise_.shape);
      if (p_value(model_[i], 2.0 * (noise_.log_likelihood - without.log_likelihood)) >
          options_.significance) {
        model_ = rest;
        noise_ = without;
        continue;
      }
      const Trial other = best_addition(rest, without, false);
      const double score = 2.0 * noise_.log_likelihood - penalty(model_);
      if (!other.model.empty() && other.score > score + kSwapGain) {
        model_ = other.model;
        noise_ = other.noise;
      }
      ++i;
    }
    for (std::size_t i = first; i < model_.size(); ++i) {
      if (!model_[i].searched()) continue;
      Trial trial = refined(model_, i, noise_.shape);
      if (trial.noise.log_likelihood > noise_.log_likelihood) {
        model_ = trial.model;
        noise_ = trial.noise;
      }
    }
  }

  // Whether the last effect's coefficient from the other folds makes the innovations of each fold smaller.
  // Constants and the effects before it are projected out on all blocks first.
  bool predicts(const Trial& trial) const {
    Columns white = design(data_, trial.model);
    Whitening(data_.grid, trial.noise.shape).apply(white);
    const Eigen::Index last = white.cols() - 1;
    const Columns others = white.middleCols(1, last - 1);
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(others);
    const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(others.rows(), others.cols());
    Eigen::VectorXd y = white.col(0);
    Eigen::VectorXd x = white.col(last);
    y -= q * (q.transpose() * y);
    x -= q * (q.transpose() * x);
    constexpr int kFolds = 4;
    const std::vector<int> fold = folds_of(data_.grid, kFolds);
    std::array<double, kFolds> xy{};
    std::array<double, kFolds> xx{};
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      const auto f = static_cast<std::size_t>(fold[static_cast<std::size_t>(i)]);
      xy[f] += x[i] * y[i];
      xx[f] += x[i] * x[i];
    }
    const double all_xy = std::accumulate(xy.begin(), xy.end(), 0.0);
    const double all_xx = std::accumulate(xx.begin(), xx.end(), 0.0);
    double gain = 0.0;
    for (std::size_t f = 0; f < kFolds; ++f) {
      if (all_xx - xx[f] <= 0.0) continue;
      const double c = (all_xy - xy[f]) / (all_xx - xx[f]);
      gain += 2.0 * c * xy[f] - c * c * xx[f];
    }
    return gain > 0.0;
  }

  void finish(SearchResult& result) {
    const std::size_t first = options_.given.size();
    for (std::size_t i = 0; i < model_.size(); ++i) {
      std::vector<Candidate> rest = model_;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      const NoiseFit without = fit_noise(data_.grid, design(data_, rest), noise_.shape);
      Chosen chosen{model_[i], 2.0 * (noise_.log_likelihood - without.log_likelihood), 1.0};
      chosen.p_value = p_value(model_[i], chosen.likelihood_ratio);
      result.chosen.push_back(chosen);
      if (i >= first) find_alternatives(result, i, rest, without);
    }
    result.noise = noise_;
    result.tries = tries_of_channels_;
    result.coefficients = solve(data_.grid, noise_.shape, design(data_, model_), &result.covariance);
  }

  void find_alternatives(SearchResult& result, std::size_t i, const std::vector<Candidate>& rest,
                         const NoiseFit& without) const {
    const double mine = result.chosen[i].likelihood_ratio;
    std::vector<Candidate> seen = {model_[i]};
    std::vector<Scored> scored = scan_.score(rest, without, true, &model_[i], &noise_.shape);
    std::sort(scored.begin(), scored.end(),
              [](const Scored& a, const Scored& b) { return a.ratio > b.ratio; });
    for (const Scored& each : scored) {
      const double loss = mine - each.ratio;
      if (loss > kLikeness && std::abs(each.correlation) < kAlike) continue;
      if (loss > 3.0 * kLikeness) break;
      const auto alike = [&](const Candidate& other) { return other.same_shape(each.candidate); };
      if (std::any_of(seen.begin(), seen.end(), alike)) continue;
      seen.push_back(each.candidate);
      if (seen.size() > 5) break;
      result.alternatives.push_back({i, each.candidate, each.correlation, loss});
    }
  }

  const BlockData& data_;
  const SearchOptions& options_;
  Scan scan_;
  std::vector<Candidate> model_;
  NoiseFit noise_;
  double tries_of_channels_ = 1.0, tries_of_steps_ = 1.0;  // independent ones over their share
  double least_ratio_ = 0.0;                               // of a channel's effect
};

}  // namespace

SearchResult search_effects(const BlockData& data, const SearchOptions& options) {
  const BlockData clean = with_reconstructed_channels(data);
  SearchResult result = Loop(clean, options).run();
  fit_to_readings(data, clean, result);
  return result;
}

Columns constants(const BlockGrid& grid) {
  const auto records = static_cast<Eigen::Index>(grid.starts.size()) - 1;
  Columns columns = Columns::Zero(static_cast<Eigen::Index>(grid.size()), records);
  for (Eigen::Index r = 0; r < records; ++r) {
    const auto from = static_cast<Eigen::Index>(grid.starts[static_cast<std::size_t>(r)]);
    const auto to = static_cast<Eigen::Index>(grid.starts[static_cast<std::size_t>(r) + 1]);
    columns.col(r).segment(from, to - from).setOnes();
  }
  return columns;
}

Columns design(const BlockData& data, const std::vector<Candidate>& effects) {
  const Columns constant = constants(data.grid);
  Eigen::Index width = 1 + constant.cols();
  for (const Candidate& effect : effects) width += effect.form == Form::kLine ? 2 : 1;
  Columns columns(constant.rows(), width);
  columns.col(0) = data.grid.error;
  columns.middleCols(1, constant.cols()) = constant;
  Eigen::Index at = 1 + constant.cols();
  for (const Candidate& effect : effects) {
    const Columns mine = regressors(data, effect);
    columns.middleCols(at, mine.cols()) = mine;
    at += mine.cols();
  }
  return columns;
}

std::vector<int> folds_of(const BlockGrid& grid, int folds, std::size_t turns) {
  std::vector<int> fold(grid.size());
  for (std::size_t r = 0; r + 1 < grid.starts.size(); ++r) {
    const std::size_t n = grid.starts[r + 1] - grid.starts[r];
    for (std::size_t b = 0; b < n; ++b) {
      const std::size_t piece = b * turns * static_cast<std::size_t>(folds) / n;
      fold[grid.starts[r] + b] = static_cast<int>(piece) % folds;
    }
  }
  return fold;
}

Eigen::VectorXd solve(const BlockGrid& grid, const NoiseShape& shape, const Columns& columns,
                      Eigen::MatrixXd* covariance) {
  Columns white = columns;
  const Whitening filter(grid, shape);
  filter.apply(white);
  const Eigen::Index p = columns.cols() - 1;
  const Eigen::MatrixXd gram = white.transpose() * white;
  const Eigen::VectorXd scale = gram.diagonal().tail(p).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd a = scale.asDiagonal() * gram.bottomRightCorner(p, p) * scale.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> factor(a);
  const Eigen::VectorXd scaled = factor.solve(scale.asDiagonal() * gram.col(0).tail(p));
  if (covariance) {
    const double left = std::max(gram(0, 0) - scaled.dot(scale.asDiagonal() * gram.col(0).tail(p)), 0.0);
    const double variance = left / std::max(1.0, static_cast<double>(grid.used()) - static_cast<double>(p));
    *covariance =
        variance * (scale.asDiagonal() * factor.solve(Eigen::MatrixXd::Identity(p, p)) * scale.asDiagonal());
  }
  return scale.asDiagonal() * scaled;
}

}  // namespace ifog
