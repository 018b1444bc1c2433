// SPDX-License-Identifier: Apache-2.0
// Rates that say more than half a turn within one sample, from standstill to standstill: no sensor turned like
// that, so they are missing from here on. Slower than ten samples a second nothing is judged, because a table
// of dwells may well turn so far from row to row.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "drivers/capture/times/row_sink.h"

namespace ifog {

// Blocks leave one late, because a leap is known by the row behind it.
class Leaps {
 public:
  struct Found {
    std::size_t count = 0, first_row = 0;
  };
  using Next = std::function<void(RowBlock&)>;

  // rates: which columns are looked at.
  Leaps(std::vector<std::size_t> rates, Next next);

  // rows: another block behind it, whatever is in that.
  void take(RowBlock& rows);
  void finish();
  // By entry of `rates`; of the whole record after finish().
  [[nodiscard]] const std::vector<Found>& found() const { return found_; }

 private:
  void hand_on(const RowBlock* behind);
  void look_at(std::size_t rate, const RowBlock* behind);

  std::vector<std::size_t> rates_;
  Next next_;
  std::vector<Found> found_;
  RowBlock held_;
  std::vector<double> before_;  // of each rate, the value in the row before held_, as it was
  double before_s_ = 0.0;       // the time of that row
  std::size_t rows_before_ = 0;
};

}  // namespace ifog
