// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "filters/diagnosis/checks/proof.h"
#include "filters/diagnosis/regression/harmonics.h"
#include "filters/diagnosis/search/channels_first.h"
#include "filters/diagnosis/search/effective_tries.h"
#include "filters/diagnosis/search/fit_to_readings.h"
#include "filters/diagnosis/search/fringes.h"
#include "filters/diagnosis/search/refine.h"
#include "filters/diagnosis/search/scan.h"
#include "filters/diagnosis/search/unfold.h"

namespace ifog {
namespace {

constexpr std::size_t kShortlist = 4;  // candidates of different shape that are refined at each step
constexpr double kSwapGain = 3.0;      // twice the log-likelihood a swap or a pair has to gain
constexpr double kLikeness = 6.0;      // loss below which another effect cannot be told from the chosen one
constexpr double kTrialFactor = 1.3;   // noise parameters need no more precision before the shape is refined
constexpr double kShareOfChannels = 0.7;  // of the significance; the rest is for steps
// What a natural pair has to bring beyond its two effects' complexity: it has one more coefficient than a
// form about a known point.
constexpr double kSecondOfPair = 6.0;
constexpr std::size_t kPairsTried = 2;  // beside the shortlist
constexpr double kCorrelated = 0.2;     // correlation of two coefficients
constexpr double kAlike = 0.98;         // or this correlation of the whitened regressors

bool is_event(const Candidate& candidate) {
  return candidate.form == Form::kLine || candidate.form == Form::kStep;
}

class EffectSearch {
 public:
  EffectSearch(const BlockData& data, const SearchOptions& options, std::vector<Candidate> candidates)
      : data_(data), options_(options), scan_(data, std::move(candidates)), model_(options.given) {
    scan_.pair(natural_pairs(data));
  }

  SearchResult run() {
    SearchResult result;
    noise_ = fit_noise(data_.grid, design(data_, model_));
    result.noise_without = noise_;
    count_tries();
    do add_effects();
    while (add_fringe());
    // Beside the effects there may be fewer harmonics, or one that they had hidden.
    noise_ = with_harmonics(data_.grid, design(data_, model_), noise_);
    revise_pairs();
    drop_what_slow_denies();
    unfold();
    finish(result);
    return result;
  }

 private:
  void add_effects() {
    while (model_.size() < options_.most_effects + options_.given.size()) {
      if (options_.progress) options_.progress(model_.size(), options_.most_effects + 1);
      if (!add_one() && !add_pair()) break;
      revise();
    }
  }

  // When all else is in: what polynomials of a temperature stood for, or what is still slow.
  bool add_fringe() {
    if (model_.size() + 1 >= options_.most_effects + options_.given.size()) return false;
    std::optional<FittedModel> found = with_fringe(data_, options_.given.size(), {model_, noise_},
                                                   {options_.significance, tries_of_channels_});
    if (!found) return false;
    model_ = std::move(found->effects);
    noise_ = std::move(found->noise);
    return true;
  }

  // The chance of a false effect is shared out between channels and steps.
  void count_tries() {
    const double level = 20.0;  // near what will be asked for
    const double independent = scan_.independent(model_, noise_.shape) + static_cast<double>(scan_.pairs());
    tries_of_channels_ = independent / kShareOfChannels;
    tries_of_steps_ = independent_steps(data_.grid, noise_.shape, level) / (1.0 - kShareOfChannels);
    if (data_.grid.dwells) tries_of_channels_ *= kShareOfChannels;
    least_ratio_ = 1.0;
    while (kProfiled * tail(least_ratio_, 1) * tries_of_channels_ > options_.significance)
      least_ratio_ += 0.25;
  }

  [[nodiscard]] double p_value(const Candidate& candidate, double ratio) const {
    const int columns = static_cast<int>(candidate.width());
    const double tries = candidate.form == Form::kStep ? tries_of_steps_ : tries_of_channels_;
    return std::min(1.0, kProfiled * tail(ratio, columns) * tries);
  }

  struct Trial {
    std::vector<Candidate> model;
    NoiseFit noise;
    double score = -1e300;  // twice the log-likelihood less complexity
    std::size_t added = 1;  // the last so many effects
  };

  Trial refined(std::vector<Candidate> model, std::size_t at, const NoiseShape& start) const {
    Trial trial;
    if (model[at].searched()) refine_shape(data_, start, model, at);
    trial.noise = fit_noise(data_.grid, design(data_, model), start, kTrialFactor);
    if (model[at].searched()) refine_shape(data_, trial.noise.shape, model, at);
    trial.noise = fit_noise(data_.grid, design(data_, model), trial.noise.shape);
    if (levels_seen(data_, model)) trial.score = 2.0 * trial.noise.log_likelihood - complexity(model);
    trial.model = std::move(model);
    return trial;
  }

  // The best of the shortlist, fully fitted, as an addition to `base`.
  Trial best_addition(const std::vector<Candidate>& base, const NoiseFit& noise, bool thorough) const {
    Trial best;
    std::vector<Scored> scored = scan_.score(base, noise, thorough, nullptr, nullptr, thorough);
    if (thorough && !data_.grid.dwells) {
      for (const Scored& step : scan_.steps(base, noise)) scored.push_back(step);
    }
    std::sort(scored.begin(), scored.end(),
              [](const Scored& a, const Scored& b) { return a.ratio - price(a) > b.ratio - price(b); });
    const auto among = [](const std::vector<Candidate>& model, const Candidate& candidate) {
      return std::any_of(model.begin(), model.end(),
                         [&](const Candidate& other) { return other.same_shape(candidate); });
    };
    std::vector<Candidate> tried;
    std::size_t pairs = 0;
    for (const Scored& each : scored) {
      if (tried.size() >= kShortlist || each.ratio < 0.5 * least_ratio_) break;
      if (each.with && pairs == kPairsTried) continue;
      const Candidate& last = each.with ? *each.with : each.candidate;
      if (among(base, each.candidate) || among(base, last) || (!each.with && among(tried, last))) continue;
      if (each.with)
        ++pairs;
      else
        tried.push_back(last);
      std::vector<Candidate> model = base;
      model.push_back(each.candidate);
      if (each.with) model.push_back(last);
      Trial trial = refined(model, model.size() - 1, each.shape);
      if (each.with) trial.score -= kSecondOfPair;
      if (each.with) trial.added = 2;
      // A knock that does not last is no effect, nor does it speak against one that is hidden beside it.
      if (last.form == Form::kStep && !proven(trial)) continue;
      if (trial.score > best.score) best = trial;
    }
    return best;
  }

  static double price(const Scored& scored) {
    return complexity(scored.candidate) + (scored.with ? complexity(*scored.with) + kSecondOfPair : 0.0);
  }

  bool add_one() {
    Trial best = best_addition(model_, noise_, true);
    if (best.model.empty()) return false;
    const double ratio = 2.0 * (best.noise.log_likelihood - noise_.log_likelihood);
    const std::vector<Candidate> added(best.model.end() - static_cast<std::ptrdiff_t>(best.added),
                                       best.model.end());
    const double gain = ratio - complexity(added);
    const double p = best.added == 2 ? std::min(1.0, kProfiled * tail(gain, 2) * tries_of_channels_)
                                     : p_value(added.back(), gain);
    if (p > options_.significance || !proven(best)) return false;
    model_ = best.model;
    noise_ = best.noise;
    for (const Candidate& each : added)
      if (each.channel != Candidate::kNone) offer_products(each.channel);
    return true;
  }

  void offer_products(std::size_t channel) {
    const std::size_t before = scan_.size();
    scan_.add(products_of(data_, channel));
    tries_of_channels_ += static_cast<double>(scan_.size() - before) / kShareOfChannels;
  }

  [[nodiscard]] bool proven(const Trial& trial) const {
    if (!levels_seen(data_, trial.model)) return false;
    const Claimed claimed{trial.model, trial.noise};
    return trial.model.back().form == Form::kStep ? step_persists(data_, claimed)
                                                  : predicts_held_out(data_, claimed);
  }

  // Judged when all effects are in: one of two that oppose each other makes the error larger until the other
  // comes.
  void drop_what_slow_denies() {
    for (std::size_t i = options_.given.size(); i < model_.size();) {
      std::vector<Candidate> rest = model_;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      std::vector<Candidate> ordered = rest;
      ordered.push_back(model_[i]);
      const NoiseFit without = fit_noise(data_.grid, design(data_, rest), noise_.shape);
      if (agrees_with_plain_fit(data_, {ordered, noise_}, {rest, without})) {
        ++i;
        continue;
      }
      model_ = rest;
      noise_ = without;
      i = options_.given.size();
    }
  }

  void unfold() {
    FittedModel model{model_, noise_};
    const std::size_t first = options_.given.size();
    try_factors_apart(data_, first, model);
    try_second_time_constants(data_, first, model);
    try_second_layers(data_, first, model);
    model_ = std::move(model.effects);
    noise_ = std::move(model.noise);
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
    if (ratio < 2.0 * least_ratio_ +
                    complexity(std::vector<Candidate>{trial.model.end() - 2, trial.model.end()}) ||
        !proven(trial))
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
      const double score = 2.0 * noise_.log_likelihood - complexity(model_);
      if (!other.model.empty() && other.score > score + kSwapGain) {
        model_ = other.model;
        noise_ = other.noise;
      }
      ++i;
    }
    for (std::size_t i = first; i < model_.size(); ++i) {
      if (!model_[i].searched()) continue;
      Trial trial = refined(model_, i, noise_.shape);
      if (levels_seen(data_, trial.model) && trial.noise.log_likelihood > noise_.log_likelihood) {
        model_ = trial.model;
        noise_ = trial.noise;
      }
    }
  }

  // Two effects whose coefficients depend on each other can be two others together: a slow channel with a lag
  // and its settling at the start are the channel and its derivative.
  void revise_pairs() {
    const std::size_t first = options_.given.size();
    for (std::size_t i = first; i < model_.size(); ++i) {
      for (std::size_t j = i + 1; j < model_.size(); ++j) {
        if (is_event(model_[i]) || is_event(model_[j]) || !depend(i, j)) continue;
        const Trial other = best_instead_of(i, j);
        if (other.model.empty()) continue;
        if (other.score < 2.0 * noise_.log_likelihood - complexity(model_) + kSwapGain || !proven(other))
          continue;
        model_ = other.model;
        noise_ = other.noise;
      }
    }
  }

  [[nodiscard]] bool depend(std::size_t i, std::size_t j) const {
    Eigen::MatrixXd covariance;
    solve(data_.grid, noise_.shape, design(data_, model_), &covariance);
    const Eigen::Index a = column_of(data_.grid, model_, i) - 1;
    const Eigen::Index b = column_of(data_.grid, model_, j) - 1;
    return std::abs(covariance(a, b)) > kCorrelated * std::sqrt(covariance(a, a) * covariance(b, b));
  }

  // Empty when the best two are the two there are.
  [[nodiscard]] Trial best_instead_of(std::size_t i, std::size_t j) const {
    std::vector<Candidate> model;
    for (std::size_t k = 0; k < model_.size(); ++k) {
      if (k != i && k != j) model.push_back(model_[k]);
    }
    const NoiseFit without = fit_noise(data_.grid, design(data_, model), noise_.shape);
    const auto pair = scan_.best_pair(model, without, &noise_.shape);
    if (!pair) return {};
    const auto [a, b] = *pair;
    const auto is = [&](const Candidate& x, const Candidate& y) {
      return x.same_shape(model_[i]) && y.same_shape(model_[j]);
    };
    if (is(a, b) || is(b, a)) return {};
    model.push_back(a);
    model.push_back(b);
    const std::size_t last = model.size() - 1;
    const Trial once = refined(std::move(model), last, noise_.shape);
    return refined(once.model, last - 1, once.noise.shape);
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

std::vector<Candidate> candidates_of(const std::vector<Chosen>& chosen) {
  std::vector<Candidate> candidates;
  candidates.reserve(chosen.size());
  for (const Chosen& each : chosen) candidates.push_back(each.candidate);
  return candidates;
}

double score_of(const SearchResult& result) {
  double score = 2.0 * result.noise.log_likelihood;
  for (const Chosen& each : result.chosen) score -= complexity(each.candidate);
  return score;
}

namespace {

SearchResult searched(const BlockData& reconstructed, const SearchOptions& options) {
  std::vector<Candidate> candidates = library(reconstructed);
  SearchResult found = EffectSearch(reconstructed, options, candidates).run();
  if (!has_warm_up(found)) return found;
  std::erase_if(candidates, [](const Candidate& each) { return each.form == Form::kWarmUp; });
  SearchResult by_channels = EffectSearch(reconstructed, options, std::move(candidates)).run();
  return channels_explain_it(reconstructed.grid, by_channels, found) ? by_channels : found;
}

}  // namespace

SearchResult search_effects(const BlockData& data, const BlockData& reconstructed,
                            const SearchOptions& options) {
  SearchResult result = searched(reconstructed, options);
  result.fitted = candidates_of(result.chosen);
  result.fitted_coefficients = result.coefficients;
  fit_to_readings(data, reconstructed, result);
  return result;
}

}  // namespace ifog
