// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/curve_miss.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "filters/allan/confidence.h"
#include "filters/allan/deviation.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr double kFewestDegrees = 8.0;  // then the deviation is known to 25 %
constexpr double kOneSigma = 0.682689;  // of a Gaussian variable within one standard deviation
// Standard deviations, each exceeded by chance in one of 200 records of 15 octaves; neighbouring octaves
// correlate by 0.5 (3000 records of white noise; tests/unit/allan/noise_coefficients_test.cpp).
constexpr double kAtOne = 3.5, kAtTwo = 2.75;

}  // namespace

void widen_to_curve(const AngleSum& sum, double period_s, NoiseCoefficients& found) {
  if ((found.markov && found.markov->present) || !found.left_out_hz.empty() || !found.lines_hz.empty())
    return;
  std::vector<std::size_t> octaves;
  for (std::size_t m = sum.held() == 1 ? 1 : 8 * sum.held();
       m <= longest_average(Deviation::kAllan, sum.longest()); m *= 2)
    octaves.push_back(m);
  const std::vector<DeviationPoint> points = deviation(sum, octaves);
  const std::vector<AllanInterval> intervals =
      allan_intervals(sum, Deviation::kAllan, points, found.variances, kOneSigma);
  double before = 0.0;  // difference at the octave before, in standard deviations
  for (std::size_t i = 0; i < points.size() && intervals[i].degrees >= kFewestDegrees; ++i) {
    const double tau_s = static_cast<double>(octaves[i]) * period_s, measured = std::sqrt(points[i].variance),
                 modelled = modelled_deviation(found, tau_s);
    if (!(measured > 0.0 && modelled > 0.0)) continue;
    const double sigma = 0.5 * std::log(intervals[i].upper_radps / intervals[i].lower_radps);
    const double off = std::log(modelled / measured), here = off / sigma;
    const bool counts = std::abs(here) > kAtOne ||
                        (std::abs(here) > kAtTwo && std::abs(before) > kAtTwo && here * before > 0.0);
    before = here;
    if (!counts) continue;
    const auto shares = shares_at(found, tau_s);
    const auto most = std::ranges::max_element(shares, {}, &NoiseShare::variance);
    NoiseCoefficient& term = found.*most->term;
    const double share = most->variance / (modelled * modelled);
    const double error = term.value * std::abs(std::expm1(-off)) / share;
    if (error > term.std_error) {
      term.upper += 1.959964 * (error - term.std_error);  // 97.5 % limit
      term.std_error = error;
    }
    if (std::abs(off) > found.curve.departure) found.curve = {std::abs(off), tau_s};
  }
}

std::string curve_miss_in_words(const NoiseCoefficients& found) {
  if (found.curve.departure == 0.0) return "";
  return formatted("fit is %.2g %% off at %.6g s; error bars widened", 100.0 * found.curve.departure,
                   found.curve.tau_s);
}

std::vector<std::string> misfit_in_words(const NoiseCoefficients& found) {
  const auto in_words = [](const std::vector<FrequencyRange>& ranges) {
    constexpr std::size_t kShown = 6;
    std::string words;
    for (std::size_t i = 0; i < std::min(kShown, ranges.size()); ++i)
      words += formatted("%s%.6g–%.6g", i > 0 ? ", " : "", ranges[i].low, ranges[i].high);
    if (ranges.size() > kShown) words += " and " + std::to_string(ranges.size() - kShown) + " more";
    return words + " Hz";
  };
  std::vector<std::string> lines;
  if (!found.lines_hz.empty())
    lines.push_back("lines, not used in the noise fit: " + in_words(found.lines_hz));
  if (!found.left_out_hz.empty())
    lines.push_back(
        "not used in the fit: Q, N, B, K, R cannot explain these bands (resonance, vibration, a filter): " +
        in_words(found.left_out_hz));
  const std::string markov = markov_in_words(found);
  if (!markov.empty())
    lines.push_back(markov);
  else if (found.misfit > 0.0)
    lines.push_back(formatted("fit is %.2g %% off; error bars widened", 100.0 * found.misfit));
  if (const std::string miss = curve_miss_in_words(found); !miss.empty()) lines.push_back(miss);
  return lines;
}

}  // namespace ifog
