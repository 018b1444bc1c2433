// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/described_bands.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filters/distributions/chi_squared.h"

namespace ifog {
namespace {

constexpr double kTolerated = 0.1;  // relative difference of the deviation that widened error bars may cover
constexpr double kDepartureQuantile = 0.995;  // of the χ² of the differences, under the terms alone
constexpr std::size_t kFewestBands = 6;

struct Band {
  std::vector<std::size_t> bins;
  FrequencyRange range;
};

std::vector<Band> half_octaves(const NoiseSpectrum& spectrum) {
  std::vector<Band> bands;
  int last = std::numeric_limits<int>::min();
  for (std::size_t i = 0; i < spectrum.bins.size(); ++i) {
    const SpectralBin& bin = spectrum.bins[i];
    if (!bin.used) continue;
    const int number = static_cast<int>(std::floor(2.0 * std::log2(bin.frequency)));
    if (bands.empty() || number != last) bands.push_back({{}, {bin.frequency, bin.frequency}});
    last = number;
    bands.back().bins.push_back(i);
    bands.back().range.high = bin.frequency;
  }
  return bands;
}

// Relative difference between each band's power and the terms', and its variance by chance.
struct Departure {
  double value = 0.0, variance = 0.0;
};

std::vector<Departure> departures(const NoiseSpectrum& spectrum, const std::vector<Band>& bands,
                                  const TermVariances& terms) {
  std::vector<Departure> out;
  for (const Band& band : bands) {
    double sum = 0.0, degrees = 0.0;
    for (const std::size_t i : band.bins) {
      const SpectralBin& bin = spectrum.bins[i];
      double expected = 0.0;
      for (std::size_t t = 0; t < kTerms; ++t) expected += terms[t] * bin.expected[t];
      sum += bin.degrees * (bin.power / expected - 1.0);
      degrees += bin.degrees;
    }
    out.push_back({sum / degrees, 2.0 / degrees});
  }
  return out;
}

// Extra relative error of a band's power with which the χ² is as expected; 0 if it is without.
double misfit_of(const std::vector<Departure>& found) {
  const double degrees = static_cast<double>(found.size()) - static_cast<double>(kTerms);
  if (degrees < 1.0) return 0.0;
  const auto chi = [&](double extra) {
    double sum = 0.0;
    for (const Departure& d : found) sum += d.value * d.value / (d.variance + extra * extra);
    return sum;
  };
  if (chi(0.0) <= chi_squared_quantile(kDepartureQuantile, degrees)) return 0.0;
  double low = 0.0, high = 1e6;
  for (int i = 0; i < 100; ++i) (chi(0.5 * (low + high)) > degrees ? low : high) = 0.5 * (low + high);
  return high;
}

// The few bands above the terms, and the highest ones, with the largest difference. A band that has pulled
// the terms towards itself may be among them.
std::vector<std::size_t> farthest(const std::vector<Departure>& found, double misfit) {
  constexpr std::size_t kTried = 5;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i].value > 0.0 || i + 1 == found.size()) order.push_back(i);
  const auto distance = [&](std::size_t i) {
    return found[i].value * found[i].value / (found[i].variance + misfit * misfit);
  };
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return distance(a) > distance(b); });
  order.resize(std::min(order.size(), kTried));
  return order;
}

// Adds a relative error that a band's bins share.
NoiseSpectrum loosened(NoiseSpectrum spectrum, const std::vector<Band>& bands, double misfit) {
  for (const Band& band : bands) {
    double degrees = 0.0;
    for (const std::size_t i : band.bins) degrees += spectrum.bins[i].degrees;
    for (const std::size_t i : band.bins) spectrum.bins[i].degrees /= 1.0 + 0.5 * misfit * misfit * degrees;
  }
  return spectrum;
}

double settled_misfit(const NoiseSpectrum& spectrum, const std::vector<Band>& bands, TermSet allowed,
                      TermVariances& terms) {
  double misfit = 0.0;
  for (int round = 0; round < 4; ++round) {
    const NoiseSpectrum loose = loosened(spectrum, bands, misfit);
    const NoiseLikelihood likelihood(loose, Ramp::kProjected);
    terms = likelihood.maximise(allowed, terms).variances;
    const double found = misfit_of(departures(spectrum, bands, terms));
    const bool settled = std::abs(found - misfit) <= 0.02 * found;
    misfit = found;
    if (settled) break;
  }
  return misfit;
}

void leave_out(NoiseSpectrum& spectrum, const Band& band) {
  for (const std::size_t i : band.bins) spectrum.bins[i].used = false;
}

}  // namespace

Described described(NoiseSpectrum spectrum, TermSet allowed) {
  Described result;
  std::vector<Band> bands = half_octaves(spectrum);
  double misfit = settled_misfit(spectrum, bands, allowed, result.terms);
  std::size_t described = bands.size();  // bands in use; at least half remain
  const auto fewest = [&] { return std::max(kFewestBands, (described + 1) / 2); };
  // Relative differences of the power are twice those of the deviation.
  while (misfit > 2.0 * kTolerated && bands.size() > fewest()) {
    std::size_t worst = 0;
    double least = std::numeric_limits<double>::infinity();
    TermVariances terms_then{};
    const std::vector<Departure> found = departures(spectrum, bands, result.terms);
    for (const std::size_t b : farthest(found, misfit)) {
      NoiseSpectrum without = spectrum;
      leave_out(without, bands[b]);
      TermVariances terms = result.terms;
      const double left = settled_misfit(without, half_octaves(without), allowed, terms);
      if (left >= least) continue;
      least = left;
      worst = b;
      terms_then = terms;
    }
    if (worst + 1 == bands.size() && found[worst].value < 0.0) --described;
    leave_out(spectrum, bands[worst]);
    result.left_out.push_back(bands[worst].range);
    bands.erase(bands.begin() + static_cast<std::ptrdiff_t>(worst));
    misfit = least;
    result.terms = terms_then;
  }
  std::ranges::sort(result.left_out, {}, &FrequencyRange::low);
  std::vector<FrequencyRange> joined;
  for (const FrequencyRange& range : result.left_out)
    if (!joined.empty() && range.low < 1.1 * joined.back().high)
      joined.back().high = range.high;
    else
      joined.push_back(range);
  result.left_out = joined;
  result.misfit = 0.5 * misfit;
  result.spectrum = loosened(std::move(spectrum), bands, misfit);
  return result;
}

}  // namespace ifog
