// SPDX-License-Identifier: Apache-2.0
// Converts the times of logged rows to times that increase from row to row:
//   - a rollover of a counter or clock of known length adds that length;
//   - times that begin again, or go back for more rows than could be dropped, are of a second recording in the file or of a
//   clock that was set, behind a hole;
//   - a row whose time goes back otherwise (clock set back, network reordering) or is too late is dropped and
//   counted; the file is rejected if these exceed 1 %. A step of a year is a set clock, and reported;
//   - a row that repeats every cell of the one before, apart from other clocks and counters, is dropped and counted, unless
//   chance explains it;
//   - rows with one stamp, or in bursts (several per packet, packets at even times), are spread evenly up to
//   the next stamp; of bursts that are late by various times, and of stamps whose tick is the sample period, some 128 rows
//   together, but not across a hole.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "drivers/capture/times/row_sink.h"

namespace ifog {

class RowOrder {
 public:
  // time: name of the column, for messages. Both must outlive this object.
  RowOrder(const std::string& time, RowNotes& notes) : time_(time), notes_(notes) {}

  // Keeps rows whose times, in s, do not decrease. The last of them, which may still prove wrong, is buffered, and so
  // are rows behind it that go back, until the last call.
  void take(RowBlock& rows, bool is_last);
  // Reports dropped rows. Throws std::runtime_error with one line if there are too many.
  void finish();

 private:
  // Length of the rollover that explains the decrease; 0: none.
  double rolled_over_s(double now_s, std::size_t line);
  [[nodiscard]] std::size_t enough(double now_s) const;
  bool settle_back(const RowBlock& rows, std::size_t& row, bool is_last);
  void tell_joined(std::size_t line, const std::string& how);
  // late: the row's own time is wrong; else it goes back.
  void drop(const RowBlock& rows, std::size_t row, bool late);

  const std::string& time_;
  RowNotes& notes_;
  double offset_s_ = 0.0;  // sum of rollovers
  // Times of the first row of the present recording, of the last row and the one before, if any.
  double first_s_ = 0.0, last_s_ = 0.0, before_s_ = std::numeric_limits<double>::infinity();
  std::size_t rows_ = 0, line_ = 0;  // line_: of the last row
  std::size_t falling_ = 0;          // times back that decrease
  std::size_t joined_ = 0;           // recordings in the file, except the first
  RowBlock buffered_;
  Fault dropped_;
  bool set_ = false;  // a set clock was reported
};

struct Bursts {
  double within_s = 0.0;  // longest step within a burst; 0: only equal stamps are spread
  std::size_t rows = 1;   // least number that is spread together
  double hole_s = std::numeric_limits<double>::infinity();  // steps that are not spread
};

class RowClock {
 public:
  using Next = std::function<void(RowBlock&)>;

  RowClock(const std::string& time, bool keep_repeats, RowNotes& notes, Next next);

  // Takes rows with times in s; rows whose time may still change are buffered. Throws std::runtime_error with
  // one line.
  void take(RowBlock& rows);
  void finish();

 private:
  using Row = std::pair<double, std::size_t>;  // time and cells
  void drop_repeats(RowBlock& rows);
  void spread_bursts(RowBlock& rows);
  // End of the burst that starts at `begin`; the number of rows if more of it may follow.
  [[nodiscard]] std::size_t end_of_burst(const RowBlock& rows, std::size_t begin) const;
  void spread(RowBlock& rows, std::size_t begin, std::size_t end, double next_s);
  void say();

  const std::string time_;
  bool keep_repeats_;
  RowNotes& notes_;
  Next next_;
  RowOrder order_;
  RowBlock buffered_;  // rows of the last stamp or burst
  Bursts bursts_;
  double period_s_ = 0.0;  // sample period of the last burst or single row
  std::size_t spread_ = 0, repeated_ = 0;
  bool begun_ = false;
  Row last_{kMissing, 0};  // before order_
};

}  // namespace ifog
