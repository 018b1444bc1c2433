// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/cross_delay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <vector>

#include "filters/diagnosis/record/even_grid.h"
#include "filters/linear/fourier.h"

namespace ifog {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t kFewestSamples = 200;
constexpr std::size_t kSegments = 16;         // of the series, end to end: as many averages of each frequency
constexpr std::size_t kShortestSegment = 32;  // samples
constexpr std::size_t kHops = 4;              // segments begin at each quarter of one
// Independent averages for each segment's length, at such an overlap and taper (Welch 1967).
constexpr double kAverages = 1.9;
constexpr double kCoherentByChance = 1e-3;  // that noise is as coherent at any frequency, with any shift
constexpr double kUsedBand = 0.8;  // of half the sample rate; above it the interpolation loses the motion
constexpr double kAsGood = 0.9;  // share of the information, of a delay among those of a motion that repeats
constexpr double kHalf = 0.5;    // share of the greatest, of what is looked at
constexpr std::size_t kCandidates = 16;
constexpr int kRounds = 30;
constexpr double kSettled = 0.02;  // standard errors

// Weights of the samples -1, 0, 1, 2 for a value at `fraction` (Lagrange).
std::array<double, 4> cubic(double fraction) {
  const double f = fraction;
  return {-f * (f - 1) * (f - 2) / 6, (f + 1) * (f - 1) * (f - 2) / 2, -(f + 1) * f * (f - 2) / 2,
          (f + 1) * f * (f - 1) / 6};
}

using SegmentSpectrum = std::vector<Complex>;

// Spectra of overlapping segments under a Hann taper, without their straight line; empty where a gap is too long.
std::vector<SegmentSpectrum> segment_spectra(std::span<const double> series, std::size_t length) {
  std::vector<double> values(series.begin(), series.end());
  bridge(values, length / 16);
  const double middle = 0.5 * (static_cast<double>(length) - 1.0);
  const double squares = static_cast<double>(length) * (static_cast<double>(length * length) - 1.0) / 12.0;
  std::vector<SegmentSpectrum> spectra;
  std::vector<double> segment(length);
  Fourier fourier;
  for (std::size_t first = 0; first + length <= values.size(); first += length / kHops) {
    double mean = 0.0, slope = 0.0;
    for (std::size_t i = 0; i < length; ++i) {
      mean += values[first + i] / static_cast<double>(length);
      slope += values[first + i] * (static_cast<double>(i) - middle) / squares;
    }
    SegmentSpectrum& spectrum = spectra.emplace_back();
    if (!std::isfinite(mean)) continue;
    for (std::size_t i = 0; i < length; ++i) {
      const double from_middle = static_cast<double>(i) - middle;
      const double taper = std::cos(std::numbers::pi * from_middle / static_cast<double>(length));
      segment[i] = (values[first + i] - mean - slope * from_middle) * taper * taper;
    }
    fourier.forward(spectrum, segment);
    spectrum.resize(length / 2);
  }
  return spectra;
}

// Cross spectrum of two series, where they are certainly coherent.
struct Coherent {
  struct Frequency {
    std::size_t index = 0;  // in cycles per segment
    Complex cross;
    double weight = 0.0;  // γ²/(1 − γ²)
  };
  std::vector<Frequency> frequencies;
  double segments = 0.0;  // end to end

  // Twice the log-likelihood beyond that of two series that have nothing in common.
  [[nodiscard]] double information() const {
    double sum = 0.0;
    for (const Frequency& each : frequencies) sum += std::log1p(each.weight);
    return 2.0 * segments * sum;
  }

  // Of two series without a delay.
  [[nodiscard]] bool reversed() const {
    double sum = 0.0;
    for (const Frequency& each : frequencies) sum += each.weight * each.cross.real() / std::abs(each.cross);
    return sum < 0.0;
  }
};

// Pairs each segment of the one with that `hops` later of the other.
Coherent coherent(const std::vector<SegmentSpectrum>& one, const std::vector<SegmentSpectrum>& other,
                  std::ptrdiff_t hops, double by_chance) {
  std::vector<std::array<const SegmentSpectrum*, 2>> pairs;
  for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, -hops);
       k < std::min(std::ssize(one), std::ssize(other) - hops); ++k) {
    const SegmentSpectrum &a = one[static_cast<std::size_t>(k)],
                          &b = other[static_cast<std::size_t>(k + hops)];
    if (!a.empty() && !b.empty()) pairs.push_back({&a, &b});
  }
  Coherent found;
  if (pairs.empty()) return found;
  const auto count = static_cast<double>(pairs.size());
  found.segments = count / static_cast<double>(kHops);
  const auto highest = static_cast<std::size_t>(kUsedBand * static_cast<double>(pairs[0][0]->size()));
  for (std::size_t f = 1; f < highest; ++f) {
    Complex cross;
    double first = 0.0, second = 0.0, size = 0.0, squares = 0.0;
    for (const auto& [a, b] : pairs) {
      const double p = std::norm((*a)[f]), q = std::norm((*b)[f]);
      cross += std::conj((*a)[f]) * (*b)[f];
      first += p, second += q;
      size += std::sqrt(p * q), squares += p * q;
    }
    if (!(first * second > 0.0)) continue;
    // One event, such as two coincident outliers, is coherent by itself: segments count as many as share the power.
    // Of Gaussian noise that share is half of them.
    const double averages = kAverages * found.segments * std::min(1.0, 2.0 * size * size / (squares * count));
    const double coherence = std::min(std::norm(cross) / (first * second), 1.0 - 1e-9);
    if (!(averages > 1.0) || coherence <= 1.0 - std::pow(by_chance, 1.0 / (averages - 1.0))) continue;
    const double unbiased = (averages * coherence - 1.0) / (averages - 1.0);
    found.frequencies.push_back({f, cross, unbiased / (1.0 - unbiased)});
  }
  return found;
}

double information(const std::vector<Coherent>& axes) {
  double sum = 0.0;
  for (const Coherent& each : axes) sum += each.information();
  return sum;
}

class DelaySearch {
 public:
  DelaySearch(std::span<const SameMotion> axes, std::size_t longest)
      : axes_(axes),
        length_(
            std::max(kShortestSegment, kHops * smooth_length(axes[0].series.size() / (kHops * kSegments)))),
        hop_(static_cast<std::ptrdiff_t>(length_ / kHops)),
        most_(static_cast<std::ptrdiff_t>(longest) / hop_ + 1) {
    const double frequencies = 0.5 * kUsedBand * static_cast<double>(length_ * axes.size());
    by_chance_ = kCoherentByChance / (frequencies * static_cast<double>(2 * most_ + 1));
    for (const SameMotion& axis : axes) spectra_.push_back(segment_spectra(axis.series, length_));
  }

  // To a quarter of a sample: the nearest to none of those at which the series are about as coherent as they can be.
  [[nodiscard]] std::optional<double> coarse() const {
    const std::vector<double> delays = candidates();
    std::vector<double> informations;
    for (const double steps : delays) informations.push_back(information(shifted_by(steps)));
    for (std::size_t i = 0; i < delays.size(); ++i)
      if (informations[i] >= kAsGood * *std::ranges::max_element(informations)) return delays[i];
    return std::nullopt;
  }

  // One step from `steps` towards the delay, with its error; no error without a coherent frequency.
  [[nodiscard]] CrossDelay step(double steps) const {
    const double fraction = steps - std::floor(steps);
    const std::array<double, 4> weights = cubic(fraction);
    double slope = 0.0, squares = 0.0, scatter = 0.0, count = 0.0, segments = 0.0;
    for (const Coherent& spectrum : shifted_by(steps)) {
      const double sign = spectrum.reversed() ? -1.0 : 1.0;
      segments = std::max(segments, spectrum.segments);
      for (const auto& [f, cross, weight] : spectrum.frequencies) {
        const double omega = 2.0 * std::numbers::pi * static_cast<double>(f) / static_cast<double>(length_);
        Complex interpolation;  // its response, less that of the shift
        for (std::size_t k = 0; k < weights.size(); ++k)
          interpolation += std::polar(1.0, omega * (static_cast<double>(k) - 1.0 - fraction)) * weights[k];
        const double phase = std::arg(sign * cross * std::conj(interpolation));
        slope -= weight * omega * phase;
        squares += weight * omega * omega;
        scatter += weight * phase * phase;
        count += 1.0;
      }
    }
    if (count == 0.0) return {};
    const double over_noise =
        kAverages * 2.0 * segments * (scatter - slope * slope / squares) / std::max(1.0, count - 1.0);
    return {slope / squares, std::sqrt(std::max(1.0, over_noise) / (2.0 * segments * squares))};
  }

 private:
  // By axis, with `late` shifted.
  [[nodiscard]] std::vector<Coherent> shifted_by(double steps) const {
    std::vector<Coherent> found;
    for (std::size_t a = 0; a < axes_.size(); ++a)
      found.push_back(
          coherent(spectra_[a], segment_spectra(shifted(axes_[a].late, steps), length_), 0, by_chance_));
    return found;
  }

  // Peaks of the weighted cross-correlation where the series are coherent: the nearest to none, then the greatest
  // where they are most coherent.
  [[nodiscard]] std::vector<double> candidates() const {
    std::vector<std::vector<Coherent>> by_hops(static_cast<std::size_t>(2 * most_ + 1));
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      const std::vector<SegmentSpectrum> late = segment_spectra(axes_[a].late, length_);
      for (std::ptrdiff_t hops = -most_; hops <= most_; ++hops)
        by_hops[static_cast<std::size_t>(hops + most_)].push_back(
            coherent(spectra_[a], late, hops, by_chance_));
    }
    std::vector<double> informations;
    for (const std::vector<Coherent>& axes : by_hops) informations.push_back(information(axes));
    const double top = *std::ranges::max_element(informations);
    std::vector<double> delays, greatest;
    for (std::size_t i = 0; i < by_hops.size() && top > 0.0; ++i) {
      if (informations[i] < kHalf * top) continue;
      const double from = static_cast<double>((static_cast<std::ptrdiff_t>(i) - most_) * hop_);
      const std::vector<double> peaks = peaks_within_a_hop(by_hops[i]);
      for (const double each : peaks) delays.push_back(from + each);
      if (informations[i] == top) greatest.assign(std::prev(delays.end(), std::ssize(peaks)), delays.end());
    }
    std::ranges::sort(delays, {}, [](double delay) { return std::abs(delay); });
    greatest.resize(std::min(greatest.size(), kCandidates));
    delays.resize(std::min(delays.size(), kCandidates));
    delays.insert(delays.end(), greatest.begin(), greatest.end());
    return delays;
  }

  // In samples, the greatest first. Negative peaks, of reversed axes, count as well.
  [[nodiscard]] std::vector<double> peaks_within_a_hop(const std::vector<Coherent>& axes) const {
    constexpr std::ptrdiff_t kPerSample = 4;
    const std::size_t size = static_cast<std::size_t>(kPerSample) * length_;
    std::vector<double> likeness(size, 0.0);
    for (const Coherent& axis : axes) {
      std::vector<Complex> phases(size);
      for (const auto& [f, cross, weight] : axis.frequencies) {
        phases[f] = weight * cross / std::abs(cross);
        phases[size - f] = std::conj(phases[f]);
      }
      std::vector<double> of_axis;
      Fourier().inverse(of_axis, phases);
      for (std::size_t i = 0; i < size; ++i) likeness[i] += std::abs(of_axis[i]);
    }
    const std::ptrdiff_t most = kPerSample * hop_ / 2 + 1;
    const auto at = [&](std::ptrdiff_t i) {
      return likeness[static_cast<std::size_t>(i < 0 ? i + std::ssize(likeness) : i)];
    };
    std::vector<std::ptrdiff_t> peaks;
    for (std::ptrdiff_t i = -most; i <= most; ++i)
      if (at(i) > 0.0 && at(i) >= std::max(at(i - 1), at(i + 1))) peaks.push_back(i);
    std::ranges::sort(peaks, std::ranges::greater{}, at);
    std::vector<double> delays;
    for (const std::ptrdiff_t i : peaks)
      if (at(i) >= kHalf * at(peaks.front()))
        delays.push_back(static_cast<double>(i) / static_cast<double>(kPerSample));
    return delays;
  }

  std::span<const SameMotion> axes_;
  std::size_t length_;                                 // of a segment
  std::ptrdiff_t hop_;                                 // samples
  std::ptrdiff_t most_;                                // hops
  double by_chance_ = 0.0;                             // for one frequency
  std::vector<std::vector<SegmentSpectrum>> spectra_;  // of each axis' series
};

}  // namespace

Samples shifted(std::span<const double> values, double steps, double growth) {
  const auto at = [&](std::ptrdiff_t i) {
    return i >= 0 && i < std::ssize(values) ? values[static_cast<std::size_t>(i)]
                                            : std::numeric_limits<double>::quiet_NaN();
  };
  Samples out(values.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double by = steps + growth * static_cast<double>(i), whole = std::floor(by), fraction = by - whole;
    const std::array<double, 4> weights = cubic(fraction);
    const std::ptrdiff_t here = static_cast<std::ptrdiff_t>(i) + static_cast<std::ptrdiff_t>(whole);
    const double before = at(here), after = fraction > 0.0 ? at(here + 1) : before;
    out[i] = weights[0] * at(here - 1) + weights[1] * before + weights[2] * after + weights[3] * at(here + 2);
    if (std::isnan(out[i])) out[i] = before + fraction * (after - before);
  }
  return out;
}

std::optional<CrossDelay> cross_delay(std::span<const SameMotion> axes, std::size_t longest) {
  if (axes.empty() || axes[0].series.size() < kFewestSamples) return std::nullopt;
  const DelaySearch search(axes, longest);
  const std::optional<double> coarse = search.coarse();
  if (!coarse) return std::nullopt;
  CrossDelay delay{*coarse, 0.0};
  // What leaks from strong slow motion into other frequencies has no delay beyond the shift, so that a step is
  // too short until the shift is right.
  for (int round = 0; round < kRounds; ++round) {
    if (!(std::abs(delay.steps) <= static_cast<double>(longest))) return std::nullopt;
    const CrossDelay step = search.step(delay.steps);
    if (step.error == 0.0) return std::nullopt;
    delay.steps += step.steps;
    delay.error = step.error;
    if (std::abs(step.steps) < kSettled * step.error) return delay;
  }
  return std::nullopt;
}

}  // namespace ifog
