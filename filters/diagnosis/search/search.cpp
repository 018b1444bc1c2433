// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "filters/diagnosis/checks/checks.h"
#include "filters/diagnosis/search/refine.h"
#include "filters/diagnosis/search/scan.h"
#include "filters/distributions/chi_squared.h"
#include "filters/effects/meaning.h"
#include "filters/model_file/channel_names.h"

namespace ifog {
namespace {

constexpr std::size_t kShortlist = 4;     // candidates of different shape that are refined per step
constexpr std::size_t kPairsTried = 2;    // in addition to the shortlist
constexpr double kRise = 1.0;             // required gain of the score of any change
constexpr double kLikeness = 6.0;         // loss below which an alternative is indistinguishable
constexpr double kTrialFactor = 1.3;      // the noise needs no higher precision before the shape is refined
constexpr double kShareOfChannels = 0.7;  // share of the significance; the rest is for steps
constexpr double kAlike = 0.98;           // sufficient correlation of the whitened regressors
constexpr double kImpossible = -1e300;    // score
// further effects on a rate table: powers and products of the scale factor
constexpr std::size_t kMoreOnDwells = 4;

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
  EffectSearch(const BlockData& data, const DiagnoseOptions& options, const NoiseShape* noise)
      : data_(data),
        options_(options),
        start_(noise),
        most_effects_(options.most_effects + (data.grid.dwells ? kMoreOnDwells : 0)),
        scan_(data, library(data)),
        laws_(natural_pairs(data)) {
    scan_.pair(laws_);
  }

  SearchResult run() {
    SearchResult result;
    model_.noise = first_noise(model_.effects);
    count_tries();
    start_with_basics();
    improve();
    try_second_time_constants(data_, model_);
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

  [[nodiscard]] double tries_of(const Candidate& candidate) const {
    return candidate.form == Form::kStep ? tries_of_steps_ : tries_of_channels_;
  }

  // Likelihood ratio that chance reaches in `significance` of all searches.
  [[nodiscard]] double threshold(const Candidate& candidate) const {
    return chi_squared_exceeded(options_.significance / (kProfiled * tries_of(candidate)), 1.0);
  }

  // True if `candidate` forms one law with an effect in `others`. Then it needs no separate proof, only the
  // gain that the Bayesian information criterion requires of one coefficient.
  [[nodiscard]] bool completes_a_law(const Candidate& candidate, std::span<const Candidate> others) const {
    return std::ranges::any_of(laws_, [&](const NaturalPair& law) {
      const auto other = candidate.same_shape(law.second)  ? &law.first
                         : candidate.same_shape(law.first) ? &law.second
                                                           : nullptr;
      return other && has_shape(others, *other);
    });
  }

  [[nodiscard]] double score(const FittedModel& model) const {
    const std::vector<Candidate>& effects = model.effects;
    const auto n = static_cast<double>(data_.grid.used());
    double sum = 2.0 * model.noise.log_likelihood;
    for (std::size_t i = 0; i < effects.size(); ++i) {
      if (is_power_beyond(data_, effects[i]) && !has_line(effects, effects[i].channel)) return kImpossible;
      const bool law = completes_a_law(effects[i], std::span(effects).first(i));
      sum -= complexity(effects[i]) + (law ? std::log(n) : threshold(effects[i]));
    }
    // Correction for few points: Hurvich and Tsai, Biometrika 76, 1989.
    const auto k = static_cast<double>(effects.size()) + 2.0;
    return sum - 2.0 * k * (k + 1.0) / std::max(1.0, n - k - 1.0);
  }

  // start: of the search for the noise.
  [[nodiscard]] FittedModel fitted(std::vector<Candidate> effects, const NoiseShape& start) const {
    const NoiseFit noise = fit_noise(data_.grid, design(data_, effects), start);
    return {std::move(effects), noise};
  }

  struct Trial {
    FittedModel model;
    double score = kImpossible;
  };

  [[nodiscard]] Trial refined(std::vector<Candidate> model, std::size_t at, const NoiseShape& start) const {
    refine_shape(data_, start, model, at);
    NoiseFit noise = fit_noise(data_.grid, design(data_, model), start, kTrialFactor);
    refine_shape(data_, noise.shape, model, at);
    noise = fit_noise(data_.grid, design(data_, model), noise.shape);
    Trial trial{{std::move(model), noise}};
    trial.score = score(trial.model);
    return trial;
  }

  [[nodiscard]] bool proven(const FittedModel& model) const {
    return model.effects.back().form == Form::kStep ? step_persists(data_, model)
                                                    : predicts_held_out(data_, model);
  }

  // Index of an effect that held-out blocks refute.
  [[nodiscard]] std::optional<std::size_t> refuted(const FittedModel& model) const {
    for (std::size_t i = 0; i < model.effects.size(); ++i) {
      FittedModel on_trial{without(model.effects, i), model.noise};
      on_trial.effects.push_back(model.effects[i]);
      if (!proven(on_trial)) return i;
    }
    return std::nullopt;
  }

  bool take(Trial trial) {
    if (trial.score < score(model_) + kRise) return false;
    model_ = std::move(trial.model);
    return true;
  }

  [[nodiscard]] NoiseFit first_noise(const std::vector<Candidate>& model) const {
    const Columns columns = design(data_, model);
    return start_ ? fit_noise(data_.grid, columns, *start_) : fit_noise(data_.grid, columns);
  }

  // First fits what every gyro has, before the noise model absorbs it: scale factor, misalignment,
  // temperature to second order. The kinds of noise are chosen beside all of them, then unprofitable ones are
  // removed one by one, and those that held-out blocks refute. Each noise fit starts from the noise beside all and
  // from zero; the likelier is used.
  void start_with_basics() {
    if (data_.reference < 0) return;
    std::vector<Candidate> effects;
    for (const Candidate& each : library(data_))
      if (is_basic(each)) effects.push_back(each);
    if (effects.empty()) return;
    const NoiseFit noise = first_noise(effects);
    Trial basics{{std::move(effects), noise}};
    basics.score = score(basics.model);
    while (!basics.model.effects.empty()) {
      Trial best;
      for (std::size_t i = 0; i < basics.model.effects.size(); ++i) {
        const std::vector<Candidate> less = without(basics.model.effects, i);
        for (const NoiseShape& start : {basics.model.noise.shape, NoiseShape{}}) {
          FittedModel model = fitted(less, start);
          const double mine = score(model);
          if (mine > best.score) best = {std::move(model), mine};
        }
      }
      if (best.score < basics.score) break;
      basics = std::move(best);
    }
    while (const auto at = refuted(basics.model)) {
      basics.model = fitted(without(basics.model.effects, *at), basics.model.noise.shape);
      basics.score = score(basics.model);
    }
    if (!basics.model.effects.empty() && take(std::move(basics)))
      for (const Candidate& each : model_.effects) offer_products(each.channel);
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
    while (model_.effects.size() < most_effects_) {
      if (options_.progress) options_.progress(model_.effects.size(), most_effects_ + 1);
      if (!add_one()) break;
      revise();
    }
  }

  // Best addition to `base` from the shortlist, fully fitted.
  [[nodiscard]] Trial best_addition(const FittedModel& base, bool thorough) const {
    const std::vector<Candidate>& effects = base.effects;
    std::vector<Scored> scored = scan_.score(base, thorough);
    if (thorough && !data_.grid.dwells)
      for (const Scored& step : scan_.steps(base)) scored.push_back(step);
    const double law = std::log(static_cast<double>(data_.grid.used()));
    const auto price = [&](const Scored& each) {
      const bool completes = completes_a_law(each.candidate, effects);
      return complexity(each.candidate) + (completes ? law : threshold(each.candidate)) +
             (each.with ? complexity(*each.with) + law : 0.0);
    };
    for (Scored& each : scored) each.score = each.ratio - price(each);
    std::ranges::sort(scored, std::greater{}, &Scored::score);
    Trial best;
    std::vector<Candidate> tried;
    std::size_t pairs = 0;
    for (const Scored& each : scored) {
      const Candidate& last = each.with ? *each.with : each.candidate;
      if (tried.size() >= kShortlist || each.ratio < kLikeness) break;
      if (has_shape(effects, each.candidate) || has_shape(effects, last) ||
          (!each.with && has_shape(tried, last)))
        continue;
      if (each.with && pairs++ >= kPairsTried) continue;
      if (!each.with) tried.push_back(last);
      std::vector<Candidate> model = effects;
      model.push_back(each.candidate);
      if (each.with) model.push_back(last);
      Trial trial = refined(model, model.size() - 1, each.shape);
      // A shock that does not last is no effect, and does not exclude one that it hides.
      if (last.form == Form::kStep && !proven(trial.model)) continue;
      if (trial.score > best.score) best = std::move(trial);
    }
    return best;
  }

  bool add_one() {
    Trial best = best_addition(model_, true);
    if (best.model.effects.empty() || !proven(best.model)) return false;
    const std::size_t before = model_.effects.size();
    if (!take(std::move(best))) return false;
    for (std::size_t i = before; i < model_.effects.size(); ++i) offer_products(model_.effects[i].channel);
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
    for (std::size_t i = 0; i < model_.effects.size() && model_.effects.size() > 1;) {
      const FittedModel rest = fitted(without(model_.effects, i), model_.noise.shape);
      if (take({rest, score(rest)})) continue;
      take(best_addition(rest, false));
      ++i;
    }
    for (std::size_t i = 0; i < model_.effects.size(); ++i)
      if (model_.effects[i].searched()) take(refined(model_.effects, i, model_.noise.shape));
  }

  void finish(SearchResult& result) {
    for (std::size_t i = 0; i < model_.effects.size(); ++i) {
      const FittedModel rest = fitted(without(model_.effects, i), model_.noise.shape);
      Chosen chosen;
      chosen.candidate = model_.effects[i];
      chosen.likelihood_ratio = 2.0 * (model_.noise.log_likelihood - rest.noise.log_likelihood);
      chosen.of_a_law = completes_a_law(chosen.candidate, rest.effects);
      // If the other term of the law is proven, only this term was tried.
      const double tries = chosen.of_a_law ? 1.0 : tries_of(chosen.candidate);
      chosen.p_value = std::min(1.0, kProfiled * chi_squared_above(chosen.likelihood_ratio, 1.0) * tries);
      result.chosen.push_back(chosen);
      find_alternatives(result, i, rest);
    }
    result.noise = model_.noise;
    result.tries = tries_of_channels_;
    fit_coefficients(data_, result);
  }

  void find_alternatives(SearchResult& result, std::size_t i, const FittedModel& rest) const {
    const double mine = result.chosen[i].likelihood_ratio;
    std::vector<Candidate> seen = {model_.effects[i]};
    std::vector<Scored> scored = scan_.score(rest, true, &model_.noise.shape);
    std::erase_if(scored, [](const Scored& each) { return each.with.has_value(); });
    find_step_instead(result, i, rest, scored);
    const Eigen::VectorXd correlations =
        scan_.correlations(rest.effects, model_.effects[i], model_.noise.shape);
    for (std::size_t k = 0; k < scored.size(); ++k)
      scored[k].correlation = correlations[static_cast<Eigen::Index>(k)];
    std::ranges::sort(scored, std::greater{}, &Scored::ratio);
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

  // A single event may be both: what the channel did there, or a jump, as of a gyro that is switched off and on.
  // scored: all candidates, in their order.
  void find_step_instead(SearchResult& result, std::size_t i, const FittedModel& rest,
                         const std::vector<Scored>& scored) const {
    const std::vector<Scored> steps = data_.grid.dwells ? std::vector<Scored>{} : scan_.steps(rest);
    const auto own = std::ranges::find_if(
        scored, [&](const Scored& each) { return each.candidate.same_shape(model_.effects[i]); });
    if (steps.empty() || own == scored.end()) return;
    std::vector<Candidate> instead = rest.effects;
    instead.push_back(std::ranges::max(steps, {}, &Scored::ratio).candidate);
    const FittedModel model = fitted(std::move(instead), model_.noise.shape);
    const double loss = 2.0 * (model_.noise.log_likelihood - model.noise.log_likelihood);
    if (loss > kLikeness || !step_persists(data_, model)) return;
    const Candidate& step = model.effects.back();
    const Eigen::VectorXd alike = scan_.correlations(rest.effects, step, model_.noise.shape);
    result.alternatives.push_back({i, step, alike[own - scored.begin()], loss});
  }

  const BlockData& data_;
  const DiagnoseOptions& options_;
  const NoiseShape* start_;
  std::size_t most_effects_;
  Scan scan_;
  std::vector<NaturalPair> laws_;
  FittedModel model_;
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

Eigen::VectorXd coefficients_of(const std::vector<Chosen>& chosen) {
  Eigen::VectorXd coefficients(static_cast<Eigen::Index>(chosen.size()));
  std::ranges::transform(chosen, coefficients.begin(), &Chosen::coefficient);
  return coefficients;
}

void fit_coefficients(const BlockData& data, SearchResult& found) {
  const WhitenedFit fit =
      fit_whitened(data.grid, found.noise.shape, design(data, candidates_of(found.chosen)));
  const Eigen::VectorXd coefficients = fit.coefficients();
  const Eigen::VectorXd variances = fit.covariance().diagonal();
  for (std::size_t i = 0; i < found.chosen.size(); ++i) {
    const Eigen::Index at = column_of(data.grid, i) - 1;
    found.chosen[i].coefficient = coefficients[at];
    found.chosen[i].std_error = std::sqrt(variances[at]);
  }
}

SearchResult search_effects(const BlockData& data, const DiagnoseOptions& options, const NoiseShape* noise) {
  return EffectSearch(data, options, noise).run();
}

}  // namespace ifog
