// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/noise_coefficients.h"

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "filters/allan/noise/curve_limits.h"
#include "filters/allan/noise/curve_miss.h"
#include "filters/allan/noise/described_bands.h"
#include "filters/allan/noise/noise_likelihood.h"
#include "filters/linear/normal_equations.h"
#include "filters/units/field_units.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

// Gain of twice the log-likelihood that a term needs. An absent term passes 6 in 0.72 % of records (half of a χ² with
// one d.o.f., Self and Liang, J. Am. Stat. Assoc. 82, 1987).
constexpr double kNested = 6.0;
// Cost of a term in the average over sets of terms, which gives values and error bars.
constexpr double kCostInAverage = 7.0;
// A limit printed only for undetected terms must allow for that selection, so it uses the detection
// threshold.
constexpr double kBound = kNested;
// A ramp competes with a walk estimated from few numbers, so its likelihood ratio is heavy-tailed.
constexpr double kRampPresent = 10.0;
constexpr double kOneSided = 1.959964;
// Below, the likelihood's curvature, with the square in its denominator, overflows.
constexpr double kLeastPower = 1e-120;

// Variance of `term` at which the likelihood, maximised over the others, has fallen by kBound/2. The root of twice the
// loss is nearly linear.
double upper_variance(const NoiseLikelihood& likelihood, const NoiseLikelihood::Maximum& best,
                      TermSet allowed, Term term) {
  const auto index = static_cast<Eigen::Index>(term);
  TermVariances near = best.variances;
  const auto beyond = [&](double more) {
    const auto at = likelihood.maximise_with(term, best.variances[term] + more, allowed, near);
    near = at.variances;
    return std::sqrt(std::max(0.0, 2.0 * (best.log_likelihood - at.log_likelihood))) - std::sqrt(kBound);
  };
  const double guess = std::sqrt(kBound / likelihood.information(best.variances)(index, index));
  std::uintmax_t most = 64;
  return best.variances[term] +
         boost::math::tools::bracket_and_solve_root(
             beyond, guess, 2.0, true, [](double low, double high) { return high - low < 0.01 * high; }, most)
             .second;
}

// Standard deviations of the coefficients (roots of the variances) with all terms of the fit free.
TermVariances errors(const NoiseLikelihood& likelihood, const TermVariances& fit) {
  std::vector<Eigen::Index> open;
  for (std::size_t t = 0; t < kTerms; ++t)
    if (fit[t] > 0.0) open.push_back(static_cast<Eigen::Index>(t));
  const Eigen::Matrix4d information = likelihood.information(fit);
  const auto n = static_cast<Eigen::Index>(open.size());
  const Eigen::MatrixXd covariance =
      NormalEquations(information(open, open), Eigen::VectorXd::Zero(n)).inverse();
  TermVariances error{};
  for (std::size_t i = 0; i < open.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    const auto t = static_cast<std::size_t>(open[i]);
    error[t] = 0.5 * std::sqrt(std::max(0.0, covariance(j, j)) / fit[t]);
  }
  return error;
}

// All sets of the allowed terms, their most likely variances, and the average over sets.
class TermSets {
 public:
  TermSets(const NoiseLikelihood& likelihood, TermSet allowed, const TermVariances& near) {
    for (unsigned long bits = allowed.to_ulong(); bits > 0; --bits) {
      const TermSet set(bits);
      if ((set & ~allowed).any()) continue;
      const auto fit = likelihood.maximise(set, set == allowed ? near : sets_.front().fit.variances);
      const double cost = 2.0 * (sets_.empty() ? 0.0 : sets_.front().fit.log_likelihood - fit.log_likelihood);
      // If a term is zero, the set without it is tried separately.
      bool whole = true;
      for (std::size_t t = 0; t < kTerms; ++t) whole = whole && (!set[t] || fit.variances[t] > 0.0);
      sets_.push_back({set, fit, cost, whole});
    }
    for (Entry& e : sets_)
      if (e.whole && e.cost < 30.0) e.error = errors(likelihood, e.fit.variances);
  }
  [[nodiscard]] const NoiseLikelihood::Maximum& all() const { return sets_.front().fit; }

  // The best set, each of whose terms gains what it needs.
  [[nodiscard]] TermSet best() const {
    return std::ranges::min_element(sets_, {},
                                    [](const Entry& e) {
                                      return e.whole ? e.cost + kNested * static_cast<double>(e.set.count())
                                                     : std::numeric_limits<double>::infinity();
                                    })
        ->set;
  }

  // Weighted mean of the coefficient over the sets with the term, and the scatter within and among the sets.
  struct Average {
    double value = 0.0, error = 0.0;
  };
  [[nodiscard]] Average average(std::size_t term) const {
    double weight = 0.0, first = 0.0, second = 0.0;
    for (const Entry& e : sets_) {
      if (!e.set[term]) continue;
      const double w = weight_of(e), value = std::sqrt(e.fit.variances[term]);
      weight += w;
      first += w * value;
      second += w * (value * value + e.error[term] * e.error[term]);
    }
    if (weight <= 0.0) return {};
    const double mean = first / weight;
    return {mean, std::sqrt(std::max(0.0, second / weight - mean * mean))};
  }

  [[nodiscard]] TermVariances variances() const {
    TermVariances mean{};
    double weight = 0.0;
    for (const Entry& e : sets_) {
      weight += weight_of(e);
      for (std::size_t t = 0; t < kTerms; ++t) mean[t] += weight_of(e) * e.fit.variances[t];
    }
    for (double& v : mean) v /= weight;
    return mean;
  }

 private:
  struct Entry {
    TermSet set;
    NoiseLikelihood::Maximum fit;
    double cost = 0.0;  // loss of twice the log-likelihood compared with all terms
    bool whole = false;
    TermVariances error{};
  };
  static double weight_of(const Entry& e) {
    return e.whole && e.cost < 30.0
               ? std::exp(-0.5 * (e.cost + kCostInAverage * static_cast<double>(e.set.count())))
               : 0.0;
  }
  std::vector<Entry> sets_;  // the set of all terms first
};

void fit_ramp(const NoiseSpectrum& spectrum, TermSet allowed, const TermVariances& variances, double period_s,
              NoiseCoefficients& found) {
  const NoiseLikelihood free(spectrum, Ramp::kFree), none(spectrum, Ramp::kNone);
  const double gain = 2.0 * (free.maximise(allowed, variances).log_likelihood -
                             none.maximise(allowed, variances).log_likelihood);
  const NoiseLikelihood::RampEstimate ramp = free.ramp(variances);
  found.ramp_radps2 = ramp.value / period_s;
  const double error = ramp.std_error / period_s, size = std::abs(found.ramp_radps2);
  NoiseCoefficient& R = found.R;
  R.present = gain > kRampPresent;
  R.upper = size + (R.present ? kOneSided : std::sqrt(kRampPresent)) * error;
  R.value = R.present ? size : 0.0;
  R.std_error = R.present ? error : R.upper / kOneSided;
}

// Up to this share of the correlation time the deviations of the random walk and the Gauss-Markov noise agree within
// 10 %: m / 3 = 1.1² returning_variance(1, m).
constexpr double kWalkUntil = 0.2603;

// Largest relative difference between the terms' and the Gauss-Markov deviation, up to a quarter of the
// record.
double departure(const NoiseCoefficients& found, const MarkovNoise& markov, std::size_t longest,
                 double period_s) {
  double most = 0.0;
  for (double m = 1.0; m <= 0.25 * static_cast<double>(longest); m *= 2.0) {
    TermVariances rest = markov.fit.variances;
    rest[kK] = 0.0;
    const double variance = expected_variance(Deviation::kAllan, rest, static_cast<std::size_t>(m)) +
                            markov.fit.variances[kK] * returning_variance(markov.fit.correlation, m);
    most = std::max(most, std::abs(modelled_deviation(found, m * period_s) / std::sqrt(variance) - 1.0));
  }
  return most;
}

// If no sum of the terms describes some bands, they may belong to a Gauss-Markov bias: then it must describe
// the whole spectrum. Otherwise it is fitted to the bands that the terms describe.
std::optional<GaussMarkovFit> return_of(const NoiseSpectrum& measured, const Described& record, Ramp ramp,
                                        std::size_t longest, const NoiseSpectrum*& of) {
  if (record.misfit > 0.0 || !record.left_out.empty()) {
    const auto whole = fit_gauss_markov(measured, ramp, longest, record.terms);
    if (whole && whole->present) {
      const Described returning = described(with_return(measured, whole->correlation));
      of = &measured;
      if (returning.misfit == 0.0 && returning.left_out.empty()) return whole;
    }
  }
  of = &record.spectrum;
  return fit_gauss_markov(record.spectrum, ramp, longest, record.terms);
}

void find_return(const NoiseSpectrum& measured, const Described& record, std::size_t longest, double period_s,
                 NoiseCoefficients& found) {
  const NoiseSpectrum* of = nullptr;
  const std::optional<GaussMarkovFit> fit =
      return_of(measured, record, found.R.present ? Ramp::kProjected : Ramp::kNone, longest, of);
  if (!fit || !fit->weighed || !(fit->variances[kK] > 0.0)) return;
  MarkovNoise markov;
  markov.fit = *fit;
  markov.chances = gauss_markov_chances(*of, *fit);
  markov.correlation_s = fit->correlation * period_s;
  markov.lower_s = fit->lower * period_s;
  markov.upper_s = fit->upper * period_s;
  markov.sigma_radps = std::sqrt(0.5 * fit->variances[kK] * fit->correlation);
  markov.walk = std::sqrt(fit->variances[kK] / period_s);
  markov.walk_until_s = kWalkUntil * markov.correlation_s;
  markov.present = fit->present;
  if (fit->present) found.misfit = std::max(found.misfit, departure(found, markov, longest, period_s));
  found.markov = std::move(markov);
}

FrequencyRange in_hz(const FrequencyRange& range, double period_s) {
  return {range.low / period_s, range.high / period_s};
}

constexpr std::array<NoiseCoefficient NoiseCoefficients::*, kTerms> kMember{
    &NoiseCoefficients::Q, &NoiseCoefficients::N, &NoiseCoefficients::B, &NoiseCoefficients::K};

// Factor from the root of a variance in samples to the coefficient.
double coefficient_unit(std::size_t term, double period_s) {
  return std::array<double, kTerms>{period_s, std::sqrt(period_s), 1.0, 1.0 / std::sqrt(period_s)}[term];
}

NoiseCoefficient not_seen(double upper) { return {.std_error = upper / kOneSided, .upper = upper}; }

void write_terms(const NoiseLikelihood& likelihood, const TermSets& sets, TermSet allowed, double period_s,
                 NoiseCoefficients& found) {
  const TermSet present = sets.best();
  for (std::size_t t = 0; t < kTerms; ++t) {
    NoiseCoefficient& c = found.*kMember[t];
    c = {};
    if (!allowed[t]) continue;
    const double unit = coefficient_unit(t, period_s);
    if (present[t]) {
      const TermSets::Average average = sets.average(t);
      c.present = true;
      c.value = average.value * unit;
      c.std_error = average.error * unit;
      c.upper = c.value + kOneSided * c.std_error;
    } else {
      c = not_seen(std::sqrt(upper_variance(likelihood, sets.all(), allowed, static_cast<Term>(t))) * unit);
    }
  }
}

// Terms that alone exceed the curve, including their error bars. Sets from_s of the others, and the upper
// limits of undetected ones.
TermSet refuted_by(const CurveLimits& curve, TermSet allowed, double period_s, NoiseCoefficients& found) {
  TermSet refuted;
  for (std::size_t t = 0; t < kTerms; ++t) {
    NoiseCoefficient& c = found.*kMember[t];
    const auto term = static_cast<Term>(t);
    const double unit = coefficient_unit(t, period_s), most = std::sqrt(curve.most(term)) * unit;
    if (!c.present) {
      c = not_seen(allowed[t] ? std::min(c.upper, most) : most);
      continue;
    }
    const double least = std::max(0.0, c.value - kOneSided * c.std_error) / unit;
    const CurveLimits::Verdict verdict = curve.judge(term, least * least);
    refuted[t] = verdict.refuted;
    c.from_s = verdict.from_m > 1 ? static_cast<double>(verdict.from_m) * period_s : 0.0;
    if (verdict.refuted) c = not_seen(most);
  }
  return refuted;
}

// Description of the record by the terms that the curve allows.
struct Fitted {
  Described record;
  TermSet allowed = TermSet().set();
  TermVariances variances{};
};
Fitted fit_terms(const AngleSum& sum, const NoiseSpectrum& measured, double period_s,
                 NoiseCoefficients& found) {
  Fitted fit;
  std::optional<Fitted> first;
  std::optional<CurveLimits> curve;
  for (;;) {
    fit.record = described(measured, fit.allowed);
    const NoiseLikelihood likelihood(fit.record.spectrum, Ramp::kProjected);
    const TermSets sets(likelihood, fit.allowed, fit.record.terms);
    fit.record.terms = sets.all().variances;
    found.variances = sets.variances();
    write_terms(likelihood, sets, fit.allowed, period_s, found);
    // Terms that describe the whole spectrum also describe the curve.
    if (fit.record.misfit <= 0.0 && fit.record.left_out.empty()) return fit;
    if (!curve) curve.emplace(sum);
    curve->assume(found.variances);
    const TermSet refuted = refuted_by(*curve, fit.allowed, period_s, found);
    if (refuted.none()) return fit;
    if (!first) first = Fitted{fit.record, fit.allowed, found.variances};
    if (refuted == fit.allowed) {
      // No term is left; the first description gives the scatter of estimates.
      found.variances = first->variances;
      return *first;
    }
    fit.allowed &= ~refuted;
  }
}

}  // namespace

NoiseCoefficients noise_coefficients(const AngleSum& sum, double period_s) {
  const std::size_t longest = sum.longest();
  if (longest < kShortestStretch)
    throw std::invalid_argument("the longest stretch without gaps has " + std::to_string(longest) +
                                " samples, expected at least " + std::to_string(kShortestStretch) +
                                " for a noise fit");
  const NoiseSpectrum measured = noise_spectrum(sum);
  if (std::ranges::all_of(measured.bins, [](const auto& b) { return !(b.power > 0.0); }))
    throw std::invalid_argument("the rate never changes; there is no noise to fit");
  if (std::ranges::all_of(measured.bins, [](const auto& b) { return b.power < kLeastPower; }))
    throw std::invalid_argument("the rate changes by less than 1e-60 rad/s: no sensor's noise");
  NoiseCoefficients found;
  for (const FrequencyRange& line : measured.lines) found.lines_hz.push_back(in_hz(line, period_s));
  const Fitted fit = fit_terms(sum, measured, period_s, found);
  found.misfit = fit.record.misfit;
  for (const FrequencyRange& range : fit.record.left_out) found.left_out_hz.push_back(in_hz(range, period_s));
  fit_ramp(fit.record.spectrum, fit.allowed, fit.record.terms, period_s, found);
  find_return(measured, fit.record, longest, period_s, found);
  widen_to_curve(sum, period_s, found);
  return found;
}

std::string markov_in_words(const NoiseCoefficients& found) {
  if (!found.markov || !found.markov->present) return "";
  const MarkovNoise& markov = *found.markov;
  return formatted(
      "the bias is correlated (first-order Gauss-Markov noise): %.3g °/h, correlation time %.3g s "
      "(95 %%: %.3g … %.3g s); it is a random walk, of K %.3g °/h/√h, up to %.2g s only: at longer "
      "times the deviation is below the walk's",
      markov.sigma_radps / kDegreePerHour, markov.correlation_s, markov.lower_s, markov.upper_s,
      markov.walk / kDegreePerHourPerRootHour, markov.walk_until_s);
}

std::array<NoiseShare, 5> shares_at(const NoiseCoefficients& c, double tau_s) {
  return {{{&NoiseCoefficients::Q, 3.0 * std::pow(c.Q.value / tau_s, 2)},
           {&NoiseCoefficients::N, c.N.value * c.N.value / tau_s},
           {&NoiseCoefficients::B, 2.0 * std::numbers::ln2 / std::numbers::pi * c.B.value * c.B.value},
           {&NoiseCoefficients::K, c.K.value * c.K.value * tau_s / 3.0},
           {&NoiseCoefficients::R, std::pow(c.R.value * tau_s, 2) / 2.0}}};
}

double modelled_deviation(const NoiseCoefficients& found, double tau_s) {
  double variance = 0.0;
  for (const NoiseShare& share : shares_at(found, tau_s)) variance += share.variance;
  return std::sqrt(variance);
}

}  // namespace ifog
