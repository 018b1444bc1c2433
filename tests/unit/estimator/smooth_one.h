// SPDX-License-Identifier: Apache-2.0
// One axis smoothed, by itself.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "filters/smoother/smoother.h"
#include "tests/unit/estimator/drive.h"

namespace ifog::test {

// dt_s: empty: kPeriod each.
inline Smoothed smooth_one(const FilterSettings& settings, const std::vector<double>& rate,
                           std::vector<double> dt_s = {}, const AxisNoise& noise = {}) {
  if (dt_s.empty()) dt_s.assign(rate.size(), kPeriod);
  const std::array<std::span<const double>, 1> rates{rate};
  return std::move(smooth(settings, noise, rates, dt_s, kPeriod)[0]);
}

// Mean square of the error over the samples in [from, to), and of the error over its variance.
struct Judged {
  double square = 0.0, normalised = 0.0, count = 0.0;
  void add(const Smoothed& got, const std::vector<double>& truth, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      const double apart = got.rate_radps[i] - truth[i];
      square += apart * apart;
      normalised += apart * apart / got.variance_rad2ps2[i];
      count += 1.0;
    }
  }
  [[nodiscard]] double mean_square() const { return square / count; }
  [[nodiscard]] double nees() const { return normalised / count; }
};

}  // namespace ifog::test
