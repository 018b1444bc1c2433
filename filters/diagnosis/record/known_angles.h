// SPDX-License-Identifier: Apache-2.0
// The running sum of an error and what was made of it, for the steps of a report that ask for the same.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "filters/allan/angle_sum.h"
#include "filters/allan/deviation.h"
#include "filters/allan/stretches.h"
#include "filters/diagnosis/record/known_series.h"

namespace ifog {

class KnownAngles {
 public:
  // Over the stretches without NaN. Valid until the next call for another series.
  const AngleSum& of(const AskedSeries& series) { return sum_of(known(series), series); }
  // As deviation(of(series), m).
  std::vector<DeviationPoint> points(const AskedSeries& series, std::span<const std::size_t> m);
  // As gapped_deviation(series, m).
  std::vector<double> gapped(const AskedSeries& series, std::span<const std::size_t> m);

 private:
  struct Known {
    std::vector<Stretch> present;  // without NaN
    bool finite = false;           // all of it, and there is some
    mutable std::optional<AngleSum> sum;
    mutable std::map<std::size_t, DeviationPoint> points;
  };
  const Known& known(const AskedSeries& series);
  static const AngleSum& sum_of(const Known& mine, const AskedSeries& series);

  KnownOfSeries<Known> known_{1};  // as long as the series itself each
};

}  // namespace ifog
