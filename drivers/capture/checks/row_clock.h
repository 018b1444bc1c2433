// SPDX-License-Identifier: Apache-2.0
// The times of rows as loggers write them, on their way to times that increase from row to row:
//   - a row that repeats the one before, time and values, is left out and counted;
//   - rows of one stamp, and rows that come in bursts (several within a packet, packets evenly apart), are
//     spread evenly up to the next stamp.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "drivers/capture/checks/row_order.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {

class RowClock {
 public:
  using Next = std::function<void(RowBlock&)>;

  // time: the column's name, for messages. What is said goes to the notes. The path and the notes stay where
  // they are while this is used.
  RowClock(const std::string& path, std::string time, bool keep_repeats, RowNotes& notes, Next next);

  // Times in s. Rows whose time may still change are buffered until more follow. Throws std::runtime_error with one line.
  void take(RowBlock& rows);
  void finish();

 private:
  void drop_repeats(RowBlock& rows);
  void spread(RowBlock& rows, std::size_t begin, std::size_t end, double next_s);
  void say();

  const std::string& path_;
  const std::string time_;
  const bool keep_repeats_;
  RowNotes& notes_;
  Next next_;
  RowOrder order_;
  RowBlock held_;          // the rows of the last stamp or burst
  double within_s_ = 0.0;  // longest step within a burst; 0: only rows of one stamp are spread
  double period_s_ = 0.0;  // between samples, of the last spread or single row
  double bursts_s_ = 0.0;  // time that bursts took, and their rows
  std::size_t burst_rows_ = 0, spread_ = 0, repeated_ = 0;
  bool begun_ = false;
};

}  // namespace ifog
