// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/checks/row_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr double kLate_s = 2.0;  // a rollover comes within it
constexpr double kYear_s = 365.0 * 86'400.0;

struct Rollover {
  double length_s;
  const char* what;
};
constexpr double kTwo32 = 4294967296.0;
constexpr std::array<Rollover, 5> kRollovers{{{604'800.0, "a GPS week"},
                                              {86'400.0, "a day"},
                                              {kTwo32 * 1e-6, "a count of µs in 32 bits"},
                                              {kTwo32 * 1e-4, "a count of 100 µs in 32 bits"},
                                              {kTwo32 * 1e-3, "a count of ms in 32 bits"}}};

}  // namespace

RowOrder::RowOrder(const std::string& path, std::string time, RowNotes& notes)
    : path_(path), time_(std::move(time)), notes_(notes) {}

double RowOrder::rolled_over_s(double now_s, std::size_t line) {
  const auto found = std::find_if(kRollovers.begin(), kRollovers.end(), [&](const Rollover& each) {
    return now_s + each.length_s > last_s_ && now_s + each.length_s <= last_s_ + kLate_s;
  });
  if (found == kRollovers.end()) return 0.0;
  notes_.notices.push_back(path_ + ":" + std::to_string(line) + ": " + printable(time_) + " rolls over, as " +
                           found->what + " does: " + shortest(found->length_s) +
                           " s are added from there on");
  return found->length_s;
}

void RowOrder::look_for_set_clock() {
  if (set_ || !(last_s_ - before_s_ >= kYear_s)) return;
  set_ = true;
  notes_.notices.push_back(path_ + ":" + std::to_string(line_) + ": its time continues " +
                           std::to_string(std::llround(last_s_ - before_s_)) +
                           " s later, as after a clock was set or where two recordings are joined: treated "
                           "as a hole, behind which times are coarser");
}

void RowOrder::take(RowBlock& rows, std::size_t known) {
  const auto line_of = [&](std::size_t row) { return rows.lines.empty() ? 0 : rows.lines[row]; };
  std::size_t kept = known;
  for (std::size_t i = known; i < rows.size(); ++i) {
    double now_s = rows.time_s[i] + offset_s_;
    const bool back = rows_++ > 0 && now_s < last_s_;
    if (const double longer_s = back ? rolled_over_s(now_s, line_of(i)) : 0.0; longer_s > 0.0) {
      offset_s_ += longer_s;
      now_s += longer_s;
    } else if (back) {
      // Where the row continues those before the last one, the last one is the one that is wrong.
      const bool last_is_late = now_s >= before_s_;
      leave_out(rows, last_is_late ? kept - 1 : i, last_is_late);
      if (!last_is_late) continue;
      --kept;
      last_s_ = before_s_;
    } else {
      look_for_set_clock();
    }
    before_s_ = rows_ > 1 ? last_s_ : before_s_;
    last_s_ = now_s;
    line_ = line_of(i);
    rows.move_row(i, kept);
    rows.time_s[kept++] = now_s;
  }
  rows.keep_first(kept);
}

void RowOrder::leave_out(const RowBlock& rows, std::size_t row, bool late) {
  std::string what;
  if (left_out_.count == 0) {
    what = printable(time_) + " is ";
    append_time(what, rows.origin, rows.time_s[row] - (late ? offset_s_ : 0.0));
    what += late ? " s, expected less than in the next row" : " s, expected more than in the row before";
  }
  left_out_.add(rows.lines.empty() ? 0 : rows.lines[row], std::move(what));
}

void RowOrder::finish() {
  look_for_set_clock();
  const std::size_t count = left_out_.count;
  if (count == 0) return;
  if (rows_ < kRowsAFault * count)
    fail_at(path_, left_out_.line,
            left_out_.first + (count == 1 ? "" : "; so are " + std::to_string(count - 1) + " more rows") +
                "; --sample-rate HZ reads all rows as even");
  notes_.faults.push_back(left_out_.left_out(path_, "row"));
}

}  // namespace ifog
