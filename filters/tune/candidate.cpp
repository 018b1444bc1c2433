// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/candidate.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "filters/state_models/state_model.h"
#include "filters/state_models/state_name.h"

namespace ifog {
namespace {

constexpr double kLeastLog = -34.0;  // e^-34: a level that is constant within any record

// Exceeded by nine tenths of the bins.
double low_decile(std::vector<double> values) {
  const auto at = values.begin() + std::ssize(values) / 10;
  std::ranges::nth_element(values, at);
  return *at;
}

// Factor of `shape` that stays below most of the spectrum.
double under(const RecordSpectrum& spectrum, std::span<const double> shape) {
  std::vector<double> ratio(spectrum.density);
  for (std::size_t b = 0; b < ratio.size(); ++b) ratio[b] /= shape[b];
  return low_decile(std::move(ratio));
}

}  // namespace

// Calls use(term, its part of theta).
template <typename T, typename Use>
void ModelCandidate::for_each_term(std::span<T> theta, Use use) const {
  for (std::size_t at = kLevel; const auto& term : terms_) {
    use(*term, theta.subspan(at, static_cast<std::size_t>(term->size())));
    at += static_cast<std::size_t>(term->size());
  }
}

ModelCandidate::ModelCandidate(std::string state, double period_s)
    : state_(std::move(state)), period_s_(period_s) {
  const std::vector<std::string> names = terms_of(state_);
  bool good = names.front() == "random-walk";
  size_ = static_cast<int>(kLevel);
  for (std::size_t i = 1; good && i < names.size(); ++i) {
    auto term = make_noise_term(names[i]);
    good = term != nullptr;
    size_ += good ? term->size() : 0;
    terms_.push_back(std::move(term));
  }
  if (!good)
    throw std::invalid_argument(
        "state: " + in_quotes(state_) +
        ", expected random-walk, to which gauss-markov, ar(p) and arma(p,q) with q < p "
        "<= 6 may be added with ' + '");
  // Throws for too many states.
  std::vector<double> low(static_cast<std::size_t>(size_)), high(low);
  bounds(low, high);
  for (std::size_t i = 0; i < low.size(); ++i) low[i] = 0.5 * (low[i] + high[i]);
  const FilterSettings middle = settings(low, 1.0);
  (void)make_state_model(middle.state, middle.state_parameters, period_s_);
}

void ModelCandidate::bounds(std::span<double> low, std::span<double> high) const {
  low[0] = kLeastLog;
  high[0] = 4.0;
  low[1] = -16.0;
  high[1] = 8.0;
  for_each_term(low, [&](const NoiseTerm& term, std::span<double> part) {
    term.bounds(part, high.subspan(static_cast<std::size_t>(part.data() - low.data())));
  });
}

std::vector<double> ModelCandidate::draw(const RecordSpectrum& spectrum, std::mt19937_64& random) const {
  // Shapes are drawn within their bounds; each part gets a random share of the largest factor.
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto share = [&] { return std::log(between(0.02, 1.0)); };
  std::vector<double> theta(static_cast<std::size_t>(size_)), shape(spectrum.bins());
  std::vector<double> low(theta.size()), high(theta.size());
  bounds(low, high);
  for (std::size_t i = kLevel; i < theta.size(); ++i) theta[i] = between(low[i], high[i]);
  theta[0] = std::log(under(spectrum, spectrum.walk)) + 4.0 * share();
  theta[1] = std::log(low_decile(spectrum.density)) + share();
  for_each_term(std::span(theta), [&](const NoiseTerm& term, std::span<double> part) {
    part[0] = 0.0;
    std::ranges::fill(shape, 0.0);
    term.add_density(part, spectrum, shape);
    part[0] = std::log(under(spectrum, shape)) + share();
  });
  for (std::size_t i = 0; i < theta.size(); ++i) theta[i] = std::clamp(theta[i], low[i], high[i]);
  return theta;
}

void ModelCandidate::density(std::span<const double> theta, const RecordSpectrum& spectrum,
                             std::span<double> out) const {
  const double q = std::exp(theta[0]), r = std::exp(theta[1]);
  for (std::size_t b = 0; b < out.size(); ++b) out[b] = r + q * spectrum.walk[b];
  for_each_term(theta, [&](const NoiseTerm& term, std::span<const double> part) {
    term.add_density(part, spectrum, out);
  });
}

FilterSettings ModelCandidate::settings(std::span<const double> theta, double scale) const {
  FilterSettings s;
  s.state = state_;
  s.process_noise = std::exp(theta[0]) * scale * scale / period_s_;
  s.measurement_noise = std::exp(theta[1]) * scale * scale;
  for_each_term(theta, [&](const NoiseTerm& term, std::span<const double> part) {
    std::vector<double> own = term.parameters(part, period_s_);
    own.back() *= scale * scale / s.process_noise;
    s.state_parameters.insert(s.state_parameters.end(), own.begin(), own.end());
  });
  return s;
}

std::vector<CandidateFigure> ModelCandidate::figures(std::span<const double> theta, double scale) const {
  const FilterSettings s = settings(theta, scale);
  std::vector<CandidateFigure> all{{"process_noise", "rad^2/s^3", s.process_noise},
                                   {"measurement_noise", "rad^2/s^2", s.measurement_noise}};
  for_each_term(theta, [&](const NoiseTerm& term, std::span<const double> part) {
    std::ranges::copy(term.figures(part, scale, period_s_), std::back_inserter(all));
  });
  return all;
}

std::vector<std::string> default_candidates() {
  return {
      "random-walk",         "random-walk + gauss-markov", "random-walk + ar(1)",    "random-walk + ar(2)",
      "random-walk + ar(3)", "random-walk + arma(2,1)",    "random-walk + arma(3,2)"};
}

}  // namespace ifog
