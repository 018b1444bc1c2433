// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/power_law.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <vector>

namespace ifog {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// Difference of the angle or of its running sum: coefficients at multiples of m; variance = mean square /
// (norm·m^power).
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

// Intervals up to this length are summed lag by lag.
constexpr std::size_t kSummedSingly = 64;
// Beyond this many spans only flicker contributes, falling at least with the fourth power of the lag.
constexpr std::size_t kReach = 8;

// Σ over lags of (number of pairs at that lag)·γγ'. All factors are even, so only lags >= 0 are summed.
Eigen::Matrix4d sum_over_lags(const Difference& difference, std::size_t m,
                              std::span<const std::size_t> places) {
  Eigen::Matrix4d sums = Eigen::Matrix4d::Zero();
  const auto add = [&](double lag, double times) {
    const TermVariances at = covariance_between(difference, static_cast<double>(m), lag);
    const Eigen::Map<const Eigen::Vector4d> gamma(at.data());
    double pairs = 0.0;
    for (const std::size_t p : places) pairs += std::max(0.0, static_cast<double>(p) - lag);
    sums += (lag == 0.0 ? 1.0 : 2.0) * times * pairs * gamma * gamma.transpose();
  };
  const std::size_t spans = kReach * (difference.weight.size() - 1),
                    end = std::min(std::ranges::max(places), spans * m);
  // The covariance bends at multiples of m, where the spike of quantisation is, too; the pairs where a stretch ends.
  std::set<std::size_t> bends(places.begin(), places.end());
  bends.insert(end);
  for (std::size_t k = 0; k <= spans; ++k) bends.insert({k * m, k * m + 1});
  for (auto at = bends.begin(); *at < end;) {
    const std::size_t begin = *at, next = *++at;
    if (next - begin <= kSummedSingly) {
      for (std::size_t lag = begin; lag < next; ++lag) add(static_cast<double>(lag), 1.0);
      continue;
    }
    using Rule = boost::math::quadrature::gauss<double, 20>;
    const double half = 0.5 * static_cast<double>(next - begin),
                 middle = static_cast<double>(begin) - 0.5 + half;
    for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
      for (const double side : {-half, half})
        add(middle + side * Rule::abscissa()[k], half * Rule::weights()[k]);
  }
  return sums;
}

}  // namespace

std::array<double, kTerms> covariance_of_angle(double t) {
  const double a = std::abs(t);
  return {a == 0.0 ? 1.0 : 0.0, -0.5 * a, a > 0.0 ? a * a * std::log(a) / kTwoPi : 0.0, a * a * a / 12.0};
}

std::array<double, kTerms> covariance_of_differences(Deviation kind, std::size_t m, double lag) {
  return covariance_between(difference_of(kind), static_cast<double>(m), lag);
}

TermVariances covariance_of_sum_differences(std::size_t m, double lag) {
  static const Difference kSecond{{1.0, -2.0, 1.0}, 1.0, 0.0, true};
  return covariance_between(kSecond, static_cast<double>(m), lag);
}

double expected_variance(Deviation kind, const TermVariances& variances, std::size_t averaged) {
  const double m = static_cast<double>(averaged);
  const Difference& d = difference_of(kind);
  const TermVariances square = covariance_between(d, m, 0.0);
  return std::inner_product(square.begin(), square.end(), variances.begin(), 0.0) /
         (d.norm * std::pow(m, d.power));
}

double expected_variance(Deviation kind, Term term, std::size_t m) {
  TermVariances one{};
  one[term] = 1.0;
  return expected_variance(kind, one, m);
}

EstimateVariance::EstimateVariance(Deviation kind, std::size_t m, std::span<const std::size_t> samples)
    : kind_(kind), m_(m) {
  const Difference& d = difference_of(kind);
  std::vector<std::size_t> places;
  for (const std::size_t n : samples)
    if (const std::size_t fit = differences_of(kind, m, n); fit > 0) places.push_back(fit);
  if (places.empty()) return;
  const double all = static_cast<double>(std::reduce(places.begin(), places.end()));
  const double scale = d.norm * std::pow(static_cast<double>(m), d.power) * all;
  sums_ = 2.0 / (scale * scale) * sum_over_lags(d, m, places);
}

double EstimateVariance::at(const TermVariances& variances) const {
  const Eigen::Map<const Eigen::Vector4d> v(variances.data());
  return v.dot(sums_ * v);
}

double EstimateVariance::degrees(const TermVariances& v) const {
  const double mean = expected_variance(kind_, v, m_), variance = at(v);
  return variance > 0.0 ? 2.0 * mean * mean / variance : 0.0;
}

}  // namespace ifog
