// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/stuck_blocks.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "filters/model_file/channel_names.h"

namespace ifog {
namespace {

constexpr double kMostStuck = 0.25;

bool is_made_of(const std::string& channel, const std::string& column) {
  const auto [of, less] = names_in(channel);
  return of == column || less == column;
}

bool leave_out(const StuckStretch& stretch, BlockGrid& grid) {
  const BlockRange& record = grid.records[stretch.record];
  const double half_s = 0.5 * grid.block_s;
  bool any = false;
  for (std::size_t b = record.first; b < record.end; ++b) {
    if (grid.time_s[b] + half_s <= stretch.from_s || grid.time_s[b] - half_s >= stretch.to_s) continue;
    any = any || grid.valid[b];
    grid.valid[b] = 0;
    grid.error[static_cast<Eigen::Index>(b)] = 0.0;
  }
  return any;
}

}  // namespace

std::vector<std::string> leave_out_stuck(const std::vector<StuckStretch>& stuck,
                                         const std::vector<std::string>& channels, BlockGrid& grid) {
  std::vector<std::string> said;
  if (grid.dwells) return said;
  for (const StuckStretch& stretch : stuck) {
    const double length_s = stretch.to_s - stretch.from_s;
    const bool used = std::any_of(channels.begin(), channels.end(), [&](const std::string& channel) {
      return is_made_of(channel, stretch.channel);
    });
    const auto blocks = static_cast<double>(grid.records[stretch.record].size());
    if (!used || length_s > kMostStuck * blocks * grid.block_s || !leave_out(stretch, grid)) continue;
    std::array<char, 32> length{};
    std::snprintf(length.data(), length.size(), "%.4g s", length_s);
    said.push_back("what " + stretch.channel +
                   " was while it was stuck is not known: effects were fitted without these " +
                   length.data());
  }
  return said;
}

}  // namespace ifog
