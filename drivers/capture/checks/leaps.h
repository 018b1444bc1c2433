// SPDX-License-Identifier: Apache-2.0
// Rates at an even clock that say more than half a turn within one sample, from standstill to standstill: no
// sensor turned like that, so they are missing from here on. Slower than ten samples a second nothing is, for
// a table of dwells may well do so.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "drivers/capture/times/row_sink.h"

namespace ifog {

// Blocks go through it and come out one late, because a leap is known by the row behind it: what is held goes
// on, and the next is held in its place, without a copy.
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
  void judge(const RowBlock* behind);
  void look_at(std::size_t rate, const RowBlock* behind);
  void hand_on();

  std::vector<std::size_t> rates_;
  Next next_;
  std::vector<Found> found_;
  RowBlock held_;
  std::vector<double> before_;  // of each rate, the value in the row before held_, as it was
  std::size_t rows_before_ = 0;
  bool judged_ = false;
  double half_a_turn_ = 0.0;  // rad/s; 0: too slow to say
};

}  // namespace ifog
