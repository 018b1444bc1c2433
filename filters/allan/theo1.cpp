// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/theo1.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "filters/linear/symmetric.h"

namespace ifog {
namespace {

constexpr std::size_t kPlaces = 128;
constexpr std::size_t kFewestSamples = 64;
constexpr double kTauOfSpan = 0.75;

// Calls use with the four angles and the weight of each term of Thêo1.
template <typename Use>
void for_each_difference(std::size_t angles, std::size_t m, Use use) {
  const std::size_t half = m / 2;
  const double x = static_cast<double>(m);
  const double norm = kTauOfSpan * static_cast<double>(angles - m) * x * x;
  for (std::size_t i = 0; i + m < angles; ++i)
    for (std::size_t d = 0; d < half; ++d)
      use(std::array<std::size_t, 4>{i, i + half - d, i + half + d, i + m},
          1.0 / (static_cast<double>(half - d) * norm));
}
// (x[i] − x[i+m/2−δ]) + (x[i+m] − x[i+m/2+δ]).
constexpr std::array<double, 4> kSign{1.0, -1.0, -1.0, 1.0};

Eigen::MatrixXd quadratic_form(std::size_t angles, std::size_t m) {
  const auto n = static_cast<Eigen::Index>(angles);
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(n, n);
  for_each_difference(angles, m, [&](const std::array<std::size_t, 4>& at, double weight) {
    for (std::size_t a = 0; a < at.size(); ++a)
      for (std::size_t b = 0; b < at.size(); ++b)
        form(static_cast<Eigen::Index>(at[a]), static_cast<Eigen::Index>(at[b])) +=
            weight * kSign[a] * kSign[b];
  });
  return form;
}

// Generalised covariance of the angle.
Eigen::MatrixXd covariance(std::size_t angles, const TermVariances& terms) {
  const auto n = static_cast<Eigen::Index>(angles);
  Eigen::VectorXd lag(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto g = covariance_of_angle(static_cast<double>(i));
    lag[i] = 0.0;
    for (std::size_t t = 0; t < kTerms; ++t) lag[i] += terms[t] * g[t];
  }
  Eigen::MatrixXd c(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) c(i, j) = lag[std::abs(i - j)];
  return c;
}

// Distribution of form / mean: eigenvalues of F^½·C·F^½.
std::vector<WeightedChiSquared> law_of(const Eigen::MatrixXd& form, const Eigen::MatrixXd& c, double mean) {
  const SymmetricEigen root = symmetric_eigen(form);
  const Eigen::MatrixXd half =
      root.vectors * root.values.cwiseMax(0.0).cwiseSqrt().asDiagonal() * root.vectors.transpose();
  const Eigen::VectorXd modes = symmetric_eigenvalues(half * c * half / mean);
  std::vector<WeightedChiSquared> law;
  const double least = 1e-6 * modes.maxCoeff();
  for (const double weight : modes)
    if (weight > least) law.push_back({weight, 1.0});
  return law;
}

// Even spans with τ in (from, to], logarithmically spaced.
std::vector<std::size_t> spans(double from, double to, int per_decade) {
  std::vector<std::size_t> m;
  const double step = std::pow(10.0, 1.0 / per_decade);
  double tau = to;
  while (tau > from) {
    const auto even = 2 * static_cast<std::size_t>(std::floor(0.5 * tau / kTauOfSpan + 1e-9));
    if (m.empty() || even < m.back()) m.push_back(even);
    tau /= step;
  }
  std::ranges::reverse(m);
  return m;
}

}  // namespace

double theo1_variance(std::span<const double> angle, std::size_t m) {
  double sum = 0.0;
  for_each_difference(angle.size(), m, [&](const std::array<std::size_t, 4>& at, double weight) {
    const double z = (angle[at[0]] - angle[at[1]]) + (angle[at[3]] - angle[at[2]]);
    sum += weight * z * z;
  });
  return sum;
}

std::vector<LongPoint> theo1(const AngleSum& sum, const TermVariances& terms, double confidence,
                             int per_decade) {
  const auto part = std::ranges::max_element(sum.parts(), {}, &AngleSum::Part::angles);
  if (part == sum.parts().end() || part->angles <= kFewestSamples) return {};
  const std::size_t step = std::max<std::size_t>(1, (part->angles - 1) / kPlaces);
  const double scale = static_cast<double>(step);
  std::vector<double> angle;
  for (std::size_t i = 0; i < part->angles; i += step) angle.push_back(sum.angle()[part->first + i] / scale);
  // Averages over `step` samples have the same terms with these variances.
  TermVariances averaged{terms[kQ] / (scale * scale), terms[kN] / scale, terms[kB], terms[kK] * scale};
  if (std::ranges::all_of(averaged, [](double v) { return v <= 0.0; })) averaged[kN] = 1.0;
  const Eigen::MatrixXd c = covariance(angle.size(), averaged);
  const double samples = static_cast<double>(angle.size() - 1);
  std::vector<LongPoint> points;
  for (const std::size_t m : spans(0.25 * samples, kTauOfSpan * samples, per_decade)) {
    const Eigen::MatrixXd form = quadratic_form(angle.size(), m);
    const double mean = form.cwiseProduct(c).sum();
    LongPoint point;
    const double tau = kTauOfSpan * static_cast<double>(m);
    point.tau = tau * scale;
    double allan = 0.0;  // the powers of the terms also hold for τ that is not whole
    const std::array<double, kTerms> allan_of{3.0 / (tau * tau), 1.0 / tau,
                                              expected_variance(Deviation::kAllan, kB, 1), tau / 3.0};
    double most = 0.0;
    for (std::size_t t = 0; t < kTerms; ++t) {
      allan += averaged[t] * allan_of[t];
      if (averaged[t] * allan_of[t] > most) point.interval.strongest = static_cast<Term>(t);
      most = std::max(most, averaged[t] * allan_of[t]);
    }
    point.bias = allan / mean;
    point.variance = theo1_variance(angle, m) * point.bias;
    const Term strongest = point.interval.strongest;
    point.interval = interval_of(point.variance, law_of(form, c, mean), confidence);
    point.interval.strongest = strongest;
    points.push_back(point);
  }
  return points;
}

}  // namespace ifog
