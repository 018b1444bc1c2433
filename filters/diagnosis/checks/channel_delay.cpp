// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/channel_delay.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr double kDelayFactor = 2.0;  // ratio between the delays tried, which start at one block
// Required gain of twice the log-likelihood: one in 10^4 by chance after some 30 tries.
constexpr double kCertainlyDelayed = 24.0;

// A lag or an average of the effects delays as well, so that a shorter delay of the channel cannot be told from it.
double own_delay_s(const std::vector<Candidate>& model, std::size_t channel) {
  double longest = 0.0;
  for (const Candidate& each : model) {
    if (!each.uses(channel)) continue;
    const double average = each.form == Form::kBandPower && each.second_time_constant_s <= 0.0
                               ? kPowerAverage_s
                               : each.second_time_constant_s;
    longest = std::max(longest, each.time_constant_s + average);
  }
  return longest;
}

}  // namespace

void undo_delay(const BlockGrid& grid, double delay_s, FineChannel& channel) {
  const double steps = delay_s / grid.fine_s;
  if (steps == 0.0) return;
  const double whole = std::floor(steps);
  const double share = steps - whole;
  const auto moved = [&](std::vector<double>& values) {
    if (values.empty()) return;
    const std::vector<double> before = values;
    for (const BlockRange& record : grid.records) {
      const BlockRange fine = grid.fine_steps(record);
      const auto last = static_cast<std::ptrdiff_t>(fine.end) - 1;
      const auto at = [&](std::ptrdiff_t k) {
        return before[static_cast<std::size_t>(std::clamp(k, static_cast<std::ptrdiff_t>(fine.first), last))];
      };
      for (std::size_t k = fine.first; k < fine.end; ++k) {
        const auto from = static_cast<std::ptrdiff_t>(k) + static_cast<std::ptrdiff_t>(whole);
        values[k] = (1.0 - share) * at(from) + share * at(from + 1);
      }
    }
  };
  moved(channel.values);
  moved(channel.power);
}

std::vector<ChannelDelay> delayed_channels(const BlockData& data, const std::vector<Candidate>& model,
                                           const NoiseShape& shape) {
  std::vector<ChannelDelay> found;
  const BlockGrid& grid = data.grid;
  const double longest = std::min(kMostEarly_s, 0.1 * static_cast<double>(grid.longest()) * grid.block_s);
  for (std::size_t c = 0; c < data.channels.size() && !grid.dwells; ++c) {
    const auto uses = [&](const Candidate& each) { return each.uses(c); };
    if (static_cast<std::ptrdiff_t>(c) == data.reference || std::ranges::none_of(model, uses)) continue;
    // Twice the log-likelihood of the model as a function of the channel's delay.
    BlockData trial = data;
    const auto profile = [&](double delay_s) {
      trial.channels[c] = data.channels[c];
      undo_delay(grid, delay_s, trial.channels[c]);
      return 2.0 * fit_whitened(grid, shape, design(trial, model)).log_likelihood();
    };
    const double none = profile(0.0), own = own_delay_s(model, c);
    double best = 0.0, top = none;
    for (double delay = grid.block_s; delay <= longest; delay *= kDelayFactor)
      for (const double each : {delay, -delay})
        if (const double value = delay > own ? profile(each) : none; value > top) best = each, top = value;
    if (top - none < kCertainlyDelayed) continue;
    constexpr int kBits = 9;  // resolution within the bracket
    std::uintmax_t most = 20;
    const auto [delay, lacking] = boost::math::tools::brent_find_minima(
        [&](double at) { return -profile(at); }, std::min(best / kDelayFactor, best * kDelayFactor),
        std::max(best / kDelayFactor, best * kDelayFactor), kBits, most);
    // The standard deviation of a parabola is where twice the log-likelihood has fallen by one.
    const double step = 0.1 * std::abs(delay), falls = -lacking - profile(delay + step);
    found.push_back({data.channels[c].name, delay, step / std::sqrt(std::max(falls, 1e-6))});
  }
  return found;
}

std::string delay_in_words(const ChannelDelay& delay) {
  return delay.channel +
         formatted(
             " seems logged %.3g s %s (+-%.2g): its effects are sought and corrected as it was logged; "
             "mend it in the logger",
             std::abs(delay.delay_s), delay.delay_s < 0.0 ? "early" : "late", delay.std_error_s);
}

}  // namespace ifog
