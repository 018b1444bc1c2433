// SPDX-License-Identifier: Apache-2.0
// Limits that the measured Allan deviation sets to the noise terms. The terms are fitted to the spectrum,
// possibly without some bands, but the deviation contains all bands. A term that alone exceeds the measured
// variance is refuted.
#pragma once

#include <vector>

#include "filters/allan/angle_sum.h"
#include "filters/allan/power_law.h"

namespace ifog {

class CurveLimits {
 public:
  // Uses octaves of m up to a quarter of the longest stretch; `sum` must outlive this object.
  explicit CurveLimits(const AngleSum& sum);
  // Sets the noise from which the confidence intervals are computed.
  void assume(const TermVariances& noise);

  // Largest variance of the term that the curve allows, exceeded in one of 1000 records.
  [[nodiscard]] double most(Term term) const;

  struct Verdict {
    bool refuted = false;
    std::size_t from_m = 1;  // shortest octave from which on the term stays below the curve
  };
  // Judges a term of at least this variance. If it exceeds the curve only at the shortest m, where the curve
  // rises, and is a good part of it beyond, a filter suppresses it there, and it is not refuted. Quantisation
  // that exceeds the curve anywhere is refuted.
  [[nodiscard]] Verdict judge(Term term, double variance) const;

 private:
  struct Octave {
    std::size_t m = 1;
    double measured = 0.0, upper = 0.0;  // variance
  };
  const AngleSum& sum_;
  std::vector<DeviationPoint> points_;
  std::vector<Octave> octaves_;
};

}  // namespace ifog
