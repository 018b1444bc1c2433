// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/tune.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <stdexcept>

#include "filters/threads/share_out.h"
#include "filters/tune/candidate.h"
#include "filters/tune/choice.h"
#include "filters/tune/maximum.h"
#include "filters/tune/spectrum.h"
#include "filters/tune/whittle.h"

namespace ifog {
namespace {

// Random starts per parameter in addition to the level's two.
constexpr std::size_t kDraws = 60;
// Number of the spectrum's optima whose exact likelihood is computed, and of the best of these, which are optimised further;
// the two likelihoods differ by a few units.
constexpr std::size_t kLooked = 8, kFollowed = 3;

// Axes divided by their own scales, so that all count equally.
struct Data {
  std::vector<std::vector<double>> axes;  // scaled
  double period_s = 0.0;
  double scale = 1.0;       // of the mean variance of all axes
  double log_scales = 0.0;  // sum over all samples
  std::size_t samples = 0;
};

// Mean square of successive differences, and their number.
std::pair<double, std::size_t> differences(std::span<const double> axis) {
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t k = 1; k < axis.size(); ++k)
    if (const double d = axis[k] - axis[k - 1]; std::isfinite(d)) squares += d * d, ++count;
  return {count > 0 ? squares / static_cast<double>(count) : 0.0, count};
}

Data scaled(std::span<const std::span<const double>> axes, double period_s) {
  Data data;
  data.period_s = period_s;
  std::vector<double> variances;
  double sum = 0.0, loud = 0.0;
  std::size_t n = 0;
  for (const auto& axis : axes) {
    const auto [variance, count] = differences(axis);
    variances.push_back(variance);
    sum += variance, loud += variance > 0.0 ? 1.0 : 0.0;
    n += count;
  }
  if (n < 200) throw std::invalid_argument(std::to_string(n) + " usable samples, expected at least 200");
  if (loud <= 0.0) throw std::invalid_argument("every sample has the same value, expected a sensor's noise");
  data.scale = std::sqrt(sum / loud);
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const double own = variances[a] > 0.0 ? std::sqrt(variances[a]) : data.scale;
    // Subtracts the first value to keep digits; the level is in the model.
    const auto first = std::ranges::find_if(axes[a], [](double v) { return std::isfinite(v); });
    const double level = first == axes[a].end() ? 0.0 : *first;
    auto& copy = data.axes.emplace_back();
    for (const double v : axes[a]) copy.push_back((v - level) / own);
    const auto samples =
        static_cast<std::size_t>(std::ranges::count_if(axes[a], [](double v) { return std::isfinite(v); }));
    data.samples += samples;
    data.log_scales += static_cast<double>(samples) * std::log(own);
  }
  return data;
}

LikelihoodRecord record_of(const Data& data, std::size_t samples) {
  std::vector<std::span<const double>> parts;
  for (const auto& axis : data.axes) parts.push_back(std::span(axis).first(samples));
  return LikelihoodRecord(parts);
}

struct Fit {
  std::vector<double> theta;
  double cost = 1e300;
  Eigen::MatrixXd information;  // expected, at theta
};

Fit fit(const ModelCandidate& candidate, const RecordSpectrum& spectrum, const RecordObjective& objective) {
  const std::size_t draws = kDraws * static_cast<std::size_t>(candidate.size() - 1);
  const std::vector<WhittleOptimum> optima = whittle_optima(candidate, spectrum, draws);
  std::vector<Fit> starts;
  for (std::size_t i = 0; i < std::min(optima.size(), kLooked); ++i)
    starts.push_back({optima[i].theta, objective(optima[i].theta), {}});
  std::ranges::sort(starts, {}, &Fit::cost);
  starts.resize(std::min(starts.size(), kFollowed));
  for (Fit& start : starts)
    start.cost = find_maximum(objective, whittle_information(candidate, spectrum, start.theta), start.theta);
  Fit best = std::ranges::min(starts, {}, &Fit::cost);
  best.information = whittle_information(candidate, spectrum, best.theta);
  return best;
}

// Errors of the reported figures: covariance of theta propagated by their gradients.
std::vector<TunedFigure> figures_with_errors(const ModelCandidate& candidate,
                                             const std::vector<double>& theta, double scale,
                                             const Eigen::MatrixXd& covariance,
                                             const std::vector<bool>& known) {
  const auto base = candidate.figures(theta, scale);
  Eigen::MatrixXd slope(std::ssize(base), std::ssize(theta));
  constexpr double kStep = 1e-6;
  for (std::size_t i = 0; i < theta.size(); ++i) {
    std::vector<double> other = theta;
    other[i] += kStep;
    const auto moved = candidate.figures(other, scale);
    for (std::size_t f = 0; f < base.size(); ++f)
      slope(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(i)) =
          (moved[f].value - base[f].value) / kStep;
  }
  std::vector<TunedFigure> out;
  for (std::size_t f = 0; f < base.size(); ++f) {
    const Eigen::RowVectorXd gradient = slope.row(static_cast<Eigen::Index>(f));
    bool all_known = true;
    for (std::size_t i = 0; i < theta.size(); ++i)
      all_known = all_known && (known[i] || gradient[static_cast<Eigen::Index>(i)] == 0.0);
    out.push_back({base[f].name, base[f].unit, base[f].value, std::nullopt});
    if (all_known) out.back().std_error = std::sqrt(std::max(0.0, gradient.dot(gradient * covariance)));
  }
  return out;
}

struct Fitted {
  TunedModel model;
  std::vector<double> theta;
  Eigen::MatrixXd information;
};

Fitted fit_model(const ModelCandidate& candidate, const Data& data, const RecordSpectrum& spectrum,
                 const LikelihoodRecord& record) {
  const RecordObjective objective(candidate, record, data.period_s);
  Fit found = fit(candidate, spectrum, objective);
  TunedModel model;
  model.parameters = candidate.size();
  const auto count = static_cast<double>(data.samples);
  // Density of the data in rad/s, comparable with other programs.
  model.log_likelihood = -found.cost - data.log_scales;
  model.bic = model.parameters * std::log(count) - 2.0 * model.log_likelihood;
  std::vector<bool> known;
  const Eigen::MatrixXd errors = covariance_at(objective, found.information, found.theta, known);
  model.walk_is_bound = bound_hidden_walk(objective, found.theta);
  model.settings = candidate.settings(found.theta, data.scale);
  model.figures = figures_with_errors(candidate, found.theta, data.scale, errors, known);
  TunedFigure& walk = model.figures.front();
  // The limit is one standard deviation.
  if (model.walk_is_bound) walk.std_error = walk.value;
  return {std::move(model), std::move(found.theta), std::move(found.information)};
}

// Fits the model to the first half, starting at the optimum of the whole record, and tests it on the second.
Outcome held_out(const ModelCandidate& candidate, const Data& data, const Fitted& fitted,
                 std::span<const std::span<const double>> axes, const LikelihoodRecord& first_half) {
  const RecordObjective objective(candidate, first_half, data.period_s);
  std::vector<double> theta = fitted.theta;
  const std::size_t half = data.axes[0].size() / 2;
  find_maximum(objective, 0.5 * fitted.information, theta);
  (void)bound_hidden_walk(objective, theta);
  return outcome_of(candidate.settings(theta, data.scale), axes, data.period_s, half);
}

// Order by BIC, rounded to 0.5, the accuracy of the optima. A Gauss-Markov process and an AR(1) with positive
// coefficient are equal at the samples and tie; below ten samples the correlation time is not meaningful, so
// AR(1) is preferred.
std::pair<double, bool> rank(const TunedModel& model, double period_s) {
  constexpr double kShort = 10.0;
  const bool only_a_name = model.settings.state == "random-walk + gauss-markov" &&
                           model.settings.state_parameters[0] < kShort * period_s;
  return {std::round(2.0 * model.bic), only_a_name};
}

}  // namespace

Tuning tune(std::span<const std::span<const double>> axes, double period_s, const TuneOptions& options) {
  const Data data = scaled(axes, period_s);
  const std::vector<std::string> states = options.states.empty() ? default_candidates() : options.states;
  std::vector<ModelCandidate> candidates;
  candidates.reserve(states.size());
  for (const std::string& state : states) candidates.emplace_back(state, period_s);
  const RecordSpectrum spectrum = spectrum_of(data.axes);
  const std::size_t length = data.axes[0].size();
  const LikelihoodRecord record = record_of(data, length);
  // Largest first, to balance the threads.
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, std::ranges::greater{},
                           [&](std::size_t i) { return candidates[i].size(); });
  std::vector<Fitted> fitted(candidates.size());
  std::mutex guard;
  std::size_t done = 0;
  share_out(order.size(), options.threads, [&](std::size_t item) {
    const std::size_t i = order[item];
    fitted[i] = fit_model(candidates[i], data, spectrum, record);
    const std::lock_guard lock(guard);
    if (options.progress) options.progress(++done, candidates.size());
  });
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return rank(fitted[i].model, period_s); });
  if (options.hold_out) {
    const LikelihoodRecord first_half = record_of(data, length / 2);
    share_out(order.size(), options.threads, [&](std::size_t i) {
      fitted[i].model.held_out = held_out(candidates[i], data, fitted[i], axes, first_half);
    });
  }
  Tuning result;
  result.samples = data.samples;
  for (const std::size_t i : order) result.models.push_back(std::move(fitted[i].model));
  if (options.hold_out) result.chosen = choose(result.models, period_s, static_cast<double>(length));
  return result;
}

}  // namespace ifog
