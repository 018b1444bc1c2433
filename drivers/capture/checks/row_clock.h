// SPDX-License-Identifier: Apache-2.0
// The times of rows as loggers write them, on their way to times that increase from row to row:
//   - where a count or a clock of known length rolls over, that length is added from there on;
//   - a row whose time goes back in another way, as where a clock was set back or the network changed the
//     order, is dropped and counted, and so is one whose own time is too late; where more than one in a hundred
//     is, the file is refused. A year between two rows is a clock that was set, and reported;
//   - a row that repeats the one before, time and values, is dropped and counted;
//   - rows of one stamp, and rows that come in bursts (several within a packet, packets evenly apart), are
//     spread evenly up to the next stamp.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>

#include "drivers/capture/times/row_sink.h"

namespace ifog {

// time: the column's name, for messages. What is said goes to the notes. The path and the notes stay where they
// are while these are used.
class RowOrder {
 public:
  RowOrder(const std::string& path, std::string time, RowNotes& notes);

  // Leaves the rows whose times, in s, do not go back. They may be fewer than before. known: the rows at the
  // beginning that it has left before, the last of all included, which a row behind it may show to be wrong.
  void take(RowBlock& rows, std::size_t known);
  // Says what was dropped. Throws std::runtime_error with one line where that is too much.
  void finish();

 private:
  // How much longer the clock is that is earlier than before; 0: none rolls over so.
  double rolled_over_s(double now_s, std::size_t line);
  // late: the row's own time is, else it goes back.
  void drop(const RowBlock& rows, std::size_t row, bool late);
  // Says where the last row is from another time than the one before.
  void look_for_set_clock();

  const std::string& path_;
  const std::string time_;
  RowNotes& notes_;
  double offset_s_ = 0.0;  // of rollovers
  // Of the last row and of the one before it, once there are such.
  double last_s_ = 0.0, before_s_ = std::numeric_limits<double>::infinity();
  std::size_t rows_ = 0, line_ = 0;  // line_: of the last row
  Fault dropped_;
  bool set_ = false;  // a clock that was set is said
};

class RowClock {
 public:
  using Next = std::function<void(RowBlock&)>;

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
  RowBlock buffered_;      // the rows of the last stamp or burst
  double within_s_ = 0.0;  // longest step within a burst; 0: only rows of one stamp are spread
  double period_s_ = 0.0;  // between samples, of the last spread or single row
  double bursts_s_ = 0.0;  // time that bursts took, and their rows
  std::size_t burst_rows_ = 0, spread_ = 0, repeated_ = 0;
  bool begun_ = false;
};

}  // namespace ifog
