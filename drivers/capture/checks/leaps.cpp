// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/checks/leaps.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace ifog {
namespace {

constexpr double kSlowest_s = 0.101;  // between samples: 10 Hz, however its times are rounded
constexpr double kStandstill = 0.01;  // of the leap, at most, in the rows next to it

}  // namespace

Leaps::Leaps(std::vector<std::size_t> rates, Next next)
    : rates_(std::move(rates)),
      next_(std::move(next)),
      found_(rates_.size()),
      before_(rates_.size(), kMissing) {}

void Leaps::take(RowBlock& rows) {
  if (held_.size() > 0) hand_on(&rows);
  std::swap(held_, rows);
}

void Leaps::finish() {
  if (held_.size() > 0) hand_on(nullptr);
  held_ = {};
}

// behind: the rows that follow, null at the end.
void Leaps::hand_on(const RowBlock* behind) {
  for (std::size_t r = 0; r < rates_.size(); ++r) look_at(r, behind);
  rows_before_ += held_.size();
  before_s_ = held_.time_s.back();
  next_(held_);
}

// All rows but the record's first and last, by the shorter of the steps to the rows next to it.
void Leaps::look_at(std::size_t r, const RowBlock* behind) {
  std::vector<double>& rate = held_.columns[rates_[r]];
  const std::vector<double>& time_s = held_.time_s;
  double before = before_[r];
  for (std::size_t i = 0; i < rate.size(); ++i) {
    const double here = std::abs(rate[i]), was = std::exchange(before, rate[i]);
    if (!(here * kSlowest_s > std::numbers::pi) || rows_before_ + i == 0) continue;
    const bool last = i + 1 == rate.size();
    if (last && behind == nullptr) continue;
    const double after = last ? behind->columns[rates_[r]].front() : rate[i + 1];
    const double step_s = std::min(time_s[i] - (i == 0 ? before_s_ : time_s[i - 1]),
                                   (last ? behind->time_s.front() : time_s[i + 1]) - time_s[i]);
    if (step_s > kSlowest_s || here * step_s <= std::numbers::pi ||
        !(std::max(std::abs(was), std::abs(after)) < kStandstill * here))
      continue;
    if (found_[r].count++ == 0) found_[r].first_row = rows_before_ + i;
    rate[i] = kMissing;
  }
  before_[r] = before;
}

}  // namespace ifog
