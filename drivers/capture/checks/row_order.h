// SPDX-License-Identifier: Apache-2.0
// Times of rows that have to go on from row to row. Where a count or a clock of known length rolls over, that length is
// added from there on. A row whose time goes back in another way, as where a clock was set back or the network changed
// the order, is left out and counted; where more than one in a hundred does, the file is refused.
#pragma once

#include <cstddef>
#include <string>

#include "drivers/capture/times/row_sink.h"

namespace ifog {

class RowOrder {
 public:
  // time: the column's name, for messages. The path and the notes stay where they are while this is used.
  RowOrder(const std::string& path, std::string time, RowNotes& notes);

  // Leaves the rows whose times do not go back, in s. They may be fewer than before, none included.
  void take(RowBlock& rows);
  // Says what was left out. Throws std::runtime_error with one line where that is too much.
  void finish();

 private:
  // How much longer the clock is that is earlier than before; 0: none rolls over so.
  double rolled_over_s(double now_s, std::size_t line);

  const std::string& path_;
  const std::string time_;
  RowNotes& notes_;
  double offset_s_ = 0.0;  // of rollovers
  double last_s_ = 0.0;    // of the last row, once there is one
  std::size_t rows_ = 0, backward_ = 0;
  std::size_t line_ = 0;  // of the first that goes back, and its time
  std::string first_;
};

}  // namespace ifog
