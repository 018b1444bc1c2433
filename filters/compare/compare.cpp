// SPDX-License-Identifier: Apache-2.0
#include "filters/compare/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "drivers/row_times/median.h"
#include "filters/compare/figures.h"
#include "filters/rest/rest.h"

namespace ifog {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kStepPlaces = 9;       // odd, so that the median is one of them
constexpr std::size_t kStepRunUp = 2000;     // samples before the step, for the rule to settle
constexpr std::size_t kStepWindow = 4000;    // samples examined after the step
constexpr double kMedianSquare = 0.4549364;  // of a standard normal
constexpr int kLongestLag = 2000;            // samples
constexpr std::size_t kLeastAtRest = 40;     // required by whiteness()

struct Series {
  std::vector<Samples> denoised;
  // NaN in manoeuvres and for rejected measurements.
  std::vector<Samples> innovation, nis;
  std::size_t at_rest = 0;  // samples
};

struct Steps {
  Samples dt_s;       // between samples; the first is the nominal period
  Samples covered_s;  // measured time of the sample, without gaps
};

Steps step_times(const ComparisonInput& in) {
  const std::size_t n = in.time_s.size();
  Steps steps{Samples(n, in.period_s), Samples(n, in.period_s)};
  for (std::size_t k = 1; k < n; ++k) {
    const double dt = in.time_s[k] - in.time_s[k - 1];
    steps.dt_s[k] = dt;
    steps.covered_s[k] = dt / std::max(1.0, std::round(dt / in.period_s));
  }
  return steps;
}

EstimatorInput input_at(const ComparisonInput& in, const Steps& steps, std::size_t k, double added) {
  EstimatorInput sample;
  sample.sequence = k;
  sample.dt_s = steps.dt_s[k];
  sample.covered_s.fill(steps.covered_s[k]);
  for (std::size_t a = 0; a < in.rate.size(); ++a) {
    const double rate = in.rate[a][k];
    if (!std::isfinite(rate)) continue;
    sample.rate_radps[a] = rate + added;
    sample.valid_axes |= 1U << a;
  }
  return sample;
}

Series run(const ComparisonInput& in, const Steps& steps, const FilterSettings& settings) {
  const std::size_t axes = in.rate.size();
  const std::size_t n = in.time_s.size();
  Series out;
  for (auto* series : {&out.denoised, &out.innovation, &out.nis}) series->assign(axes, Samples(n));
  Estimator estimator(settings, static_cast<int>(axes), in.period_s);
  EstimatorOutput step;
  for (std::size_t k = 0; k < n; ++k) {
    const EstimatorInput sample = input_at(in, steps, k, 0.0);
    estimator.step(sample, step);
    const bool at_rest = (step.flags & (kManoeuvre | kGated)) == 0;
    if (at_rest) ++out.at_rest;
    for (std::size_t a = 0; a < axes; ++a) {
      const bool there = at_rest && (sample.valid_axes & (1U << a)) != 0;
      out.denoised[a][k] = step.denoised_radps[a];
      out.innovation[a][k] = there ? step.innovation_radps[a] : kMissing;
      out.nis[a][k] = there && step.innovation_variance[a] > 0.0
                          ? step.innovation_radps[a] * step.innovation_radps[a] / step.innovation_variance[a]
                          : kMissing;
    }
  }
  return out;
}

// Difference of two runs over the same samples with and without the step: noise cancels as far as the rule is
// linear.
std::optional<double> step_samples(const ComparisonInput& in, const Steps& steps,
                                   const FilterSettings& settings, std::size_t place, std::size_t axis,
                                   double size) {
  const std::size_t begin = place > kStepRunUp ? place - kStepRunUp : 0;
  const std::size_t end = std::min(in.time_s.size(), place + kStepWindow);
  Estimator without(settings, static_cast<int>(in.rate.size()), in.period_s);
  Estimator with(settings, static_cast<int>(in.rate.size()), in.period_s);
  EstimatorOutput a, b;
  for (std::size_t k = begin; k < end; ++k) {
    without.step(input_at(in, steps, k, 0.0), a);
    with.step(input_at(in, steps, k, k >= place ? size : 0.0), b);
    if (k >= place && b.denoised_radps[axis] - a.denoised_radps[axis] >= 0.9 * size)
      return static_cast<double>(k - place + 1);
  }
  return std::nullopt;
}

StepResponse step_response(const ComparisonInput& in, const Steps& steps, const FilterSettings& settings,
                           std::size_t axis, double sigmas) {
  StepResponse response;
  response.size_sigma = sigmas;
  const std::size_t n = in.time_s.size();
  if (n < kStepRunUp + kStepWindow) return response;
  std::vector<std::optional<double>> reached;
  for (std::size_t i = 0; i < kStepPlaces; ++i) {
    const std::size_t place = kStepRunUp + (n - kStepRunUp - kStepWindow) * i / (kStepPlaces - 1);
    reached.push_back(
        step_samples(in, steps, settings, place, axis, sigmas * std::sqrt(settings.measurement_noise)));
  }
  response.samples = median_reached(reached);
  return response;
}

double spread_at_rest(std::span<const double> output, const std::vector<Stretch>& at_rest) {
  Samples resting;
  for (const Stretch& part : at_rest) resting.append(part.of(output));
  return spread(resting);
}

void add_series_figures(ComparisonRow& row, const ComparisonInput& in, std::span<const double> output) {
  const auto axis = static_cast<std::size_t>(row.axis);
  const SampleClock clock = sample_clock(in.time_s);
  const std::vector<Stretch> whole = stretches(in.time_s, output, clock);
  const std::vector<Stretch> parts = in.at_rest.empty() ? whole : common(whole, in.at_rest);
  row.std_radps = in.at_rest.empty() ? spread(output) : spread_at_rest(output, in.at_rest);
  if (!in.reference.empty() && !in.reference[axis].empty()) {
    const AgainstReference against = against_reference(output, in.reference[axis], in.period_s, kLongestLag);
    row.rmse_radps = against.rmse;
    row.bias_radps = against.bias;
    row.lag_s = against.lag_s;
  }
  row.adev_radps = reported_deviations(output, parts, clock.period_s);
}

void add_innovation_figures(ComparisonRow& row, std::span<const double> innovation, Samples nis) {
  nis.resize(static_cast<std::size_t>(
      std::ranges::remove_if(nis, [](double v) { return !std::isfinite(v); }).begin() - nis.begin()));
  if (nis.size() < kLeastAtRest) return;
  const Whiteness white = whiteness(innovation);
  row.whiteness_lag1 = white.lag1;
  row.whiteness_excess = white.excess;
  row.nis_mean = std::accumulate(nis.begin(), nis.end(), 0.0) / static_cast<double>(nis.size());
  row.nis_typical = median({nis.begin(), nis.end()}) / kMedianSquare;
}

}  // namespace

Comparison compare_rules(const ComparisonInput& in, const ComparisonOptions& options) {
  const std::size_t n = in.time_s.size();
  if (n < 2) throw std::invalid_argument("fewer than two samples, expected a record");
  for (const auto& rate : in.rate)
    if (rate.size() != n) throw std::invalid_argument("rate columns and time differ in length");
  const Steps steps = step_times(in);

  Comparison result;
  for (std::size_t a = 0; a < in.rate.size(); ++a) {
    ComparisonRow row;
    row.rule = "raw";
    row.axis = static_cast<int>(a);
    add_series_figures(row, in, in.rate[a]);
    result.rows.push_back(std::move(row));
  }
  std::size_t done = 0;
  for (const std::string& rule : options.rules) {
    FilterSettings settings = options.settings;
    settings.rule = rule;
    Series series = run(in, steps, settings);
    for (std::size_t a = 0; a < in.rate.size(); ++a) {
      ComparisonRow row;
      row.rule = rule;
      row.axis = static_cast<int>(a);
      add_series_figures(row, in, series.denoised[a]);
      const HeadingClosure closure = heading_closure(series.denoised[a], in.rate[a], steps.covered_s);
      row.heading_end_rad = closure.end_rad;
      row.heading_max_rad = closure.max_rad;
      row.share_at_rest = static_cast<double>(series.at_rest) / static_cast<double>(n);
      add_innovation_figures(row, series.innovation[a], std::move(series.nis[a]));
      row.step = {step_response(in, steps, settings, a, 20.0), step_response(in, steps, settings, a, 5.0)};
      result.rows.push_back(std::move(row));
    }
    if (options.keep_denoised) result.denoised.push_back(std::move(series.denoised));
    if (options.progress) options.progress(++done, options.rules.size());
  }
  return result;
}

double third_difference_noise(std::span<const double> rate) {
  std::vector<double> squares;
  for (std::size_t i = 3; i < rate.size(); ++i) {
    const double third = rate[i] - 3.0 * rate[i - 1] + 3.0 * rate[i - 2] - rate[i - 3];
    if (std::isfinite(third)) squares.push_back(third * third / 20.0);
  }
  return squares.empty() ? 0.0 : median(std::move(squares)) / kMedianSquare;
}

}  // namespace ifog
