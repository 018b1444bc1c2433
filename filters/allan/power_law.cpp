// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/power_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace ifog {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// Difference of the angle or of its running sum: coefficients at multiples of m; variance = mean square /
// (norm·m^power). It reaches over order·m − `less` angles.
struct Difference {
  std::vector<double> weight;
  double norm, power;
  bool of_sum;
};

const Difference& difference_of(Deviation kind) {
  static const Difference kAllanOne{{1.0, -2.0, 1.0}, 2.0, 2.0, false};
  static const Difference kHadamardOne{{-1.0, 3.0, -3.0, 1.0}, 6.0, 2.0, false};
  // A mean over m neighbouring second differences is a third difference of the running sum.
  static const Difference kModifiedOne{{-1.0, 3.0, -3.0, 1.0}, 2.0, 4.0, true};
  return kind == Deviation::kAllan ? kAllanOne : kind == Deviation::kHadamard ? kHadamardOne : kModifiedOne;
}

// Even function g on the integers with g(t+1) − 2g(t) + g(t−1) = −t² ln|t|/2π: generalised covariance of the
// running sum of flicker noise. Far from zero by 1/(4 sinh²(∂/2)) = ∂⁻² − 1/12 + ∂²/240 − ∂⁴/6048 + … (Euler
// and Maclaurin), from there by recursion; symmetry fixes the free multiple of |t|.
class FlickerSum {
 public:
  FlickerSum() {
    for (int t = kTable - 1; t < kTable + 1; ++t) value_[static_cast<std::size_t>(t)] = far(t);
    for (int t = kTable - 1; t >= 1; --t) {
      const auto i = static_cast<std::size_t>(t);
      value_[i - 1] = 2.0 * value_[i] - value_[i + 1] - t * t * std::log(t) / kTwoPi;
    }
    slope_ = value_[0] - value_[1];
    for (int t = 0; t <= kTable; ++t) value_[static_cast<std::size_t>(t)] += slope_ * t;
  }
  [[nodiscard]] double at(double t) const {
    return t <= kTable ? value_[static_cast<std::size_t>(t)] : far(t) + slope_ * t;
  }

 private:
  static constexpr int kTable = 16;
  static double far(double t) {
    const double log = std::log(t), t2 = t * t;
    return -(t2 * t2 * (log / 12.0 - 7.0 / 144.0) - t2 * log / 12.0 + (2.0 * log + 3.0) / 240.0 +
             2.0 / (6048.0 * t2)) /
           kTwoPi;
  }
  std::array<double, kTable + 1> value_{};
  double slope_ = 0.0;
};

// covariance_of_angle for the angle's running sum, at whole lags and far lags. The second difference of each
// is minus the angle's covariance.
std::array<double, kTerms> covariance_of_sum(double t) {
  static const FlickerSum kFlicker;
  const double a = std::abs(t), a3 = a * a * a;
  return {-0.5 * a, (a3 - a) / 12.0, kFlicker.at(a),
          -a3 * a * a / 240.0 + a3 / 144.0 + a * (1.0 / 240.0 - 1.0 / 144.0)};
}

std::array<double, kTerms> covariance_of(const Difference& d, double t) {
  return d.of_sum ? covariance_of_sum(t) : covariance_of_angle(t);
}

TermVariances covariance_between(const Difference& d, double m, double lag) {
  TermVariances gamma{};
  for (std::size_t a = 0; a < d.weight.size(); ++a)
    for (std::size_t b = 0; b < d.weight.size(); ++b) {
      const auto g = covariance_of(d, lag + (static_cast<double>(a) - static_cast<double>(b)) * m);
      for (std::size_t k = 0; k < kTerms; ++k) gamma[k] += d.weight[a] * d.weight[b] * g[k];
    }
  return gamma;
}

// Eight-point Gauss–Legendre, positive half (Abramowitz and Stegun, table 25.4).
constexpr std::array<double, 4> kNode{0.183434642495649805, 0.525532409916328986, 0.796666477413626740,
                                      0.960289856497536232};
constexpr std::array<double, 4> kWeight{0.362683783378361983, 0.313706645877887287, 0.222381034453374471,
                                        0.101228536290376259};

// Lags summed singly on either side of a bend; also the shortest panel.
constexpr long long kSummedExactly = 24;
// Beyond this many spans only flicker contributes, falling at least with the fourth power of the lag.
constexpr long long kReach = 8;

// Σ over lags of (number of pairs at that lag)·γⱼ·γₗ. Both factors are even, so only lags >= 0 are summed.
class LagSum {
 public:
  LagSum(const Difference& difference, std::size_t m, std::span<const double> places)
      : difference_(difference), m_(static_cast<double>(m)), places_(places) {
    const auto order = static_cast<long long>(difference.weight.size()) - 1;
    const auto step = static_cast<long long>(m);
    double most = 0.0;
    for (const double p : places) most = std::max(most, p);
    const long long end = std::min(static_cast<long long>(most), kReach * order * step);
    std::vector<long long> bends{0, 1, end};
    for (long long k = 1; k <= order; ++k) {
      bends.push_back(k * step);
      bends.push_back(k * step + 1);  // spike at k·m
    }
    for (const double p : places) bends.push_back(static_cast<long long>(p));
    std::ranges::sort(bends);
    bends.erase(std::unique(bends.begin(), bends.end()), bends.end());
    for (std::size_t i = 0; i + 1 < bends.size(); ++i)
      if (bends[i] >= 0 && bends[i + 1] <= end) between(bends[i], bends[i + 1]);
  }
  [[nodiscard]] const std::array<std::array<double, kTerms>, kTerms>& sums() const { return sums_; }

 private:
  void add(double lag, double times) {
    const TermVariances gamma = covariance_between(difference_, m_, lag);
    double pairs = 0.0;
    for (const double p : places_) pairs += std::max(0.0, p - lag);
    pairs *= lag == 0.0 ? times : 2.0 * times;
    for (std::size_t j = 0; j < kTerms; ++j)
      for (std::size_t l = 0; l < kTerms; ++l) sums_[j][l] += pairs * gamma[j] * gamma[l];
  }

  void panel(long long begin, long long end) {
    if (end - begin <= kSummedExactly) {
      for (long long s = begin; s < end; ++s) add(static_cast<double>(s), 1.0);
      return;
    }
    const double half = 0.5 * static_cast<double>(end - begin);
    const double middle = static_cast<double>(begin) - 0.5 + half;
    for (std::size_t k = 0; k < kNode.size(); ++k) {
      add(middle - half * kNode[k], half * kWeight[k]);
      add(middle + half * kNode[k], half * kWeight[k]);
    }
  }

  // Lags begin … end − 1 with bends at both ends: panels double in length towards the middle.
  void between(long long begin, long long end) {
    if (end - begin <= 4 * kSummedExactly) {
      for (long long s = begin; s < end; ++s) add(static_cast<double>(s), 1.0);
      return;
    }
    long long low = begin, high = end, length = kSummedExactly;
    while (high - low > 4 * length) {
      panel(low, low + length);
      panel(high - length, high);
      low += length;
      high -= length;
      length = low - begin;
    }
    const long long middle = low + (high - low) / 2;
    panel(low, middle);
    panel(middle, high);
  }

  const Difference& difference_;
  double m_;
  std::span<const double> places_;
  std::array<std::array<double, kTerms>, kTerms> sums_{};
};

}  // namespace

std::array<double, kTerms> covariance_of_angle(double t) {
  const double a = std::abs(t);
  return {a == 0.0 ? 1.0 : 0.0, -0.5 * a, a > 0.0 ? a * a * std::log(a) / kTwoPi : 0.0, a * a * a / 12.0};
}

std::array<double, kTerms> covariance_of_differences(Deviation kind, std::size_t m, double lag) {
  return covariance_between(difference_of(kind), static_cast<double>(m), lag);
}

std::size_t differences_of(Deviation kind, std::size_t m, std::size_t samples) {
  const Difference& d = difference_of(kind);
  const std::size_t reach = (d.weight.size() - 1) * m - (d.of_sum ? 1 : 0);
  return samples + 1 > reach ? samples + 1 - reach : 0;
}

double expected_variance(Deviation kind, const TermVariances& variances, std::size_t averaged) {
  const double m = static_cast<double>(averaged);
  const Difference& d = difference_of(kind);
  double variance = 0.0;
  for (std::size_t a = 0; a < d.weight.size(); ++a)
    for (std::size_t b = 0; b < d.weight.size(); ++b) {
      const auto g = covariance_of(d, (static_cast<double>(a) - static_cast<double>(b)) * m);
      for (std::size_t t = 0; t < kTerms; ++t) variance += variances[t] * d.weight[a] * d.weight[b] * g[t];
    }
  return variance / (d.norm * std::pow(m, d.power));
}

double expected_variance(Deviation kind, Term term, std::size_t m) {
  TermVariances one{};
  one[term] = 1.0;
  return expected_variance(kind, one, m);
}

EstimateVariance::EstimateVariance(Deviation kind, std::size_t m, std::span<const std::size_t> samples)
    : kind_(kind), m_(m) {
  const Difference& d = difference_of(kind);
  std::vector<double> places;
  double all = 0.0;
  for (const std::size_t n : samples)
    if (const std::size_t fit = differences_of(kind, m, n); fit > 0) {
      places.push_back(static_cast<double>(fit));
      all += places.back();
    }
  if (places.empty()) return;
  sums_ = LagSum(d, m, places).sums();
  const double scale = d.norm * std::pow(static_cast<double>(m), d.power) * all;
  for (auto& row : sums_)
    for (double& s : row) s *= 2.0 / (scale * scale);
}

double EstimateVariance::at(const TermVariances& v) const {
  double value = 0.0;
  for (std::size_t j = 0; j < kTerms; ++j)
    for (std::size_t l = 0; l < kTerms; ++l) value += v[j] * v[l] * sums_[j][l];
  return value;
}

double EstimateVariance::degrees(const TermVariances& v) const {
  const double mean = expected_variance(kind_, v, m_), variance = at(v);
  return variance > 0.0 ? 2.0 * mean * mean / variance : 0.0;
}

}  // namespace ifog
