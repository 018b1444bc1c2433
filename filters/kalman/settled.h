// What a filter whose gain stays as it is does to a slow signal: x(k) = F x(k-1) + K z(k), F = (I - K h')A.
#pragma once

#include <Eigen/Dense>

namespace ifog {

// Both in sample periods.
struct Settled {
  double lag = 0.0;          // group delay of r'x behind z at zero frequency
  double correlation = 0.0;  // sum of the autocorrelation of the error r'x - rate over lags from 0
};

// The output is r'x, the part of h'x that is the rate. With G(q) = r'(I - F/q)^-1 K: G(1) = r'(I-F)^-1 K,
// delay = r'(I-F)^-1 F (I-F)^-1 K / G(1). The error obeys e(k) = F e(k-1) + noise, so its autocovariance is
// r'F^j P r and sums to r'(I-F)^-1 P r.
template <int n>
[[nodiscard]] Settled settled(const Eigen::Matrix<double, n, n>& transition,
                              const Eigen::Matrix<double, n, 1>& h, const Eigen::Matrix<double, n, 1>& r,
                              const Eigen::Matrix<double, n, 1>& gain,
                              const Eigen::Matrix<double, n, n>& covariance) noexcept {
  using Matrix = Eigen::Matrix<double, n, n>;
  using Vector = Eigen::Matrix<double, n, 1>;
  const Matrix f = (Matrix::Identity() - gain * h.transpose()) * transition;
  const Eigen::PartialPivLU<Matrix> lu(Matrix::Identity() - f);
  const Vector once = lu.solve(gain);
  const Vector twice = lu.solve(f * once);
  const Vector pr = covariance * r;
  return {r.dot(twice) / r.dot(once), r.dot(lu.solve(pr)) / r.dot(pr)};
}

}  // namespace ifog
