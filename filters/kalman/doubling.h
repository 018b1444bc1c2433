// SPDX-License-Identifier: Apache-2.0
// The prediction covariance of a time-invariant Kalman filter many samples ahead: doubling algorithm of
// Anderson and Moore, "Optimal Filtering", section 6.7. Measurements at every sample, missing ones in between
// are the caller's.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace ifog {

// One step of the Riccati equation, P' = Q + A P (I + G P)^-1 A' with G = h h'/R, and any number of them is a
// map of the same form P' = H + F P (I + G P)^-1 F'; two such maps in a row are found without knowing P.
template <int n>
class CovarianceDoubling {
 public:
  using Vector = Eigen::Matrix<double, n, 1>;
  using Matrix = Eigen::Matrix<double, n, n>;

  // noise: R > 0.
  CovarianceDoubling(const Matrix& transition, const Matrix& driving, const Vector& h, double noise)
      : maps_{{transition, h * h.transpose() / noise, driving}} {}

  // 2^power samples ahead.
  [[nodiscard]] Matrix ahead(const Matrix& p, std::size_t power) {
    while (maps_.size() <= power) maps_.push_back(twice(maps_.back()));
    const Map& map = maps_[power];
    const Matrix between = (Matrix::Identity() + p * map.g).partialPivLu().solve(p);
    const Matrix next = map.h + map.f * between * map.f.transpose();
    return 0.5 * (next + next.transpose());
  }

 private:
  struct Map {
    Matrix f, g, h;
  };
  static Map twice(const Map& one) {
    const auto inverse = (Matrix::Identity() + one.g * one.h).partialPivLu();
    const Matrix across = inverse.solve(one.g);
    const Matrix through = (Matrix::Identity() + one.h * one.g).partialPivLu().solve(one.h);
    Map two;
    // P -> second(first(P)); both are the same map, so the order does not matter.
    two.f = one.f * (Matrix::Identity() + one.h * one.g).partialPivLu().solve(one.f);
    two.g = one.g + one.f.transpose() * across * one.f;
    two.h = one.h + one.f * through * one.f.transpose();
    two.g = (0.5 * (two.g + two.g.transpose())).eval();
    two.h = (0.5 * (two.h + two.h.transpose())).eval();
    return two;
  }

  std::vector<Map> maps_;
};

}  // namespace ifog
