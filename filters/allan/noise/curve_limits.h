// SPDX-License-Identifier: Apache-2.0
// What the measured Allan deviation itself allows of a noise term. Terms are found in the spectrum, of which
// bands may be dropped; the variance of a term is made of all of them. A term that by itself is more than
// the variance that was measured is not there, however well it describes the bands that were used.
#pragma once

#include <vector>

#include "filters/allan/angle_sum.h"
#include "filters/allan/power_law.h"

namespace ifog {

class CurveLimits {
 public:
  // Looks at octaves of m up to a quarter of the longest stretch; the sum has to outlive this.
  explicit CurveLimits(const AngleSum& sum);
  // The noise that the deviation's intervals are of, as found so far.
  void assume(const TermVariances& noise);

  // Largest variance of the term that no octave denies, in all but one record of a thousand.
  [[nodiscard]] double most(Term term) const;

  struct Verdict {
    bool refuted = false;
    std::size_t from_m = 1;  // shortest octave from which on the term is within the curve
  };
  // Judges a term of at least this variance. One that is too much only at the shortest m, and beyond them is a
  // good part of the curve, is held back there by a filter and not refuted; but for quantisation, which at
  // every m is what there is at the shortest.
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
