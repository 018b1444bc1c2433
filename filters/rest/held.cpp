// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/held.h"

#include <algorithm>
#include <span>
#include <utility>

#include "filters/allan/runs.h"

namespace ifog {
namespace {

constexpr std::size_t kLeastHeld = 64, kMostRuns = 4096;

}  // namespace

HeldApart apart_from_held(std::span<const double> rate, const std::vector<Stretch>& parts) {
  const std::size_t least = std::max(kLeastHeld, rate.size() / kMostRuns);
  HeldApart out;
  std::size_t steps = 0, changes = 0;  // outside held stretches
  for (const Stretch& part : parts) {
    Stretch moving{part.begin, part.begin};
    std::size_t values = 0;  // runs in `moving`
    const auto end_moving = [&] {
      if (moving.size() == 0) return;
      out.moving.push_back(moving);
      steps += moving.size() - 1;
      changes += std::exchange(values, 0) - 1;
    };
    for_each_run(rate, {&part, 1}, [&](const Run& run) {
      const std::size_t end = run.begin + run.length;
      if (run.length < least) {
        moving.end = end, ++values;
        return;
      }
      end_moving();
      out.held.push_back({run.begin, end});
      moving = {end, end};
    });
    end_moving();
  }
  if (out.held.empty() || steps < kLeastHeld || 2 * changes < steps) return {{}, parts};
  return out;
}

}  // namespace ifog
