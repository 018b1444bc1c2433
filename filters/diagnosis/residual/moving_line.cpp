// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/moving_line.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "filters/series/samples_writer.h"

namespace ifog {
namespace {

using Complex = std::complex<double>;

// What the driven carrier has to gather beyond the fixed one, in units of the noise around the peak. A line
// that stays loses by the same measure, so the sign is as telling as the size.
constexpr double kLeastGain = 30.0;
constexpr std::size_t kMostFollowed = 6;  // the strongest
constexpr double kMostBins = 8.0;         // wider, it is a hump as well
constexpr double kLeastCoherence =
    0.5;  // below, the peak is a hump of noise and its power says nothing of a phase

// Angle turned at each sample, as a multiple of what the mean rate would turn in one sample.
Samples relative_angle(std::span<const double> rate, double mean) {
  // The rate's own noise would smear the carrier, and the phase only follows slow changes: a mean over 64
  // samples.
  SamplesWriter angle(rate.size());
  double smooth = mean;
  double sum = 0.0;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    if (std::isfinite(rate[i])) smooth += (rate[i] - smooth) / 64.0;
    sum += smooth / mean;
    angle.add(sum);
  }
  return std::move(angle).done();
}

// The error against a carrier of `cycles` a step, summed over short pieces: frequencies close by then cost
// the pieces only, for within a piece they differ by a small part of a turn.
// steps(i): how far the carrier has come at sample i.
template <typename Steps>
double best_power(std::span<const double> error, double mean, const Steps& steps, double cycles, double bins,
                  double& at) {
  constexpr std::size_t kPieces = 512;
  const std::size_t n = error.size();
  std::vector<Complex> sums(kPieces);
  std::vector<double> middle(kPieces);
  for (std::size_t p = 0; p < kPieces; ++p) {
    const std::size_t from = p * n / kPieces;
    const std::size_t to = (p + 1) * n / kPieces;
    if (from == to) continue;
    middle[p] = steps((from + to) / 2);
    for (std::size_t i = from; i < to; ++i) {
      if (!std::isfinite(error[i])) continue;
      const double turns = cycles * steps(i);
      sums[p] += (error[i] - mean) * std::polar(1.0, -2.0 * std::numbers::pi * (turns - std::floor(turns)));
    }
  }
  const double bin = 1.0 / static_cast<double>(n);
  double best = 0.0;
  const auto quarters = static_cast<int>(std::floor(8.0 * bins));
  for (int quarter = 0; quarter <= quarters; ++quarter) {
    const double offset = 0.25 * quarter - bins;
    Complex sum(0.0, 0.0);
    for (std::size_t p = 0; p < kPieces; ++p) {
      sum += sums[p] * std::polar(1.0, -2.0 * std::numbers::pi * offset * bin * middle[p]);
    }
    if (std::norm(sum) <= best) continue;
    best = std::norm(sum);
    at = cycles + offset * bin;
  }
  return best;
}

double bins_of(const SpectralLine& peak, std::size_t samples, double period_s) {
  return peak.width_hz * period_s * static_cast<double>(samples);
}

bool to_follow(const SpectralLine& peak, std::size_t samples, double period_s) {
  return !(peak.coherence < kLeastCoherence || bins_of(peak, samples, period_s) > kMostBins);
}

}  // namespace

bool any_to_follow(std::size_t samples, double period_s, const std::vector<SpectralLine>& peaks) {
  const auto end = peaks.begin() + static_cast<std::ptrdiff_t>(std::min(peaks.size(), kMostFollowed));
  return std::any_of(peaks.begin(), end,
                     [&](const SpectralLine& peak) { return to_follow(peak, samples, period_s); });
}

std::optional<MovingLine> find_moving_line(std::span<const double> error, std::span<const double> rate,
                                           double period_s, const std::vector<SpectralLine>& peaks) {
  if (!any_to_follow(error.size(), period_s, peaks)) return std::nullopt;
  double mean_rate = 0.0;
  double mean_error = 0.0;
  double n = 0.0;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    if (!std::isfinite(rate[i]) || !std::isfinite(error[i])) continue;
    mean_rate += rate[i];
    mean_error += error[i];
    n += 1.0;
  }
  if (n < 256.0 || mean_rate == 0.0) return std::nullopt;
  mean_rate /= n;
  mean_error /= n;
  Samples driven;  // where it is asked for
  std::optional<MovingLine> found;
  for (std::size_t k = 0; k < std::min(peaks.size(), kMostFollowed); ++k) {
    if (!to_follow(peaks[k], error.size(), period_s)) continue;
    const double width = bins_of(peaks[k], error.size(), period_s);
    const double cycles = peaks[k].frequency_hz * period_s;
    const double bins = std::max(3.0, 2.0 * width);
    double at_fixed = cycles;
    double at_driven = cycles;
    if (driven.empty()) driven = relative_angle(rate, mean_rate);
    const double still = best_power(
        error, mean_error, [](std::size_t i) { return static_cast<double>(i + 1); }, cycles, bins, at_fixed);
    const double moving = best_power(
        error, mean_error, [&](std::size_t i) { return driven[i]; }, cycles, bins, at_driven);
    const double gain = peaks[k].ratio * (moving / std::max(still, 1e-300) - 1.0);
    if (gain < kLeastGain || (found && gain <= found->gain)) continue;
    found = MovingLine{at_driven / period_s, 0.0, gain};
  }
  if (!found) return found;
  // A higher harmonic moves further and shows first; what it is a harmonic of is the line.
  const double bin = 1.0 / (static_cast<double>(error.size()) * period_s);
  const auto multiple_of = [&](double frequency, double base) {
    const double times = frequency / base;
    return times > 0.5 && std::abs(times - std::round(times)) * base < std::max(0.002 * frequency, 2.0 * bin);
  };
  double fundamental = found->frequency_hz;
  for (const SpectralLine& peak : peaks) {
    if (multiple_of(found->frequency_hz, peak.frequency_hz))
      fundamental = std::min(fundamental, peak.frequency_hz);
  }
  // The ramp is no sine: without harmonics it is something else, such as a structure that swings with what it
  // measures.
  const auto family = std::count_if(peaks.begin(), peaks.end(), [&](const SpectralLine& peak) {
    return multiple_of(peak.frequency_hz, fundamental);
  });
  if (family < 3) return std::nullopt;
  found->frequency_hz = fundamental;
  found->cycles_per_rad = fundamental / std::abs(mean_rate);
  return found;
}

}  // namespace ifog
