// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/noise_spectrum.h"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <span>

#include "filters/allan/noise/angle_means.h"
#include "filters/linear/fourier.h"

namespace ifog {
namespace {

constexpr std::size_t kSegment = 480;  // steps of a level; fits into twice the fewest steps of a slow part
constexpr std::size_t kMostSegments = 8192;  // per level
constexpr std::size_t kSlow = 32;            // cosines per stretch
constexpr std::size_t kSlowMeans =
    256;  // fewest angle means for the cosines; there are fewer than twice as many
constexpr std::size_t kMostSlowStretches = 4;
// cycles per sample of the level; higher frequencies come from the level below
constexpr double kTopOfLevel = 1.0 / 16.0;
constexpr double kBottomOfLevel = 1.0 / 32.0;  // aliasing onto frequencies below this is negligible

// Windowed segment: its power, and the power expected of each term.
class Segment {
 public:
  explicit Segment(std::size_t size) : size_(size), window_(size) {
    for (std::size_t i = 0; i < size; ++i)
      window_[i] = std::sin(std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(size));
    fill_expected();
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  // Expected power for one unit of each term's variance.
  [[nodiscard]] TermVariances expected(int level, std::size_t bin) const {
    const auto table = std::min(static_cast<std::size_t>(level), expected_.size() - 1);
    TermVariances out = level_unit(level);
    for (std::size_t t = 0; t < kTerms; ++t) out[t] *= expected_[table][bin][t];
    return out;
  }

  // Adds the power of every bin below the Nyquist frequency. rate: size() samples, overwritten.
  void add_power(std::vector<double>& rate, Fourier& fourier, std::vector<double>& power) const {
    detrend(rate);
    for (std::size_t i = 0; i < size_; ++i) rate[i] *= window_[i];
    std::vector<std::complex<double>> bins;
    fourier.forward(bins, rate);
    for (std::size_t k = 0; k < power.size(); ++k) power[k] += std::norm(bins[k]);
  }

  // Effective number of independent samples in `segments` segments `hop` apart: (Σu)²/Σu², u the sum of
  // squared windows.
  [[nodiscard]] double effective_samples(std::size_t segments, std::size_t hop) const {
    const auto overlap = [&](std::size_t shift) {
      double sum = 0.0;
      for (std::size_t i = 0; i + shift < size_; ++i)
        sum += window_[i] * window_[i] * window_[i + shift] * window_[i + shift];
      return sum;
    };
    const double n = static_cast<double>(segments);
    double squares = n * overlap(0);
    for (std::size_t j = 1; j < segments && j * hop < size_; ++j)
      squares += 2.0 * (n - static_cast<double>(j)) * overlap(j * hop);
    const double all = n * 0.5 * static_cast<double>(size_);
    return all * all / squares;
  }

 private:
  template <typename T>
  void detrend(std::vector<T>& v) const {
    const double n = static_cast<double>(size_), middle = 0.5 * (n - 1.0);
    T mean{}, slope{};
    for (std::size_t i = 0; i < size_; ++i) {
      mean += v[i] / n;
      slope += v[i] * (12.0 * (static_cast<double>(i) - middle) / (n * (n * n - 1.0)));
    }
    for (std::size_t i = 0; i < size_; ++i) v[i] -= mean + slope * (static_cast<double>(i) - middle);
  }

  // A bin is |u'x|², u the windowed wave minus mean and slope: expected power is Σ over lags of covariance
  // times autocorrelation of u. Higher levels than the last differ only by their unit.
  void fill_expected() {
    constexpr int kLevels = 7;
    const std::size_t twice = 2 * size_, bins = size_ / 2;
    expected_.assign(kLevels, std::vector<TermVariances>(bins));
    std::vector<std::complex<double>> u(size_), spectrum, correlation;
    Fourier fourier;
    for (std::size_t k = 1; k < bins; ++k) {
      u.assign(size_, {});
      for (std::size_t i = 0; i < size_; ++i)
        u[i] = std::polar(window_[i], 2.0 * std::numbers::pi * static_cast<double>(k * i % size_) /
                                          static_cast<double>(size_));
      detrend(u);
      u.resize(twice);
      fourier.forward(spectrum, u);
      for (auto& s : spectrum) s = std::norm(s);
      fourier.inverse(correlation, spectrum);
      for (int level = 0; level < kLevels; ++level) {
        // Levels above the lowest use only low frequencies.
        if (level > 0 && static_cast<double>(k) > kTopOfLevel * static_cast<double>(size_)) break;
        const std::span<const TermVariances> covariance = level_covariance(level);
        TermVariances& expected = expected_[static_cast<std::size_t>(level)][k];
        for (std::size_t lag = 0; lag < size_; ++lag)
          for (std::size_t t = 0; t < kTerms; ++t)
            expected[t] += (lag == 0 ? 1.0 : 2.0) * covariance[lag][t] * correlation[lag].real();
      }
    }
  }

  std::size_t size_;
  std::vector<double> window_;
  std::vector<std::vector<TermVariances>> expected_;  // by level and bin
};

// Level of a stretch's slow part.
int last_level(std::size_t samples) {
  int level = 0;
  while (((samples + 1) >> (level + 1)) >= kSlowMeans) ++level;
  return level;
}

std::size_t slow_count(std::size_t averages) { return std::min(kSlow, averages / 2); }

// Highest level with a spectrum: one below the slow part, so that a segment fits.
int last_spectrum(std::size_t samples) { return std::max(0, last_level(samples) - 1); }

// Lowest bin frequency of the last spectrum above the slow part, cycles per sample of that level.
double slow_edge(std::size_t samples) {
  const std::size_t averages = ((samples + 1) >> last_level(samples)) - 1;
  const double edge =
      (static_cast<double>(slow_count(averages)) + 0.5) / (2.0 * static_cast<double>(averages));
  return edge * std::exp2(last_spectrum(samples) - last_level(samples));
}

// The slow cosines of a stretch.
void add_slow(const AngleMeans& means, std::size_t samples, std::vector<SlowCosine>& slow) {
  const int level = last_level(samples);
  const auto n = static_cast<Eigen::Index>(means.rates(level));
  const double step = std::exp2(level), length = static_cast<double>(n);
  Eigen::VectorXd rate(n);
  means.rates(level, 0, {rate.data(), means.rates(level)});
  const Eigen::ArrayXd place = Eigen::ArrayXd::LinSpaced(n, 0.5, length - 0.5) / length;
  const std::span<const TermVariances> covariance = level_covariance(level);
  const TermVariances unit = level_unit(level);
  for (std::size_t k = 1; k <= slow_count(means.rates(level)); ++k) {
    const auto half_turns = static_cast<double>(k);
    const Eigen::VectorXd w = std::sqrt(2.0 / length) * (std::numbers::pi * half_turns * place).cos();
    SlowCosine cosine{.frequency = 0.5 * half_turns / (length * step), .value = w.dot(rate)};
    cosine.ramp = w.dot((place * length).matrix()) * step;
    for (Eigen::Index lag = 0; lag < n; ++lag) {
      const double pairs = (lag == 0 ? 1.0 : 2.0) * w.head(n - lag).dot(w.tail(n - lag));
      for (std::size_t t = 0; t < kTerms; ++t)
        cosine.expected[t] += unit[t] * pairs * covariance[static_cast<std::size_t>(lag)][t];
    }
    slow.push_back(cosine);
  }
}

// Spectrum of one level in ascending frequency: all stretches that are long enough, above their own slow cosines.
std::vector<SpectralBin> spectrum_of(int level, const Segment& segment, std::span<const AngleMeans> means,
                                     const AngleSum& sum) {
  const std::size_t size = segment.size();
  std::vector<SpectralBin> bins(size / 2);
  Fourier fourier;
  for (std::size_t p = 0; p < means.size(); ++p) {
    const std::size_t samples = sum.parts()[p].angles - 1, count = means[p].rates(level);
    const int last = last_spectrum(samples);
    if (count < size || level > last) continue;
    // As many as fit with half overlap, spread from the first sample to the last.
    const std::size_t segments = std::min((count - size + size / 2 - 1) / (size / 2) + 1, kMostSegments);
    const double hop =
        segments > 1 ? static_cast<double>(count - size) / static_cast<double>(segments - 1) : 0.0;
    std::vector<double> power(size / 2), rate(size);
    for (std::size_t s = 0; s < segments; ++s) {
      means[p].rates(level, static_cast<std::size_t>(hop * static_cast<double>(s)), rate);
      segment.add_power(rate, fourier, power);
    }
    const double degrees =
        2.0 / static_cast<double>(size) *
        segment.effective_samples(segments, std::max<std::size_t>(1, static_cast<std::size_t>(hop)));
    const double bottom = level < last ? kBottomOfLevel : slow_edge(samples);
    const double top = level == 0 ? 0.5 : kTopOfLevel;
    for (std::size_t k = 1; k < bins.size(); ++k) {
      const double frequency = static_cast<double>(k) / static_cast<double>(size);
      if (frequency <= bottom || frequency > top) continue;
      bins[k].frequency = frequency / std::exp2(level);
      bins[k].expected = segment.expected(level, k);
      bins[k].power += power[k] / static_cast<double>(segments) * degrees;
      bins[k].degrees += degrees;
    }
  }
  std::erase_if(bins, [](const SpectralBin& bin) { return bin.degrees == 0.0; });
  for (SpectralBin& bin : bins) bin.power /= bin.degrees;
  return bins;
}

}  // namespace

NoiseSpectrum noise_spectrum(const AngleSum& sum) {
  NoiseSpectrum spectrum;
  // The table for full-size segments is computed once.
  static const Segment kWhole(kSegment);
  const Segment segment = sum.longest() >= kSegment ? kWhole : Segment(std::bit_floor(sum.longest()));
  std::vector<AngleMeans> means;
  for (const AngleSum::Part& part : sum.parts()) means.emplace_back(sum.angle(), part.first, part.angles);
  for (int l = last_spectrum(sum.longest()); l >= 0; --l) {
    const std::vector<SpectralBin> bins = spectrum_of(l, segment, means, sum);
    spectrum.bins.insert(spectrum.bins.end(), bins.begin(), bins.end());
  }
  std::ranges::sort(spectrum.bins, {}, &SpectralBin::frequency);
  // Above, a logger that holds values takes more than 1.3 % of the power.
  if (sum.held() > 1)
    std::erase_if(spectrum.bins, [most = 1.0 / (16.0 * static_cast<double>(sum.held()))](
                                     const SpectralBin& bin) { return bin.frequency > most; });
  std::vector<std::size_t> slow(means.size());
  std::iota(slow.begin(), slow.end(), std::size_t{0});
  const auto samples = [&](std::size_t p) { return sum.parts()[p].angles - 1; };
  std::ranges::sort(slow, [&](std::size_t a, std::size_t b) { return samples(a) > samples(b); });
  slow.resize(std::min(slow.size(), kMostSlowStretches));
  for (const std::size_t p : slow)
    if (samples(p) >= kShortestStretch) add_slow(means[p], samples(p), spectrum.slow);
  leave_out_lines(spectrum);
  return spectrum;
}

}  // namespace ifog
