// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/gauss_markov.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "filters/allan/noise/angle_means.h"

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

// Covariance of the level's rates (triangle-weighted samples) for a covariance T/2 exp(-|t|/T).
struct LevelReturn {
  double decay;            // from one rate to the next
  double far, zero, next;  // covariance is far * decay^lag except at lags 0 and 1

  LevelReturn(double step, double correlation) {
    const double x = step / correlation;
    decay = std::exp(-x);
    const double half = std::sinh(0.5 * x) / (0.5 * x);
    far = 0.5 * correlation * std::pow(half, 4);
    zero = folded(0.0, x, correlation);
    next = folded(1.0, x, correlation);
  }

 private:
  // Integral over the triangle's autocorrelation, a cubic spline, by Simpson's rule between its knots and the
  // cusp of the exponential.
  static double folded(double lag, double x, double correlation) {
    constexpr int kPanels = 32;  // even; the cusp is on a node
    double sum = 0.0;
    for (int knot = -2; knot < 2; ++knot)
      for (int i = 0; i <= kPanels; ++i) {
        const double u = knot + static_cast<double>(i) / kPanels, a = std::abs(u);
        const double spline =
            a < 1.0 ? (4.0 - 6.0 * a * a + 3.0 * a * a * a) / 6.0 : std::pow(2.0 - a, 3) / 6.0;
        const double weight = i == 0 || i == kPanels ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        sum += weight / (3.0 * kPanels) * spline * std::exp(-std::abs(lag + u) * x);
      }
    return 0.5 * correlation * sum;
  }
};

Eigen::MatrixXd covariance_of(const SlowPart& part, double correlation) {
  const Eigen::MatrixXd& w = *part.cosines;
  const Eigen::Index n = w.rows();
  const LevelReturn level(std::exp2(part.level), correlation);
  Eigen::MatrixXd before = w, behind = Eigen::MatrixXd::Zero(n, w.cols());
  for (Eigen::Index i = 1; i < n; ++i) before.row(i) += level.decay * before.row(i - 1);
  for (Eigen::Index i = n - 1; i-- > 0;) behind.row(i) = level.decay * (behind.row(i + 1) + w.row(i + 1));
  const Eigen::MatrixXd adjacent = w.topRows(n - 1).transpose() * w.bottomRows(n - 1);
  return level.far * w.transpose() * (before + behind) + (level.zero - level.far) * w.transpose() * w +
         (level.next - level.far * level.decay) * (adjacent + adjacent.transpose());
}

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
  const double least = peak.best.log_likelihood - 0.5 * kInterval;
  Tried inside = peak;
  double outside = peak.correlation;
  do {
    if (way > 1.0 ? outside >= last : outside <= last) return none;
    outside *= way;
    const Tried one = tried_at(spectrum, ramp, outside, inside.best.variances);
    if (one.best.log_likelihood <= least) break;
    inside = one;
  } while (true);
  while (std::abs(std::log(outside / inside.correlation)) > 0.02) {
    const Tried middle =
        tried_at(spectrum, ramp, std::sqrt(inside.correlation * outside), inside.best.variances);
    if (middle.best.log_likelihood > least)
      inside = middle;
    else
      outside = middle.correlation;
  }
  return std::sqrt(inside.correlation * outside);
}

}  // namespace

NoiseSpectrum with_return(const NoiseSpectrum& spectrum, double correlation) {
  NoiseSpectrum out = spectrum;
  const double corner = 1.0 / correlation;
  for (SpectralBin& bin : out.bins) {
    const double turn = 2.0 * std::numbers::pi * bin.frequency;
    bin.expected[kK] *= turn * turn / (turn * turn + corner * corner);
  }
  for (SlowPart& part : out.slow) part.covariance[kK] = covariance_of(part, correlation);
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
  fit.gain = 2.0 * (top->best.log_likelihood - walks);
  if (fit.gain <= 0.0) return std::nullopt;
  Tried peak = *top;
  for (double step = kSpacing; step > 1.02; step = std::sqrt(step))
    for (const double t : {peak.correlation * std::sqrt(step), peak.correlation / std::sqrt(step)})
      if (const Tried one = tried_at(spectrum, ramp, t, peak.best.variances); likelier(peak, one)) {
        peak = one;
        break;
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
