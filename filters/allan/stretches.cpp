// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/stretches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "filters/allan/scattered_stamps.h"
#include "filters/distributions/median.h"

namespace ifog {
namespace {

constexpr double kGap = 1.5;  // in periods
constexpr std::size_t kBesideGap = 2;

// A few time steps with the stamps around them.
class Steps {
 public:
  Steps(std::span<const double> time_s, std::size_t first, std::size_t samples)
      : time_s_(time_s), first_(first), samples_(samples) {}

  // Step from sample i to i + 1.
  [[nodiscard]] double step(std::size_t i) const { return at(i + 1) - at(i); }
  // A late stamp followed by an early one is jitter; after a gap all stamps stay late. The second sample on
  // either side decides, so one bad stamp has no effect.
  [[nodiscard]] bool is_gap(std::size_t i, double period) const {
    if (step(i) <= kGap * period) return false;
    const std::size_t low = i >= kBesideGap ? i - kBesideGap : 0;
    const std::size_t high = std::min(i + 1 + kBesideGap, samples_ - 1);
    const double across = (at(high) - at(low)) / period;
    return across - static_cast<double>(high - low) > kGap - 1.0;
  }

 private:
  [[nodiscard]] double at(std::size_t i) const { return time_s_[i - first_]; }

  std::span<const double> time_s_;
  std::size_t first_, samples_;
};

// Calls use(steps, i) for every step i in order.
template <typename Use>
void for_each_step(const SeriesView& time_s, Use use) {
  const std::size_t samples = time_s.size();
  std::vector<double> room;
  for (std::size_t begin = 0; begin + 1 < samples; begin += kSeriesPiece) {
    const std::size_t end = std::min(begin + kSeriesPiece, samples - 1);
    const std::size_t low = begin - std::min(begin, kBesideGap);
    const std::size_t high = std::min(end + 1 + kBesideGap, samples);
    const Steps steps(time_s.piece(low, high - low, room), low, samples);
    for (std::size_t i = begin; i < end; ++i) use(steps, i);
  }
}

// Calls found(i, lost, step) for each gap after sample i. Returns the stamps' mean squared distance if they
// scatter.
template <typename Found>
double for_each_hole(const SeriesView& time_s, double period, bool scatters, Found found) {
  if (scatters) return holes_of_scattered(time_s, period, found);
  for_each_step(time_s, [&](const Steps& steps, std::size_t i) {
    if (!steps.is_gap(i, period)) return;
    const double step = steps.step(i);
    found(i, static_cast<std::size_t>(std::max(0.0, std::round(step / period) - 1.0)), step);
  });
  return 0.0;
}

struct Period {
  double period_s = 0.0;  // mean of the steps without gaps
  std::size_t gaps = 0;
  double squares = 0.0;  // as returned by for_each_hole
};

// Mean period without the gaps found with this period. With scattering stamps a short gap counts as its
// number of steps, because its length is less accurate.
Period mean_period(const SeriesView& time_s, double period_s, bool scatters) {
  constexpr std::size_t kShort = 8;
  const std::size_t count = time_s.size() - 1;
  double between_s = time_s.at(count) - time_s.at(0);
  double steps = static_cast<double>(count);
  Period out;
  out.squares = for_each_hole(time_s, period_s, scatters, [&](std::size_t, std::size_t lost, double step_s) {
    ++out.gaps;
    if (scatters && lost <= kShort) {
      steps += static_cast<double>(lost);
      return;
    }
    between_s -= step_s;
    steps -= 1.0;
  });
  if (out.gaps == count) throw std::invalid_argument("no two samples are one sample time apart");
  out.period_s = between_s / steps;
  return out;
}

// Shortest and longest step; if the longest is no gap, there is none.
struct Extremes {
  double least_s = std::numeric_limits<double>::infinity(), most_s = -least_s;

  [[nodiscard]] bool gapless(double period_s) const { return most_s <= kGap * period_s; }
  // Largest distance of a step from the period.
  [[nodiscard]] double jitter_s(double period_s) const {
    return std::max(std::abs(least_s - period_s), std::abs(most_s - period_s));
  }
};

Extremes extremes_of(const SeriesView& time_s) {
  Extremes found;
  std::vector<double> room;
  const std::size_t samples = time_s.size();
  for (std::size_t begin = 0; begin + 1 < samples; begin += kSeriesPiece) {
    const std::span<const double> some =
        time_s.piece(begin, std::min(kSeriesPiece + 1, samples - begin), room);
    constexpr std::size_t kLanes = 4;  // for instruction-level parallelism
    std::array<double, kLanes> least, most;
    least.fill(found.least_s);
    most.fill(found.most_s);
    for (std::size_t i = 0; i + 1 < some.size(); ++i) {
      const double step = some[i + 1] - some[i];
      least[i % kLanes] = step < least[i % kLanes] ? step : least[i % kLanes];
      most[i % kLanes] = step > most[i % kLanes] ? step : most[i % kLanes];
    }
    found.least_s = *std::min_element(least.begin(), least.end());
    found.most_s = *std::max_element(most.begin(), most.end());
  }
  return found;
}

// Every `stride`-th step.
std::vector<double> some_steps(const SeriesView& time_s, std::size_t stride) {
  std::vector<double> some, room;
  some.reserve((time_s.size() - 1) / stride + 1);
  for (std::size_t i = 0; i + 1 < time_s.size(); i += stride) {
    const std::span<const double> two = time_s.piece(i, 2, room);
    some.push_back(two[1] - two[0]);
  }
  return some;
}

// Period of scattering stamps. near_s: from the single steps.
double scattered_period(const SeriesView& time_s, double near_s) {
  Period out{.period_s = near_s};
  for (int round = 0; round < 3; ++round) out = mean_period(time_s, out.period_s, true);
  // The mean of all steps is the period if no sample is missing. It is rejected if a clock with few gaps fits
  // much better, or if stamps would be off by more than half a period, as in bursts.
  constexpr double kHalfEitherWay = 0.1;  // of a uniform error; 1/12 plus the clock's error
  const std::size_t count = time_s.size() - 1;
  const double all_s = (time_s.at(count) - time_s.at(0)) / static_cast<double>(count);
  const Period all = mean_period(time_s, all_s, true);
  const bool even = all.gaps == 0 && all.squares < kHalfEitherWay &&
                    (4 * out.gaps > count || all.squares < 2.0 * out.squares);
  return even ? all_s : out.period_s;
}

// Period of an even clock with stamps rounded to ticks of more than half a period (single precision far from
// 0). Its steps of one and two ticks would look like gaps. A stamp is never more than one tick from such a
// clock. 0: the stamps are not of this kind.
double even_period(const SeriesView& time_s, double tick_s) {
  constexpr double kFewest = 16.0, kRounding = 1.0 + 1e-6;
  const auto count = static_cast<double>(time_s.size() - 1);
  const double first_s = time_s.at(0), period_s = (time_s.at(time_s.size() - 1) - first_s) / count;
  const double of_two = (period_s / tick_s - 1.0) * count;
  if (of_two < kFewest || count - of_two < kFewest) return 0.0;
  std::vector<double> room;
  for (std::size_t begin = 0; begin < time_s.size(); begin += kSeriesPiece) {
    const std::size_t piece = std::min(kSeriesPiece, time_s.size() - begin);
    double even = static_cast<double>(begin);
    for (const double time : time_s.piece(begin, piece, room))
      if (std::abs(time - first_s - period_s * even++) > kRounding * tick_s) return 0.0;
  }
  return period_s;
}

}  // namespace

SampleClock sample_clock(const SeriesView& time_s) {
  if (time_s.size() < 2) throw std::invalid_argument("a sample time needs two samples");
  const std::size_t count = time_s.size() - 1;
  // Some 100,000 steps suffice for the median.
  std::vector<double> some = some_steps(time_s, count / 100'000 + 1);
  const Extremes steps = extremes_of(time_s);
  double period = median(some);
  if (!(period > 0.0)) throw std::invalid_argument("time does not increase");

  SampleClock clock;
  if (const double even_s = even_period(time_s, period); even_s > 0.0) {
    clock.scatter = period / (std::sqrt(12.0) * even_s);  // of the rounding error
    period = even_s;
  } else {
    // The median of coarse stamps is one tick too short or too long; a second round with the mean corrects
    // it.
    for (int round = 0; round < 2; ++round)
      period = steps.gapless(period) ? (time_s.at(count) - time_s.at(0)) / static_cast<double>(count)
                                     : mean_period(time_s, period, false).period_s;
    for (double& step : some) step = std::abs(step - period);
    clock.scatter = 1.4826 * median(some) / (std::numbers::sqrt2 * period);  // of Gaussian scatter
    if (clock.scatters()) period = scattered_period(time_s, period);
  }
  clock.period_s = period;
  if (!clock.scatters() && steps.gapless(period)) {
    clock.worst_jitter_s = steps.jitter_s(period);
    return clock;
  }

  const std::vector<Hole> gaps = holes(time_s, clock);
  clock.gaps = gaps.size();
  if (!gaps.empty()) clock.first_gap = gaps.front().after;
  for (const Hole& gap : gaps) clock.missing += gap.lost;
  auto gap = gaps.begin();
  for_each_step(time_s, [&](const Steps& all, std::size_t i) {
    if (gap != gaps.end() && gap->after == i)
      ++gap;
    else
      clock.worst_jitter_s = std::max(clock.worst_jitter_s, std::abs(all.step(i) - period));
  });
  return clock;
}

std::vector<Hole> holes(const SeriesView& time_s, const SampleClock& clock) {
  std::vector<Hole> out;
  for_each_hole(time_s, clock.period_s, clock.scatters(), [&](std::size_t i, std::size_t lost, double) {
    out.push_back({i, lost});
  });
  return out;
}

std::vector<Stretch> stretches(const SeriesView& time_s, const SeriesView& rate_radps,
                               const SampleClock& clock) {
  const std::vector<Hole> gaps = holes(time_s, clock);
  std::vector<Stretch> found;
  Stretch now;
  const auto close = [&](std::size_t next) {
    if (now.size() > 0) found.push_back(now);
    now = {next, next};
  };
  auto gap = gaps.begin();
  for_each_piece(rate_radps, 0, rate_radps.size(), [&](std::span<const double> rate, std::size_t first) {
    for (std::size_t k = 0; k < rate.size(); ++k) {
      const std::size_t i = first + k;
      const bool last = gap != gaps.end() && gap->after == i;
      if (last) ++gap;
      if (std::isnan(rate[k])) {
        close(i + 1);
        continue;
      }
      now.end = i + 1;
      if (last) close(i + 1);
    }
  });
  close(rate_radps.size());
  return found;
}

}  // namespace ifog
