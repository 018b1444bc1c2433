// What a filter whose gain stays as it is does to a slow signal: x(k) = F x(k-1) + K z(k), F = (I - K h')A.
#pragma once

#include <Eigen/Dense>

namespace ifog {

// Both in sample periods.
struct Settled {
  double lag = 0.0;          // group delay of h'x behind z at zero frequency
  double correlation = 0.0;  // sum of the autocorrelation of the error h'x - rate over lags from 0
};

// With G(q) = h'(I - F/q)^-1 K: G(1) = h'(I-F)^-1 K, delay = h'(I-F)^-1 F (I-F)^-1 K / G(1). The error obeys
// e(k) = F e(k-1) + noise, so its autocovariance is h'F^j P h and sums to h'(I-F)^-1 P h.
template <int n>
[[nodiscard]] Settled settled(const Eigen::Matrix<double, n, n>& transition,
                              const Eigen::Matrix<double, n, 1>& h, const Eigen::Matrix<double, n, 1>& gain,
                              const Eigen::Matrix<double, n, n>& covariance) noexcept {
  using Matrix = Eigen::Matrix<double, n, n>;
  using Vector = Eigen::Matrix<double, n, 1>;
  const Matrix f = (Matrix::Identity() - gain * h.transpose()) * transition;
  const Eigen::PartialPivLU<Matrix> lu(Matrix::Identity() - f);
  const Vector once = lu.solve(gain);
  const Vector twice = lu.solve(f * once);
  const Vector ph = covariance * h;
  return {h.dot(twice) / h.dot(once), h.dot(lu.solve(ph)) / h.dot(ph)};
}

}  // namespace ifog
