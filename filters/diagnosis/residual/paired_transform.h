// SPDX-License-Identifier: Apache-2.0
// The Fourier transform of a series that is longer than memory is for: made of many short ones, after Bailey,
// "FFTs in external or hierarchical memory", J. Supercomputing 4, 1990.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "filters/diagnosis/residual/blocked_table.h"
#include "filters/series/samples.h"

namespace ifog {

class UnitRoots;

// Samples two by two as complex numbers, in rows one behind the other: their transform is made of those of
// the columns and of the rows, and stands with bin k1 + rows k2 in row k1, column k2. All of it is in files
// that are read and written in long pieces and not looked at as memory, for to find a missing page of a file
// takes longer than to transform what is in it.
class PairedTransform {
 public:
  using Complex = std::complex<double>;

  // error: of even length; NaN counts as the mean. Throws std::runtime_error: no room for the files.
  PairedTransform(std::span<const double> error, double mean);

  // |X_k|^2 of the samples as they are, k from 0 to half their number.
  [[nodiscard]] Samples power() const;

 private:
  // Some transformed rows, from `first` on.
  struct Rows {
    std::size_t first = 0, count = 0;
    std::vector<Complex> values, piece;
  };
  using Powers = BlockedTable<double>;

  void lay_out(std::span<const double> error, double mean);
  void transform_columns();
  void transform_columns(std::size_t block, const UnitRoots& roots, std::vector<Complex>& columns) const;
  void load(std::size_t first, std::size_t count, Rows& rows) const;
  void put_power(const Rows& rows, const Rows& partners, const UnitRoots& roots, std::size_t block,
                 Powers& powers) const;
  [[nodiscard]] Powers power_by_row() const;

  std::size_t size_, rows_, columns_;
  BlockedTable<Complex> values_;
};

}  // namespace ifog
