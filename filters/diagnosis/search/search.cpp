// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/diagnosis/checks/cross_validation.h"
#include "filters/diagnosis/search/refine.h"
#include "filters/diagnosis/search/scan.h"
#include "filters/distributions/chi_squared.h"
#include "filters/effects/meaning.h"

namespace ifog {
namespace {

constexpr std::size_t kShortlist = 4;     // candidates of different shape that are refined per step
constexpr std::size_t kPairsTried = 2;    // in addition to the shortlist
constexpr double kRise = 1.0;             // required gain of the score of any change
constexpr double kLikeness = 6.0;         // loss below which an alternative is indistinguishable
constexpr double kTrialFactor = 1.3;      // the noise needs no higher precision before the shape is refined
constexpr double kShareOfChannels = 0.7;  // share of the significance; the rest is for steps
constexpr double kAlike = 0.98;           // sufficient correlation of the whitened regressors

// Half a fringe is no law: with a free period it replaces the other half.
bool swings(std::span<const Candidate> model, const Candidate& half) {
  return std::ranges::any_of(model, [&](const Candidate& each) { return each.swings_with(half); });
}

bool has_line(std::span<const Candidate> model, std::size_t channel) {
  return std::ranges::any_of(
      model, [&](const Candidate& each) { return each.form == Form::kLinear && each.channel == channel; });
}

std::vector<Candidate> without(std::vector<Candidate> model, std::size_t at) {
  model.erase(model.begin() + static_cast<std::ptrdiff_t>(at));
  return model;
}

// Score: twice the log-likelihood minus the price of each effect. A change must increase it by kRise; it is
// bounded, so the search ends.
class EffectSearch {
 public:
  EffectSearch(const BlockData& data, const SearchOptions& options)
      : data_(data), options_(options), scan_(data, library(data)), laws_(natural_pairs(data)) {
    scan_.pair(laws_);
  }

  SearchResult run() {
    SearchResult result;
    noise_ = first_noise(model_);
    count_tries();
    start_with_basics();
    improve();
    FittedModel unfolded{model_, noise_};
    try_second_time_constants(data_, unfolded);
    model_ = std::move(unfolded.effects);
    noise_ = std::move(unfolded.noise);
    finish(result);
    return result;
  }

 private:
  // Divides the probability of a false effect between channels and steps.
  void count_tries() {
    const double independent = independent_columns(scan_.size()) + static_cast<double>(scan_.pairs());
    tries_of_channels_ = independent / (data_.grid.dwells ? 1.0 : kShareOfChannels);
    tries_of_steps_ = static_cast<double>(data_.grid.used()) / (1.0 - kShareOfChannels);
  }

  [[nodiscard]] double p_value(const Candidate& candidate, double ratio) const {
    const double tries = candidate.form == Form::kStep ? tries_of_steps_ : tries_of_channels_;
    return std::min(1.0, kProfiled * chi_squared_above(ratio, 1.0) * tries);
  }

  // Likelihood ratio that chance reaches in `significance` of all searches.
  [[nodiscard]] double threshold(const Candidate& candidate) const {
    double ratio = 1.0;
    while (p_value(candidate, ratio) > options_.significance) ratio += 0.25;
    return ratio;
  }

  // True if `candidate` forms one law with an effect in `others`. Then it needs no separate proof, only the
  // gain that the Bayesian information criterion requires of one coefficient.
  [[nodiscard]] bool completes_a_law(const Candidate& candidate, std::span<const Candidate> others) const {
    return swings(others, candidate) || std::ranges::any_of(laws_, [&](const NaturalPair& law) {
             const auto other = candidate.same_shape(law.second)  ? &law.first
                                : candidate.same_shape(law.first) ? &law.second
                                                                  : nullptr;
             return other && has_shape(others, *other);
           });
  }

  [[nodiscard]] double score(const std::vector<Candidate>& model, const NoiseFit& noise) const {
    const auto n = static_cast<double>(data_.grid.used());
    double sum = 2.0 * noise.log_likelihood;
    for (std::size_t i = 0; i < model.size(); ++i) {
      if (is_fringe(data_, model[i]) && !swings(model, model[i])) return -1e300;
      if (is_power_beyond(data_, model[i]) && !has_line(model, model[i].channel)) return -1e300;
      const bool law = completes_a_law(model[i], std::span(model).first(i));
      sum -= complexity(model[i]) + (law ? std::log(n) : threshold(model[i]));
    }
    // Correction for few points: Hurvich and Tsai, Biometrika 76, 1989.
    const auto k = static_cast<double>(model.size()) + 2.0;
    return sum - 2.0 * k * (k + 1.0) / std::max(1.0, n - k - 1.0);
  }

  struct Trial {
    std::vector<Candidate> model;
    NoiseFit noise;
    double score = -1e300;
  };

  [[nodiscard]] Trial refined(std::vector<Candidate> model, std::size_t at, const NoiseShape& start) const {
    Trial trial;
    refine_shape(data_, start, model, at);
    trial.noise = fit_noise(data_.grid, design(data_, model), start, kTrialFactor);
    refine_shape(data_, trial.noise.shape, model, at);
    trial.noise = fit_noise(data_.grid, design(data_, model), trial.noise.shape);
    if (levels_seen(data_, model)) trial.score = score(model, trial.noise);
    trial.model = std::move(model);
    return trial;
  }

  [[nodiscard]] bool proven(const Trial& trial) const {
    if (!levels_seen(data_, trial.model)) return false;
    const Claimed claimed{trial.model, trial.noise};
    return trial.model.back().form == Form::kStep ? step_persists(data_, claimed)
                                                  : predicts_held_out(data_, claimed);
  }

  bool take(Trial trial) {
    if (trial.score < score(model_, noise_) + kRise) return false;
    model_ = std::move(trial.model);
    noise_ = trial.noise;
    return true;
  }

  [[nodiscard]] NoiseFit first_noise(const std::vector<Candidate>& model) const {
    const Columns columns = design(data_, model);
    return options_.noise ? fit_noise(data_.grid, columns, *options_.noise) : fit_noise(data_.grid, columns);
  }

  // First fits what every gyro has, before the noise model absorbs it: scale factor, misalignment,
  // temperature to second order. The kinds of noise are chosen beside all of them, then unprofitable ones are
  // removed one by one. Each noise fit starts from the noise beside all and from zero; the likelier is used.
  void start_with_basics() {
    if (data_.reference < 0) return;
    Trial basics{model_, {}, 0.0};
    for (const Candidate& each : library(data_))
      if (is_basic(each)) basics.model.push_back(each);
    if (basics.model.empty()) return;
    basics.noise = first_noise(basics.model);
    basics.score = score(basics.model, basics.noise);
    while (!basics.model.empty()) {
      Trial best;
      for (std::size_t i = 0; i < basics.model.size(); ++i) {
        Trial less{without(basics.model, i), {}, 0.0};
        const Columns columns = design(data_, less.model);
        less.noise = fit_noise(data_.grid, columns, basics.noise.shape);
        const NoiseFit other = fit_noise(data_.grid, columns, {});
        if (other.log_likelihood > less.noise.log_likelihood) less.noise = other;
        less.score = score(less.model, less.noise);
        if (less.score > best.score) best = std::move(less);
      }
      if (best.score < basics.score) break;
      basics = std::move(best);
    }
    if (!basics.model.empty() && take(std::move(basics)))
      for (const Candidate& each : model_) offer_products(each.channel);
  }

  [[nodiscard]] bool is_basic(const Candidate& each) const {
    if (each.channel == Candidate::kNone || each.form == Form::kProduct) return false;
    const FineChannel& source = data_.channels[each.channel];
    if (static_cast<std::ptrdiff_t>(each.channel) == data_.reference || source.of_axis)
      return each.form == Form::kLinear;
    return kind_of(source.name) == ChannelKind::kTemperature && names_in(source.name).less.empty() &&
           (each.form == Form::kLinear || each.form == Form::kQuadratic);
  }

  void improve() {
    while (model_.size() < options_.most_effects) {
      if (options_.progress) options_.progress(model_.size(), options_.most_effects + 1);
      if (!add_one()) break;
      revise();
    }
  }

  // Best addition to `base` from the shortlist, fully fitted.
  [[nodiscard]] Trial best_addition(const std::vector<Candidate>& base, const NoiseFit& noise,
                                    bool thorough) const {
    std::vector<Scored> scored = scan_.score(base, noise, thorough, nullptr, nullptr, thorough);
    if (thorough && !data_.grid.dwells)
      for (const Scored& step : scan_.steps(base, noise)) scored.push_back(step);
    const double law = std::log(static_cast<double>(data_.grid.used()));
    const auto price = [&](const Scored& each) {
      const bool completes = completes_a_law(each.candidate, base);
      return complexity(each.candidate) + (completes ? law : threshold(each.candidate)) +
             (each.with ? complexity(*each.with) + law : 0.0);
    };
    std::ranges::sort(
        scored, [&](const Scored& a, const Scored& b) { return a.ratio - price(a) > b.ratio - price(b); });
    Trial best;
    std::vector<Candidate> tried;
    std::size_t pairs = 0;
    for (const Scored& each : scored) {
      const Candidate& last = each.with ? *each.with : each.candidate;
      if (tried.size() >= kShortlist || each.ratio < kLikeness) break;
      if (has_shape(base, each.candidate) || has_shape(base, last) || (!each.with && has_shape(tried, last)))
        continue;
      if (each.with && pairs++ >= kPairsTried) continue;
      if (!each.with) tried.push_back(last);
      std::vector<Candidate> model = base;
      model.push_back(each.candidate);
      if (each.with) model.push_back(last);
      Trial trial = refined(model, model.size() - 1, each.shape);
      // A shock that does not last is no effect, and does not exclude one that it hides.
      if (last.form == Form::kStep && !proven(trial)) continue;
      if (trial.score > best.score) best = std::move(trial);
    }
    return best;
  }

  bool add_one() {
    Trial best = best_addition(model_, noise_, true);
    if (best.model.empty() || !proven(best)) return false;
    const std::vector<Candidate> added(best.model.begin() + static_cast<std::ptrdiff_t>(model_.size()),
                                       best.model.end());
    if (!take(std::move(best))) return false;
    for (const Candidate& each : added) offer_products(each.channel);
    return true;
  }

  // An accepted channel may modify the effect of another one.
  void offer_products(std::size_t channel) {
    if (channel == Candidate::kNone) return;
    const std::size_t before = scan_.size();
    scan_.add(products_of(data_, channel));
    tries_of_channels_ += static_cast<double>(scan_.size() - before) / kShareOfChannels;
  }

  // Tries to remove, replace and reshape each effect, since early ones were chosen without the later ones.
  void revise() {
    for (std::size_t i = 0; i < model_.size() && model_.size() > 1;) {
      std::vector<Candidate> rest = without(model_, i);
      if (is_fringe(data_, model_[i]))
        std::erase_if(rest, [&](const Candidate& each) { return each.swings_with(model_[i]); });
      const NoiseFit noise = fit_noise(data_.grid, design(data_, rest), noise_.shape);
      if (take({rest, noise, score(rest, noise)})) continue;
      Trial other = best_addition(rest, noise, false);
      if (!other.model.empty()) take(std::move(other));
      ++i;
    }
    for (std::size_t i = 0; i < model_.size(); ++i)
      if (model_[i].searched() || is_fringe(data_, model_[i])) take(refined(model_, i, noise_.shape));
  }

  void finish(SearchResult& result) {
    for (std::size_t i = 0; i < model_.size(); ++i) {
      const std::vector<Candidate> rest = without(model_, i);
      const NoiseFit noise = fit_noise(data_.grid, design(data_, rest), noise_.shape);
      Chosen chosen{model_[i], 2.0 * (noise_.log_likelihood - noise.log_likelihood), 1.0};
      chosen.of_a_law = completes_a_law(model_[i], rest);
      // The other term of the law is proven, so only this term was tried.
      chosen.p_value = chosen.of_a_law
                           ? std::min(1.0, kProfiled * chi_squared_above(chosen.likelihood_ratio, 1.0))
                           : p_value(model_[i], chosen.likelihood_ratio);
      result.chosen.push_back(chosen);
      find_alternatives(result, i, rest, noise);
    }
    result.noise = noise_;
    result.tries = tries_of_channels_;
    result.coefficients = solve(data_.grid, noise_.shape, design(data_, model_), &result.covariance);
  }

  void find_alternatives(SearchResult& result, std::size_t i, const std::vector<Candidate>& rest,
                         const NoiseFit& noise) const {
    const double mine = result.chosen[i].likelihood_ratio;
    std::vector<Candidate> seen = {model_[i]};
    std::vector<Scored> scored = scan_.score(rest, noise, true, &model_[i], &noise_.shape);
    std::ranges::sort(scored, [](const Scored& a, const Scored& b) { return a.ratio > b.ratio; });
    for (const Scored& each : scored) {
      const double loss = mine - each.ratio;
      if (loss > kLikeness && std::abs(each.correlation) < kAlike) continue;
      if (loss > 3.0 * kLikeness) break;
      if (has_shape(seen, each.candidate)) continue;
      seen.push_back(each.candidate);
      if (seen.size() > 5) break;
      result.alternatives.push_back({i, each.candidate, each.correlation, loss});
    }
  }

  const BlockData& data_;
  const SearchOptions& options_;
  Scan scan_;
  std::vector<NaturalPair> laws_;
  std::vector<Candidate> model_;
  NoiseFit noise_;
  // Numbers of independent tries / their share of the significance
  double tries_of_channels_ = 1.0, tries_of_steps_ = 1.0;
};

}  // namespace

std::vector<Candidate> candidates_of(const std::vector<Chosen>& chosen) {
  std::vector<Candidate> candidates;
  candidates.reserve(chosen.size());
  for (const Chosen& each : chosen) candidates.push_back(each.candidate);
  return candidates;
}

SearchResult search_effects(const BlockData& data, const SearchOptions& options) {
  return EffectSearch(data, options).run();
}

}  // namespace ifog
