// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/checks/leaps.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace ifog {
namespace {

constexpr double kSlowest_s = 0.1;     // between samples
constexpr double kStandstill = 0.01;   // of the leap, the most beside it
constexpr std::size_t kEnough = 2001;  // rows that show the sample time

double median_step(const std::vector<double>& time_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < std::min(time_s.size(), kEnough); ++i)
    steps.push_back(time_s[i] - time_s[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace

Leaps::Leaps(std::vector<std::size_t> rates, Next next)
    : rates_(std::move(rates)),
      next_(std::move(next)),
      found_(rates_.size()),
      before_(rates_.size(), kMissing) {}

void Leaps::take(RowBlock& rows) {
  // Few rows do not show the sample time.
  if (!judged_ && held_.size() < kEnough) return held_.append(rows);
  judge(&rows);
  hand_on();
  std::swap(held_, rows);
}

void Leaps::finish() {
  if (held_.size() == 0) return;
  if (rows_before_ + held_.size() >= 3) judge(nullptr);
  hand_on();
  held_ = {};
}

// behind: the rows that follow, null at the end.
void Leaps::judge(const RowBlock* behind) {
  if (!std::exchange(judged_, true)) {
    const double step_s = median_step(held_.time_s);
    half_a_turn_ = step_s > kSlowest_s ? 0.0 : std::numbers::pi / step_s;
  }
  if (half_a_turn_ > 0.0)
    for (std::size_t r = 0; r < rates_.size(); ++r) look_at(r, behind);
}

// All rows but the record's first and last.
void Leaps::look_at(std::size_t r, const RowBlock* behind) {
  std::vector<double>& rate = held_.columns[rates_[r]];
  double before = before_[r];
  const std::size_t judged = rate.size() - (behind != nullptr ? 0 : 1);
  for (std::size_t i = 0; i < judged; ++i) {
    const double here = rate[i];
    if (std::abs(here) > half_a_turn_ && rows_before_ + i > 0) {
      const double after = i + 1 < rate.size() ? rate[i + 1] : behind->columns[rates_[r]].front();
      if (std::max(std::abs(before), std::abs(after)) < kStandstill * std::abs(here)) {
        if (found_[r].count++ == 0) found_[r].first_row = rows_before_ + i;
        rate[i] = kMissing;
      }
    }
    before = here;
  }
  before_[r] = before;
}

void Leaps::hand_on() {
  rows_before_ += held_.size();
  next_(held_);
}

}  // namespace ifog
