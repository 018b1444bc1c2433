// SPDX-License-Identifier: Apache-2.0
// Times of rows that have to go on from row to row. Where a count or a clock of known length rolls over, that length is
// added from there on. A row whose time goes back in another way, as where a clock was set back or the network changed
// the order, is left out and counted, and so is one whose own time is too late; where more than one in a hundred is, the
// file is refused. A year between two rows is a clock that was set, and said.
#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "drivers/capture/times/row_sink.h"

namespace ifog {

class RowOrder {
 public:
  // time: the column's name, for messages. The path and the notes stay where they are while this is used.
  RowOrder(const std::string& path, std::string time, RowNotes& notes);

  // Leaves the rows whose times, in s, do not go back. They may be fewer than before. known: the rows at the
  // beginning that it has left before, the last of all included, which a row behind it may show to be wrong.
  void take(RowBlock& rows, std::size_t known);
  // Says what was left out. Throws std::runtime_error with one line where that is too much.
  void finish();

 private:
  // How much longer the clock is that is earlier than before; 0: none rolls over so.
  double rolled_over_s(double now_s, std::size_t line);
  // late: of the row, else it goes back.
  void leave_out(const RowBlock& rows, std::size_t row, bool late);
  // Says where the last row is from another time than the one before.
  void look_for_set_clock();

  const std::string& path_;
  const std::string time_;
  RowNotes& notes_;
  double offset_s_ = 0.0;  // of rollovers
  // Of the last row and of the one before it, once there are such.
  double last_s_ = 0.0, before_s_ = std::numeric_limits<double>::infinity();
  std::size_t rows_ = 0, line_ = 0;  // line_: of the last row
  Fault left_out_;
  bool set_ = false;  // a clock that was set is said
};

}  // namespace ifog
