// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/prediction.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <optional>

#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/residual/residual.h"

namespace ifog {
namespace {

constexpr double kCaptureSteps = 4000.0;  // steps per capture for the noise

// Variance of a weighted sum of a first-order process with the given factor and drive. A random walk (factor
// 1) has an arbitrary start, so its weights sum to zero.
double brought_by(const std::vector<double>& weight, double factor, double drive) {
  double variance = 0.0;
  double ahead = 0.0;
  for (std::size_t k = weight.size(); k-- > 0;) {
    ahead = weight[k] + factor * ahead;
    const double start = k == 0 ? (factor < 1.0 ? drive / (1.0 - factor * factor) : 0.0) : drive;
    variance += start * ahead * ahead;
  }
  return variance;
}

struct HeadingWeights {
  std::vector<double> of_step;  // s; the heading error is the sum of weight times rate error
  double step_s;
};

// They sum to zero: alignment removes a constant.
HeadingWeights heading_weights(double aligned_s, double after_s, double step_s, std::size_t most) {
  const auto aligned = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(aligned_s / step_s)));
  auto moving = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(after_s / step_s)));
  moving = std::min(moving, most > aligned ? most - aligned : 1);
  HeadingWeights weights{std::vector<double>(aligned + moving, step_s), step_s};
  for (std::size_t k = 0; k < aligned; ++k)
    weights.of_step[k] = -step_s * static_cast<double>(moving) / static_cast<double>(aligned);
  return weights;
}

double along(const HeadingWeights& weights, const Eigen::VectorXd& column) {
  double sum = 0.0;
  const auto n = std::min(weights.of_step.size(), static_cast<std::size_t>(column.size()));
  for (std::size_t k = 0; k < n; ++k) sum += weights.of_step[k] * column[static_cast<Eigen::Index>(k)];
  return sum;
}

// Regressor if a parameter of the effect, not the coefficient, is `factor` times as large.
Eigen::VectorXd regressor_with(const BlockData& next, Effect effect, std::size_t parameter, double factor) {
  effect.parameters[parameter].value *= factor;
  return regressor(next, *candidate_of(next, effect));
}

// Effects on one capture whose channels stay within the fitted ranges.
struct Effects {
  Columns gradient;             // by parameter, in the order of the model's covariance; zero if not corrected
  Eigen::VectorXd uncorrected;  // rad/s
  std::vector<Effect> lines;    // not corrected, phase unknown
};

Effects effects_on(const BlockData& next, const std::vector<FoundEffect>& effects) {
  constexpr double kStep = 0.05;  // of a parameter, for the derivative
  const auto n = static_cast<Eigen::Index>(next.grid.size());
  Eigen::Index parameters = 0;
  for (const FoundEffect& found : effects)
    parameters += static_cast<Eigen::Index>(found.effect.parameters.size());
  Effects on{Columns::Zero(n, parameters), Eigen::VectorXd::Zero(n), {}};
  Eigen::Index row = 0;
  for (const FoundEffect& found : effects) {
    const Effect& effect = found.effect;
    const Eigen::Index at = row;
    row += static_cast<Eigen::Index>(effect.parameters.size());
    if (effect.shown_only) continue;  // rotation, which the heading follows
    if (effect.form == "line") {
      on.lines.push_back(effect);
      continue;
    }
    const std::optional<Candidate> candidate = candidate_of(next, effect);
    if (!candidate || candidate->form == Form::kStep) continue;
    const double coefficient = effect.parameters.front().value;
    on.gradient.col(at) = regressor(next, *candidate);
    for (std::size_t j = 1; j < effect.parameters.size(); ++j) {
      if (!(effect.parameters[j].std_error > 0.0)) continue;
      const double scale = coefficient / (2.0 * kStep * effect.parameters[j].value);
      on.gradient.col(at + static_cast<Eigen::Index>(j)) =
          scale *
          (regressor_with(next, effect, j, 1.0 + kStep) - regressor_with(next, effect, j, 1.0 - kStep));
    }
  }
  return on;
}

// Mean square over all phases of a line of this frequency and amplitude.
double line_square(const HeadingWeights& weights, const Effect& line) {
  const double turn = 2.0 * std::numbers::pi * parameter(line, "frequency_hz") * weights.step_s;
  const double half = 0.5 * turn;
  const double kept = half < 1e-9 ? 1.0 : std::sin(half) / half;
  std::complex<double> sum = 0.0;
  for (std::size_t k = 0; k < weights.of_step.size(); ++k)
    sum += weights.of_step[k] * std::polar(1.0, turn * static_cast<double>(k));
  const double square = std::pow(parameter(line, "cosine"), 2) + std::pow(parameter(line, "sine"), 2);
  return 0.5 * square * kept * kept * std::norm(sum);
}

}  // namespace

double heading_variance(const NoisePosterior& posterior, double aligned_s, double after_s) {
  const double steps =
      std::ceil(aligned_s / std::min((aligned_s + after_s) / kCaptureSteps, 0.1 * aligned_s));
  const double step = aligned_s / steps;
  const std::vector<double> weight = heading_weights(aligned_s, after_s, step, SIZE_MAX).of_step;
  double square = 0.0;
  for (const double w : weight) square += w * w;
  double walk = 0.0;
  double flicker = 0.0;
  double variance = 0.0;
  for (const NoisePosterior::Part& part : posterior.parts) {
    variance += part.weight * part.white / step * square;
    walk += part.weight * part.walk;
    flicker += part.weight * part.flicker;
    if (part.markov > 0.0) {
      const double f = std::exp(-step / part.markov_s);
      variance += part.weight * brought_by(weight, f, part.markov * (1.0 - f * f));
    }
  }
  if (walk > 0.0) variance += brought_by(weight, 1.0, walk * step);
  if (flicker > 0.0) {
    for (const double tau : posterior.flicker_s) {
      const double f = std::exp(-step / tau);
      variance += brought_by(weight, f, flicker * (1.0 - f * f));
    }
  }
  return variance;
}

double mean_variance(const NoisePosterior& posterior, const std::vector<double>& spans_s) {
  const double all_s = std::accumulate(spans_s.begin(), spans_s.end(), 0.0);
  double variance = 0.0;
  for (const double span_s : spans_s) {
    // Of a first-order process of unit variance.
    const auto of = [&](double tau) {
      return tau > 0.0 ? 2.0 * tau / span_s * (1.0 + tau / span_s * std::expm1(-span_s / tau)) : 0.0;
    };
    double flicker = 0.0;
    for (const double tau : posterior.flicker_s) flicker += of(tau);
    for (const NoisePosterior::Part& part : posterior.parts)
      variance += part.weight * std::pow(span_s / all_s, 2) *
                  (part.white / span_s + part.walk * span_s / 3.0 + part.flicker * flicker +
                   part.markov * of(part.markov_s));
  }
  return variance;
}

namespace {

// The same noise without what wanders.
NoisePosterior only_white(NoisePosterior posterior) {
  posterior.flicker_s.clear();
  for (NoisePosterior::Part& part : posterior.parts) part.walk = part.flicker = part.markov = 0.0;
  return posterior;
}

}  // namespace

HeadingPrediction predict_heading(const Diagnosis& diagnosis, const Record& next, double aligned_s,
                                  const std::vector<double>& after_s) {
  const BlockData data = cut_to_blocks({next});
  HeadingPrediction prediction;
  prediction.aligned_s = aligned_s;
  prediction.after_s = after_s;
  Effects on = effects_on(data, diagnosis.effects);
  if (const auto& loop = diagnosis.hysteresis)
    if (const std::optional<std::size_t> channel = data.index_of(loop->channel))
      on.uncorrected += loop->coefficient * hysteresis_loop(data, *channel, loop->half_width);
  const auto n = static_cast<Eigen::Index>(on.gradient.cols());
  const bool with_covariance = n > 0 && diagnosis.covariance.size() == static_cast<std::size_t>(n * n);
  for (const double horizon : after_s) {
    const HeadingWeights weights = heading_weights(aligned_s, horizon, data.grid.block_s, data.grid.size());
    const double noise = heading_variance(diagnosis.noise_posterior, aligned_s, horizon);
    double square = noise;
    if (with_covariance) {
      Eigen::VectorXd g(n);
      for (Eigen::Index j = 0; j < n; ++j) g[j] = along(weights, on.gradient.col(j));
      const Eigen::Map<const Columns> covariance(diagnosis.covariance.data(), n, n);
      square += std::max(0.0, g.dot(covariance * g));
    }
    square += std::pow(along(weights, on.uncorrected), 2);
    for (const Effect& line : on.lines) square += line_square(weights, line);
    prediction.sigma_rad.push_back(std::sqrt(square));
    const bool wanders = diagnosis.noise.B || diagnosis.noise.K;
    const double white = heading_variance(only_white(diagnosis.noise_posterior), aligned_s, horizon);
    prediction.at_most = !wanders && noise > 0.5 * square && white < 0.5 * noise;
  }
  return prediction;
}

HeadingPrediction predict_like_longest(const Diagnosis& diagnosis, const std::vector<Record>& records) {
  const auto span_of = [](const Record& record) { return record.time_s.back() - record.time_s.front(); };
  const Record& longest = *std::ranges::max_element(records, {}, span_of);
  const double aligned = std::min(300.0, span_of(longest) / 10.0);
  std::vector<double> after_s = {60.0, 300.0, 600.0, 1800.0, 3600.0};
  // Beyond 100 times the record's length the noise is unknown and the computation too long.
  constexpr double kFarthest = 100.0;
  std::erase_if(after_s, [&](double after) { return after > kFarthest * span_of(longest); });
  return predict_heading(diagnosis, longest, aligned, after_s);
}

}  // namespace ifog
