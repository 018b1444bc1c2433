// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/gauss_markov.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace ifog {
namespace {

// Exceeded in 0.2 % (kPresent) and 2.3 % of records of a true walk: half of a χ² with one degree of freedom.
constexpr double kPresent = 8.0;
constexpr double kWeighed = 4.0;
constexpr double kWeighedUpTo = 0.25;   // of the record; a longer correlation time is a walk there
constexpr double kInterval = 3.841459;  // χ² with one degree of freedom, 95 %
constexpr double kShortest = 32.0;      // samples; shorter ones belong to a filter
constexpr double kSpacing = 1.5;        // ratio of the correlation times tried
constexpr double kLongest = 4.0;        // times the record; beyond, it cannot be distinguished from a walk

// One correlation time and the most likely variances there.
struct Tried {
  double correlation = 0.0;
  NoiseLikelihood::Maximum best;
};

Tried tried_at(const NoiseSpectrum& spectrum, Ramp ramp, double correlation, const TermVariances& near) {
  const NoiseSpectrum returning = with_return(spectrum, correlation);
  return {correlation, NoiseLikelihood(returning, ramp).maximise(TermSet().set(), near)};
}

// Correlation time at which the profile has fallen by kInterval on one side of its peak; `none` if it does
// not before `last`.
double edge(const NoiseSpectrum& spectrum, Ramp ramp, const Tried& peak, double way, double last,
            double none) {
  // Nearly linear in the logarithm of the time.
  const auto lost = [&](const Tried& at) {
    return std::sqrt(2.0 * std::max(0.0, peak.best.log_likelihood - at.best.log_likelihood));
  };
  const double wanted = std::sqrt(kInterval);
  for (Tried inside = peak; way > 1.0 ? inside.correlation < last : inside.correlation > last;) {
    const Tried outside = tried_at(spectrum, ramp, inside.correlation * way, inside.best.variances);
    if (lost(outside) >= wanted)
      return inside.correlation * std::pow(way, (wanted - lost(inside)) / (lost(outside) - lost(inside)));
    inside = outside;
  }
  return none;
}

}  // namespace

NoiseSpectrum with_return(const NoiseSpectrum& spectrum, double correlation) {
  NoiseSpectrum out = spectrum;
  const auto bend = [&](auto& part) {
    const double turns = 2.0 * std::numbers::pi * part.frequency * correlation;
    part.expected[kK] *= turns * turns / (turns * turns + 1.0);
  };
  std::ranges::for_each(out.bins, bend);
  std::ranges::for_each(out.slow, bend);
  return out;
}

std::optional<GaussMarkovFit> fit_gauss_markov(const NoiseSpectrum& spectrum, Ramp ramp, std::size_t samples,
                                               const TermVariances& terms) {
  if (!(terms[kK] > 0.0 || terms[kB] > 0.0)) return std::nullopt;
  // From the random walk to shorter times; each starts at the result before.
  std::vector<Tried> all;
  const double walks = NoiseLikelihood(spectrum, ramp).maximise(TermSet().set(), terms).log_likelihood;
  TermVariances near = terms;
  for (double t = kLongest * static_cast<double>(samples); t >= kShortest; t /= kSpacing) {
    all.push_back(tried_at(spectrum, ramp, t, near));
    near = all.back().best.variances;
  }
  if (all.empty()) return std::nullopt;
  const auto likelier = [](const Tried& a, const Tried& b) {
    return a.best.log_likelihood < b.best.log_likelihood;
  };
  const auto top = std::ranges::max_element(all, likelier);
  GaussMarkovFit fit;
  if (top->best.log_likelihood <= walks) return std::nullopt;
  Tried peak = *top;
  if (top != all.begin() && top + 1 != all.end()) {
    // The top of the parabola through the likeliest and its neighbours.
    const double longer = (top - 1)->best.log_likelihood - top->best.log_likelihood,
                 shorter = (top + 1)->best.log_likelihood - top->best.log_likelihood;
    const double away = 0.5 * (shorter - longer) / (shorter + longer);
    if (const Tried one =
            tried_at(spectrum, ramp, top->correlation * std::pow(kSpacing, away), top->best.variances);
        likelier(peak, one))
      peak = one;
  }
  fit.gain = 2.0 * (peak.best.log_likelihood - walks);
  fit.correlation = peak.correlation;
  fit.variances = peak.best.variances;
  fit.samples = samples;
  fit.ramp = ramp;
  fit.present = fit.gain > kPresent;
  fit.weighed = fit.gain > kWeighed;
  fit.upper = edge(spectrum, ramp, peak, kSpacing, kLongest * static_cast<double>(samples),
                   std::numeric_limits<double>::infinity());
  fit.lower = edge(spectrum, ramp, peak, 1.0 / kSpacing, 1.0, 0.0);
  return fit;
}

std::vector<GaussMarkovChance> gauss_markov_chances(const NoiseSpectrum& spectrum,
                                                    const GaussMarkovFit& fit) {
  constexpr double kFarBelow = 6.0;  // log-likelihood; smaller values are ignored
  constexpr double kTimes = 1.3, kDrives = 1.2;
  constexpr int kMost = 12;  // values on either side
  std::vector<GaussMarkovChance> out;
  double top = -std::numeric_limits<double>::infinity();
  const auto take = [&](double correlation) {
    const NoiseSpectrum returning = with_return(spectrum, correlation);
    const NoiseLikelihood likelihood(returning, fit.ramp);
    const NoiseLikelihood::Maximum best = likelihood.maximise(TermSet().set(), fit.variances);
    top = std::max(top, best.log_likelihood);
    if (best.log_likelihood < top - kFarBelow || !(best.variances[kK] > 0.0)) return false;
    for (int i = -kMost; i <= kMost; ++i) {
      const double drive = best.variances[kK] * std::pow(kDrives, i);
      NoiseLikelihood::Maximum one = likelihood.maximise_with(kK, drive, TermSet().set(), best.variances);
      one.variances[kK] = drive;
      out.push_back({one.log_likelihood, correlation, one.variances});
    }
    return true;
  };
  const double longest = kWeighedUpTo * static_cast<double>(fit.samples);
  for (double t = fit.correlation; t <= longest && take(t); t *= kTimes) {
  }
  for (double t = fit.correlation / kTimes; t >= kShortest && take(t); t /= kTimes) {
  }
  double sum = 0.0;
  for (GaussMarkovChance& one : out) sum += one.weight = std::exp(one.weight - top);
  for (GaussMarkovChance& one : out) one.weight /= sum;
  return out;
}

double returning_variance(double correlation, double m) {
  const double x = m / correlation;
  // The terms cancel up to x³.
  if (x < 1e-3) return m / 3.0 * (1.0 - 0.75 * x);
  return correlation * correlation / m * (1.0 - (3.0 - 4.0 * std::exp(-x) + std::exp(-2.0 * x)) / (2.0 * x));
}

TermVariances equivalent_terms(const GaussMarkovFit& fit, double m) {
  constexpr double kNear = 1.01;
  const double here = returning_variance(fit.correlation, m);
  const double slope = std::log(returning_variance(fit.correlation, m * kNear) / here) / std::log(kNear);
  const double walk = std::clamp(0.5 * (1.0 + slope), 0.0, 1.0);
  TermVariances terms = fit.variances;
  terms[kK] = fit.variances[kK] * walk * here / (m / 3.0);
  terms[kN] += fit.variances[kK] * (1.0 - walk) * here * m;
  return terms;
}

}  // namespace ifog
