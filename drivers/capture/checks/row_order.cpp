// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/checks/row_order.h"

#include <algorithm>
#include <array>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr double kLate_s = 2.0;  // a rollover comes within it
constexpr std::size_t kRowsABackwardOne = 100;

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

void RowOrder::take(RowBlock& rows) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double own_s = rows.time_s[i];
    const std::size_t line = rows.lines.empty() ? 0 : rows.lines[i];
    const bool first = rows_++ == 0;
    if (!first && own_s + offset_s_ < last_s_) offset_s_ += rolled_over_s(own_s + offset_s_, line);
    if (!first && own_s + offset_s_ < last_s_) {
      if (backward_++ > 0) continue;
      line_ = line;
      append_time(first_, rows.origin, own_s);
      continue;
    }
    last_s_ = own_s + offset_s_;
    rows.move_row(i, kept);
    rows.time_s[kept++] = last_s_;
  }
  rows.keep_first(kept);
}

void RowOrder::finish() {
  if (backward_ == 0) return;
  const std::string what = printable(time_) + " is " + first_ + " s, expected more than in the row before";
  if (rows_ < kRowsABackwardOne * backward_)
    fail_at(path_, line_,
            what + (backward_ == 1 ? "" : "; so are " + std::to_string(backward_ - 1) + " more rows") +
                "; --sample-rate HZ reads all rows as even");
  notes_.faults.push_back(path_ + ":" + std::to_string(line_) + ": " + what + "; " +
                          (backward_ == 1 ? "this row is" : std::to_string(backward_) + " such rows are") +
                          " left out");
}

}  // namespace ifog
