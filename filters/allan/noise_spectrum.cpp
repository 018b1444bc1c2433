#include "filters/allan/noise_spectrum.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace ifog {
namespace {

constexpr std::size_t kSegment = 512;          // samples of a level
constexpr std::size_t kMostSegments = 8192;    // of a level
constexpr std::size_t kSlow = 32;              // cosines of a stretch
constexpr std::size_t kSlowSamples = 256;      // averages they are taken of, at least: fewer than twice this
constexpr std::size_t kMostSlowParts = 4;      // stretches
constexpr double kTopOfLevel = 1.0 / 16.0;     // cycles a sample of the level; above, the level below has it:
constexpr double kBottomOfLevel = 1.0 / 32.0;  // averaging folds next to nothing onto frequencies this low

// Covariance of averages at a lag of whole samples.
TermVariances covariance_of_rate(double lag) {
  TermVariances c = covariance_of_angle(lag);
  const TermVariances above = covariance_of_angle(lag + 1.0), below = covariance_of_angle(lag - 1.0);
  for (std::size_t t = 0; t < kTerms; ++t) c[t] = 2.0 * c[t] - above[t] - below[t];
  return c;
}

// Variances of the averages' terms for one unit of the samples' own.
TermVariances scale_of(double averaged) {
  return {1.0 / (averaged * averaged), 1.0 / averaged, 1.0, averaged};
}

// A windowed segment: its power, and what each term makes of it.
class Segment {
 public:
  explicit Segment(std::size_t size) : size_(size), window_(size), from_(size), into_(size) {
    for (std::size_t i = 0; i < size; ++i)
      window_[i] = std::sin(std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(size));
    fill_expected();
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const TermVariances& expected(std::size_t bin) const { return expected_[bin]; }

  // rate: size() samples, spoilt. Adds the power of every bin below the Nyquist frequency.
  void add_power(std::vector<double>& rate, std::vector<double>& power) {
    detrend(rate);
    for (std::size_t i = 0; i < size_; ++i) from_[i] = rate[i] * window_[i];
    fft_.fwd(into_, from_);
    for (std::size_t k = 0; k < power.size(); ++k) power[k] += std::norm(into_[k]);
  }

  // Samples' worth of information in `segments` of them `hop` apart: (Σu)²/Σu², u the sum of squared windows.
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

  // A bin is |u'x|² with u the windowed wave less its own mean and slope: expected is Σ over lags of the
  // covariance times u's autocorrelation.
  void fill_expected() {
    const std::size_t twice = 2 * size_;
    std::vector<TermVariances> covariance(size_);
    for (std::size_t lag = 0; lag < size_; ++lag)
      covariance[lag] = covariance_of_rate(static_cast<double>(lag));
    expected_.resize(size_ / 2);
    std::vector<std::complex<double>> u(size_), spectrum, correlation;
    for (std::size_t k = 1; k < expected_.size(); ++k) {
      u.assign(size_, {});
      for (std::size_t i = 0; i < size_; ++i)
        u[i] = std::polar(window_[i], 2.0 * std::numbers::pi * static_cast<double>(k * i % size_) /
                                          static_cast<double>(size_));
      detrend(u);
      u.resize(twice);
      fft_.fwd(spectrum, u);
      for (auto& s : spectrum) s = std::norm(s);
      fft_.inv(correlation, spectrum);
      for (std::size_t lag = 0; lag < size_; ++lag)
        for (std::size_t t = 0; t < kTerms; ++t)
          expected_[k][t] += (lag == 0 ? 1.0 : 2.0) * covariance[lag][t] * correlation[lag].real();
    }
  }

  std::size_t size_;
  std::vector<double> window_, from_;
  std::vector<std::complex<double>> into_;
  std::vector<TermVariances> expected_;
  Eigen::FFT<double> fft_;
};

// The averages of 2^level samples of a stretch, from the angle.
struct Averages {
  const double* angle;
  std::size_t step, count;
  [[nodiscard]] double at(std::size_t i) const {
    return (angle[(i + 1) * step] - angle[i * step]) / static_cast<double>(step);
  }
};

// How far up a stretch is averaged before its slow part is taken.
int last_level(std::size_t samples) {
  int level = 0;
  while ((samples >> (level + 1)) >= kSlowSamples) ++level;
  return level;
}

std::size_t slow_count(std::size_t averages) { return std::min(kSlow, averages / 2); }

// The highest level whose spectrum is taken: half as far averaged as the slow part, so that a segment fits.
int last_spectrum(std::size_t samples) { return std::max(0, last_level(samples) - 1); }

// Lowest bin frequency that the slow part leaves to the last spectrum, cycles a sample of that level.
double slow_edge(std::size_t samples) {
  const std::size_t averages = samples >> last_level(samples);
  const double edge =
      (static_cast<double>(slow_count(averages)) + 0.5) / (2.0 * static_cast<double>(averages));
  return edge * std::exp2(last_spectrum(samples) - last_level(samples));
}

Eigen::MatrixXd cosines(std::size_t n, std::size_t count) {
  Eigen::MatrixXd w(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(count));
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = 0; i < n; ++i)
      w(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          std::sqrt(2.0 / static_cast<double>(n)) *
          std::cos(std::numbers::pi * static_cast<double>(k + 1) * (static_cast<double>(i) + 0.5) /
                   static_cast<double>(n));
  return w;
}

// w'Γw of the Toeplitz matrix of a term.
Eigen::MatrixXd projected(const Eigen::MatrixXd& w, std::size_t term) {
  const Eigen::Index n = w.rows();
  if (term == kN) return w.transpose() * w;
  if (term == kQ) {  // 2 on the diagonal, −1 beside it
    const Eigen::MatrixXd beside = w.topRows(n - 1).transpose() * w.bottomRows(n - 1);
    return 2.0 * w.transpose() * w - beside - beside.transpose();
  }
  if (term == kK) {
    // −|lag|/2 is the covariance of a running sum, up to constants, which columns without a mean do not see;
    // the averages take a sixth off at lag zero.
    Eigen::MatrixXd sums = w;
    for (Eigen::Index i = 1; i < n; ++i) sums.row(i) += sums.row(i - 1);
    return sums.transpose() * sums - w.transpose() * w / 6.0;
  }
  Eigen::VectorXd lag(n);
  for (Eigen::Index i = 0; i < n; ++i) lag[i] = covariance_of_rate(static_cast<double>(i))[term];
  Eigen::MatrixXd product(n, w.cols());
  for (Eigen::Index i = 0; i < n; ++i)
    product.row(i) = lag.head(i + 1).reverse().transpose() * w.topRows(i + 1) +
                     lag.segment(1, n - 1 - i).transpose() * w.bottomRows(n - 1 - i);
  return w.transpose() * product;
}

SlowPart slow_part(const double* angle, std::size_t samples) {
  const int level = last_level(samples);
  const Averages averages{angle, std::size_t{1} << level, samples >> level};
  const auto n = static_cast<Eigen::Index>(averages.count);
  const Eigen::MatrixXd w = cosines(averages.count, slow_count(averages.count));
  Eigen::VectorXd rate(n), ramp(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    rate[i] = averages.at(static_cast<std::size_t>(i));
    ramp[i] =
        (static_cast<double>(i) - 0.5 * static_cast<double>(n - 1)) * static_cast<double>(averages.step);
  }
  SlowPart part;
  part.value = w.transpose() * rate;
  part.ramp = w.transpose() * ramp;
  const TermVariances scale = scale_of(static_cast<double>(averages.step));
  for (std::size_t t = 0; t < kTerms; ++t) part.covariance[t] = scale[t] * projected(w, t);
  return part;
}

// Spectrum of one level: all stretches that are long enough, and not below their own slow part.
class Level {
 public:
  Level(Segment& segment, int level) : segment_(segment), level_(level), power_(segment.size() / 2) {
    bins_.resize(power_.size());
  }

  void add(const double* angle, std::size_t samples) {
    const Averages averages{angle, std::size_t{1} << level_, samples >> level_};
    const std::size_t size = segment_.size();
    if (averages.count < size || level_ > last_spectrum(samples)) return;
    // As many as overlap by half, spread from the first sample to the last.
    std::size_t segments = (averages.count - size + size / 2 - 1) / (size / 2) + 1;
    segments = std::min(segments, kMostSegments);
    const double hop =
        segments > 1 ? static_cast<double>(averages.count - size) / static_cast<double>(segments - 1) : 0.0;
    std::fill(power_.begin(), power_.end(), 0.0);
    std::vector<double> rate(size);
    for (std::size_t s = 0; s < segments; ++s) {
      const auto begin = static_cast<std::size_t>(hop * static_cast<double>(s));
      for (std::size_t i = 0; i < size; ++i) rate[i] = averages.at(begin + i);
      segment_.add_power(rate, power_);
    }
    const double degrees =
        2.0 / static_cast<double>(size) *
        segment_.effective_samples(segments, std::max<std::size_t>(1, static_cast<std::size_t>(hop)));
    const double bottom = level_ < last_spectrum(samples) ? kBottomOfLevel : slow_edge(samples);
    const double top = level_ == 0 ? 0.5 : kTopOfLevel;
    for (std::size_t k = 1; k < bins_.size(); ++k) {
      const double frequency = static_cast<double>(k) / static_cast<double>(size);
      if (frequency <= bottom || frequency > top) continue;
      bins_[k].power += power_[k] / static_cast<double>(segments) * degrees;
      bins_[k].degrees += degrees;
    }
  }

  // Ascending in frequency.
  [[nodiscard]] std::vector<SpectralBin> bins() const {
    const TermVariances scale = scale_of(std::exp2(level_));
    std::vector<SpectralBin> out;
    for (std::size_t k = 1; k < bins_.size(); ++k) {
      SpectralBin bin = bins_[k];
      if (bin.degrees == 0.0) continue;
      bin.frequency = static_cast<double>(k) / static_cast<double>(segment_.size()) / std::exp2(level_);
      bin.power /= bin.degrees;
      for (std::size_t t = 0; t < kTerms; ++t) bin.expected[t] = scale[t] * segment_.expected(k)[t];
      out.push_back(bin);
    }
    return out;
  }

 private:
  Segment& segment_;
  int level_;
  std::vector<double> power_;
  std::vector<SpectralBin> bins_;
};

}  // namespace

NoiseSpectrum noise_spectrum(const AngleSum& sum) {
  NoiseSpectrum spectrum;
  // Most records have room for whole segments, whose table is made once.
  static const Segment kWhole(kSegment);
  Segment segment = sum.longest() >= kSegment ? kWhole : Segment(std::bit_floor(sum.longest()));
  for (int l = last_spectrum(sum.longest()); l >= 0; --l) {
    Level level(segment, l);
    for (const AngleSum::Part& part : sum.parts())
      level.add(sum.angle().data() + part.first, part.angles - 1);
    for (const SpectralBin& bin : level.bins()) spectrum.bins.push_back(bin);
  }
  std::sort(spectrum.bins.begin(), spectrum.bins.end(),
            [](const SpectralBin& a, const SpectralBin& b) { return a.frequency < b.frequency; });
  std::vector<AngleSum::Part> slow = sum.parts();
  std::sort(slow.begin(), slow.end(), [](const auto& a, const auto& b) { return a.angles > b.angles; });
  slow.resize(std::min(slow.size(), kMostSlowParts));
  for (const AngleSum::Part& part : slow)
    if (part.angles > kShortestStretch)
      spectrum.slow.push_back(slow_part(sum.angle().data() + part.first, part.angles - 1));
  leave_out_lines(spectrum);
  return spectrum;
}

}  // namespace ifog
