// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/stretches.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ifog {
namespace {

constexpr double kGap = 1.5;  // in periods

// A late stamp followed by an early one is jitter; a gap leaves all that follows late. The step is judged by
// the mean of the two samples on either side, which halves what one bad stamp can do.
bool is_gap(std::span<const double> time_s, std::size_t i, double period) {
  const double step = time_s[i + 1] - time_s[i];
  if (step <= kGap * period) return false;
  const std::size_t low = i >= 2 ? i - 2 : 0;
  const std::size_t high = std::min(i + 3, time_s.size() - 1);
  const double across = (time_s[high] - time_s[low]) / period;
  return across - static_cast<double>(high - low) > kGap - 1.0;
}

}  // namespace

SampleClock sample_clock(std::span<const double> time_s) {
  if (time_s.size() < 2) throw std::invalid_argument("a sample time needs two samples");
  const std::size_t steps = time_s.size() - 1;
  // The median of a hundred thousand steps is as good as that of all and needs no copy of the record.
  std::vector<double> some;
  const std::size_t stride = steps / 100'000 + 1;
  some.reserve(steps / stride + 1);
  for (std::size_t i = 0; i < steps; i += stride) some.push_back(time_s[i + 1] - time_s[i]);
  std::nth_element(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(some.size() / 2), some.end());
  double period = some[some.size() / 2];
  if (!(period > 0.0)) throw std::invalid_argument("time does not increase");

  SampleClock clock;
  // Coarse stamps make the median one tick too short or too long; a second round with the mean settles it.
  for (int round = 0; round < 2; ++round) {
    clock = {};
    double gaps_s = 0.0;
    for (std::size_t i = 0; i < steps; ++i) {
      if (!is_gap(time_s, i, period)) continue;
      if (clock.gaps++ == 0) clock.first_gap = i;
      gaps_s += time_s[i + 1] - time_s[i];
    }
    if (clock.gaps == steps) throw std::invalid_argument("no two samples are one sample time apart");
    period = (time_s.back() - time_s.front() - gaps_s) / static_cast<double>(steps - clock.gaps);
  }
  clock.period_s = period;
  for (std::size_t i = 0; i < steps; ++i) {
    const double step = time_s[i + 1] - time_s[i];
    if (is_gap(time_s, i, period))
      clock.missing += static_cast<std::size_t>(std::max(0.0, std::round(step / period) - 1.0));
    else
      clock.worst_jitter_s = std::max(clock.worst_jitter_s, std::abs(step - period));
  }
  return clock;
}

std::vector<Stretch> stretches(std::span<const double> time_s, std::span<const double> rate_radps,
                               const SampleClock& clock) {
  std::vector<Stretch> found;
  Stretch now;
  const auto close = [&](std::size_t next) {
    if (now.size() > 0) found.push_back(now);
    now = {next, next};
  };
  for (std::size_t i = 0; i < rate_radps.size(); ++i) {
    if (std::isnan(rate_radps[i])) {
      close(i + 1);
      continue;
    }
    now.end = i + 1;
    if (!time_s.empty() && i + 1 < time_s.size() && is_gap(time_s, i, clock.period_s)) close(i + 1);
  }
  close(rate_radps.size());
  return found;
}

}  // namespace ifog
