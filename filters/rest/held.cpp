// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/held.h"

#include <algorithm>

namespace ifog {
namespace {

constexpr std::size_t kLeastHeld = 64, kMostRuns = 4096;

}  // namespace

HeldApart apart_from_held(const SeriesView& rate, const std::vector<Stretch>& parts) {
  const std::size_t least = std::max(kLeastHeld, rate.size() / kMostRuns);
  HeldApart out;
  std::size_t steps = 0, changes = 0;  // where it moves
  for (const Stretch& part : parts) {
    std::size_t begin = part.begin, moving = part.begin, here = 0;
    const auto move_until = [&](std::size_t end, std::size_t changed) {
      if (end == moving) return;
      out.moving.push_back({moving, end});
      steps += end - moving - 1;
      changes += changed;
    };
    // The value that it has had from `begin` on ends.
    const auto close = [&](std::size_t end) {
      if (end - begin < least) return false;
      out.held.push_back({begin, end});
      move_until(begin, here - std::min<std::size_t>(here, 1));
      moving = end;
      here = 0;
      return true;
    };
    double last = 0.0;
    for_each_piece(rate, part.begin, part.end, [&](std::span<const double> values, std::size_t first) {
      for (std::size_t k = 0; k < values.size(); ++k) {
        const std::size_t i = first + k;
        if (i > part.begin && values[k] != last) {
          here += close(i) ? 0 : 1;
          begin = i;
        }
        last = values[k];
      }
    });
    if (!close(part.end)) move_until(part.end, here);
  }
  if (out.held.empty() || steps < kLeastHeld || 2 * changes < steps) return {{}, parts};
  return out;
}

}  // namespace ifog
