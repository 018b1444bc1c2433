// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/table_turns.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "filters/diagnosis/record/even_grid.h"

namespace ifog {
namespace {

constexpr double kThere = 0.9;         // of a turn's values, once short gaps are bridged
constexpr std::size_t kShortGap = 20;  // steps
constexpr double kLittle = 0.5;        // that cosine or sine may change over one

// A reading that is missing costs an autoregression its order in rows: short gaps, over which a turn's swing
// is nearly straight, are bridged.
void bridge_short_gaps(Samples& turn) {
  for (std::size_t i = 1; i < turn.size(); ++i) {
    if (std::isfinite(turn[i]) || !std::isfinite(turn[i - 1])) continue;
    std::size_t end = i + 1;
    while (end < turn.size() && !std::isfinite(turn[end])) ++end;
    if (end == turn.size()) return;
    const double from = turn[i - 1], change = turn[end] - from;
    if (end - i > kShortGap || std::abs(change) > kLittle) continue;
    for (std::size_t k = i; k < end; ++k)
      turn[k] = from + change * static_cast<double>(k + 1 - i) / static_cast<double>(end + 1 - i);
  }
}

bool is_there(const Samples& turn) {
  const auto there =
      std::count_if(turn.begin(), turn.end(), [](double value) { return std::isfinite(value); });
  return static_cast<double>(there) >= kThere * static_cast<double>(turn.size());
}

}  // namespace

std::vector<Samples> turns_of(const Record& record, double period_s) {
  std::vector<Samples> turns;
  for (const RecordChannel& channel : record.channels) {
    if (!(channel.period > 0.0)) continue;
    for (const double phase : {0.0, 0.5 * std::numbers::pi}) {
      Samples turn(channel.values.size());
      for (std::size_t i = 0; i < turn.size(); ++i)
        turn[i] = std::cos(2.0 * std::numbers::pi / channel.period * channel.values[i] - phase);
      Samples even = on_even_grid(record, period_s, turn);
      bridge_short_gaps(even);
      if (is_there(even)) turns.push_back(std::move(even));
    }
  }
  return turns;
}

}  // namespace ifog
