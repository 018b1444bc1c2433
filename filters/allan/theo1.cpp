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

// Thêo1 of `angles` angles one sample apart as a quadratic form of them; m: even span.
Eigen::MatrixXd quadratic_form(std::size_t angles, std::size_t m) {
  const auto n = static_cast<Eigen::Index>(angles), span = static_cast<Eigen::Index>(m), half = span / 2;
  const double x = static_cast<double>(m);
  const double norm = kTauOfSpan * static_cast<double>(angles - m) * x * x;
  // (x[i] − x[i+m/2−δ]) + (x[i+m] − x[i+m/2+δ]).
  const Eigen::Vector4d sign(1.0, -1.0, -1.0, 1.0);
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i + span < n; ++i)
    for (Eigen::Index d = 0; d < half; ++d) {
      const std::array<Eigen::Index, 4> at{i, i + half - d, i + half + d, i + span};
      const Eigen::Matrix4d squares = sign * sign.transpose() / (static_cast<double>(half - d) * norm);
      // Two of the places are one where d is zero.
      for (Eigen::Index a = 0; a < 4; ++a)
        for (Eigen::Index b = 0; b < 4; ++b)
          form(at[static_cast<std::size_t>(a)], at[static_cast<std::size_t>(b)]) += squares(a, b);
    }
  return form;
}

// Distribution of form / mean: eigenvalues of F^½·C·F^½.
std::vector<WeightedChiSquared> law_of(const Eigen::MatrixXd& form, const Eigen::MatrixXd& c, double mean) {
  const SymmetricEigen root = symmetric_eigen(form);
  const Eigen::MatrixXd half =
      root.vectors * root.values.cwiseMax(0.0).cwiseSqrt().asDiagonal() * root.vectors.transpose();
  std::vector<WeightedChiSquared> law;
  add_modes(half * c * half / mean, law);
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
  const Eigen::MatrixXd c = toeplitz(angle.size(), covariance_of_angle, averaged);
  const double samples = static_cast<double>(angle.size() - 1);
  std::vector<LongPoint> points;
  for (const std::size_t m : spans(0.25 * samples, kTauOfSpan * samples, per_decade)) {
    const Eigen::MatrixXd form = quadratic_form(angle.size(), m);
    const double mean = form.cwiseProduct(c).sum();
    const double tau = kTauOfSpan * static_cast<double>(m);
    // The powers of the terms also hold for τ that is not whole.
    const Eigen::Array4d allan =
        Eigen::Array4d(3.0 / (tau * tau), 1.0 / tau, expected_variance(Deviation::kAllan, kB, 1), tau / 3.0) *
        Eigen::Map<const Eigen::Array4d>(averaged.data());
    LongPoint point;
    point.tau = tau * scale;
    point.bias = allan.sum() / mean;
    const Eigen::Map<const Eigen::VectorXd> angles(angle.data(), std::ssize(angle));
    point.variance = angles.dot(form * angles) * point.bias;
    point.interval = interval_of(point.variance, law_of(form, c, mean), confidence);
    Eigen::Index strongest = 0;
    allan.maxCoeff(&strongest);
    point.interval.strongest = static_cast<Term>(strongest);
    points.push_back(point);
  }
  return points;
}

}  // namespace ifog
