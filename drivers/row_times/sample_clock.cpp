// SPDX-License-Identifier: Apache-2.0
#include "drivers/row_times/sample_clock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <stdexcept>
#include <vector>

#include "drivers/row_times/median.h"

namespace ifog {
namespace {

constexpr double kGap = 1.5;  // in periods
constexpr std::size_t kBesideGap = 2;

// Step from sample i to i + 1.
double step_after(std::span<const double> time_s, std::size_t i) { return time_s[i + 1] - time_s[i]; }

// A late stamp followed by an early one is jitter; after a gap all stamps stay late. The second sample on
// either side decides, so one bad stamp has no effect.
bool is_gap(std::span<const double> time_s, std::size_t i, double period) {
  if (step_after(time_s, i) <= kGap * period) return false;
  const std::size_t low = i >= kBesideGap ? i - kBesideGap : 0;
  const std::size_t high = std::min(i + 1 + kBesideGap, time_s.size() - 1);
  const double across = (time_s[high] - time_s[low]) / period;
  return across - static_cast<double>(high - low) > kGap - 1.0;
}

constexpr std::size_t kNext = 7;       // stamps whose median confirms a gap
constexpr std::size_t kReturn = 1024;  // stamps in which a delay returns: 10 s at 100 Hz, of a stalled host
constexpr std::size_t kSettle = 128;   // stamps that give the initial phase
constexpr double kHalf = 0.5;          // of a period
// Second-order tracker, critically damped. It settles within 100 samples; stamps off by up to half a period
// move it by 1/25 period.
constexpr double kPhaseGain = 1.0 / 32.0, kRateGain = kPhaseGain * kPhaseGain / 4.0;
// After a silence of this many periods the device may have restarted with any phase.
constexpr std::size_t kSilence = 8;
constexpr double kMostLost = 1e15;

// Follows stamps that scatter and numbers each sample: lateness of a stamp in periods, given the numbers so far.
class TrackingClock {
 public:
  explicit TrackingClock(double period_s) : period_s_(period_s) {}

  // Initial phase from the median lateness. times: the first stamp, or the first one after a silence, and
  // those that follow it.
  void begin(std::span<const double> times) {
    TrackingClock trial(period_s_);
    std::array<double, kSettle> late{};
    std::size_t count = 1;
    for (double numbers = 0.0; count < std::min(kSettle, times.size()); ++count) {
      const std::size_t lost = trial.take(times[count - 1], times.subspan(count));
      if (lost > kSilence) break;
      numbers += 1.0 + static_cast<double>(lost);
      late[count] = (times[count] - times[0]) / period_s_ - numbers;
    }
    late_ = -middle_of(std::span(late).first(count));
    late_ -= std::round(late_);
  }
  // Returns the number of samples lost before the next stamp. times: that stamp and those that follow it.
  std::size_t take(double last_s, std::span<const double> times) {
    late_ += (times[0] - last_s) / period_s_ - 1.0 - rate_;
    double lost = 0.0;
    if (late_ > kHalf)
      lost = std::max(0.0, std::round(std::min({late_, lateness_of_next(times), kMostLost})));
    late_ -= lost;
    if (late_ > 4.0 * kHalf)
      return static_cast<std::size_t>(lost);  // a delay that returns says nothing of the clock
    const double off = std::clamp(late_, -kHalf, kHalf);
    late_ -= kPhaseGain * off;
    rate_ += kRateGain * off;
    return static_cast<std::size_t>(lost);
  }

 private:
  // Least median lateness of the next stamps and of longer runs behind them: after a delay that returns it is that
  // before the delay.
  [[nodiscard]] double lateness_of_next(std::span<const double> times) const {
    std::array<double, kSettle> late{};
    double least = kMostLost;
    for (std::size_t at = 0, run = kNext; at < times.size() && at < kReturn && least > kHalf;
         at += run, run = kSettle) {
      const std::size_t count = std::min(run, times.size() - at);
      if (at > 0 && count < kNext) break;
      for (std::size_t k = 0; k < count; ++k)
        late[k] = late_ + (times[at + k] - times[0]) / period_s_ - static_cast<double>(at + k);
      least = std::min(least, middle_of(std::span(late).first(count)));
    }
    return least;
  }
  // An element, not the mean of two, which may be on either side of a gap.
  static double middle_of(std::span<double> values) {
    const auto middle = values.begin() + (std::ssize(values) - 1) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  double period_s_;
  double late_ = 0.0, rate_ = 0.0;  // of the last stamp used; relative error of the period
};

// Finds missing samples if time stamps scatter so much that a single step is ambiguous: a late stamp makes a
// step of 1.8 periods, a lost sample between a late and an early stamp one of 1.2. Calls found(i, lost, step_s) in
// order for each sample i after which samples are lost, with the time step there.
//
// Exact while each stamp is off by less than half a period. With larger errors, a gap counts only if most of
// the next stamps confirm it (median, which other gaps nearby do not disturb) and the delay does not return
// later, as that of a stalled host does. period_s: within 0.05 % of the true period.
template <typename Found>
void holes_of_scattered(std::span<const double> time_s, double period_s, Found found) {
  const std::size_t samples = time_s.size();
  TrackingClock clock(period_s);
  clock.begin(time_s);
  for (std::size_t i = 0; i + 1 < samples; ++i) {
    const std::span<const double> next = time_s.subspan(i + 1);
    const std::size_t lost = clock.take(time_s[i], next);
    if (lost == 0) continue;
    found(i, lost, next[0] - time_s[i]);
    if (lost > kSilence) clock.begin(next);
  }
}

// Calls found(i, lost, step) for each gap after sample i.
template <typename Found>
void for_each_hole(std::span<const double> time_s, double period, bool scatters, Found found) {
  if (scatters) return holes_of_scattered(time_s, period, found);
  for (std::size_t i = 0; i + 1 < time_s.size(); ++i) {
    if (!is_gap(time_s, i, period)) continue;
    const double step = step_after(time_s, i);
    found(i, static_cast<std::size_t>(std::max(0.0, std::round(step / period) - 1.0)), step);
  }
}

// Mean period without the gaps found with this period. With scattering stamps a short gap counts as its
// number of steps, because its length is less accurate.
double mean_period(std::span<const double> time_s, double period_s, bool scatters) {
  constexpr std::size_t kShort = 8;
  const std::size_t count = time_s.size() - 1;
  double between_s = time_s.back() - time_s.front();
  double steps = static_cast<double>(count);
  std::size_t gaps = 0;
  for_each_hole(time_s, period_s, scatters, [&](std::size_t, std::size_t lost, double step_s) {
    ++gaps;
    if (scatters && lost <= kShort) {
      steps += static_cast<double>(lost);
      return;
    }
    between_s -= step_s;
    steps -= 1.0;
  });
  if (gaps == count) throw std::invalid_argument("no two samples are one sample time apart");
  return between_s / steps;
}

// Every `stride`-th step.
std::vector<double> some_steps(std::span<const double> time_s, std::size_t stride) {
  std::vector<double> some;
  some.reserve((time_s.size() - 1) / stride + 1);
  for (std::size_t i = 0; i + 1 < time_s.size(); i += stride) some.push_back(step_after(time_s, i));
  return some;
}

// An even clock whose stamps are late: the least delay of 512 stamps (fewer in a short record) is the same as that of those
// before.
struct EvenClock {
  double period_s = 0.0;
  // In periods: usual and largest difference of these least delays, and by how much a stamp usually exceeds them.
  double usual = 0.0, largest = 0.0, late = 0.0;

  // Of stamps rounded to ticks: from half their range.
  [[nodiscard]] double scatter() const { return 2.0 * late / std::sqrt(12.0); }
  // Whether the stamps do not contradict it. A lost sample is a difference of one period. After a late stamp a step is
  // short, after a lost sample none is: without short steps there is no difference at all. Rows in bursts are not
  // late: their pauses are many periods.
  [[nodiscard]] bool explains(double short_step_s) const {
    constexpr double kBurst = 2.0, kTenth = 1.28 * std::numbers::sqrt2;  // of Gaussian scatter
    const SampleClock by_steps{.scatter = (1.0 - short_step_s / period_s) / kTenth},
        whole{.scatter = scatter()};
    return late < kBurst && (by_steps.scatters() ? usual < kHalf : whole.scatters() && largest < kHalf);
  }
};

// Mean of the values within half a period of this one: of the differences without lost samples.
double mean_near(const std::vector<double>& values, double place) {
  double sum = 0.0, count = 0.0;
  for (const double value : values)
    if (std::abs(value - place) < 0.5) sum += value, count += 1.0;
  return sum / count;
}

EvenClock even_clock(std::span<const double> time_s) {
  constexpr std::size_t kFewest = 64, kMost = 512, kWindows = 32, kFewestWindows = 8;
  const std::size_t stamps = std::clamp(time_s.size() / kWindows, kFewest, kMost);
  const std::size_t windows = time_s.size() / stamps, last = windows * stamps - 1;
  EvenClock clock{.late = std::numeric_limits<double>::infinity()};
  if (windows < kFewestWindows) return clock;
  clock.period_s = (time_s[last] - time_s[0]) / static_cast<double>(last);
  std::vector<double> least, late, delays(stamps);
  for (int round = 0; round < 4; ++round) {
    least.clear(), late.clear();
    for (std::size_t begin = 0; begin < last; begin += stamps) {
      for (std::size_t i = 0; i < stamps; ++i)
        delays[i] = (time_s[begin + i] - time_s[0]) / clock.period_s - static_cast<double>(begin + i);
      least.push_back(*std::ranges::min_element(delays));
      late.push_back(median(delays) - least.back());
    }
    for (std::size_t i = 0; i + 1 < windows; ++i) least[i] = least[i + 1] - least[i];
    least.pop_back();
    const double drift = mean_near(least, median(least));
    clock.period_s *= 1.0 + drift / static_cast<double>(stamps);
    for (double& each : least) each = std::abs(each - drift);
  }
  clock.usual = median(least);
  clock.largest = *std::ranges::max_element(least);
  clock.late = median(late);
  return clock;
}

}  // namespace

SampleClock sample_clock(std::span<const double> time_s) {
  if (time_s.size() < 2) throw std::invalid_argument("a sample time needs two samples");
  const std::size_t count = time_s.size() - 1;
  // Some 100,000 steps suffice for the median.
  std::vector<double> some = some_steps(time_s, count / 100'000 + 1);
  double longest = 0.0;
  for (std::size_t i = 0; i < count; ++i) longest = std::max(longest, step_after(time_s, i));
  double period = median(some);
  if (!(period > 0.0)) throw std::invalid_argument("time does not increase");

  SampleClock clock;
  const auto scatter = [&](double period_s) {
    std::vector<double> away = some;
    for (double& step : away) step = std::abs(step - period_s);
    return 1.4826 * median(away) / (std::numbers::sqrt2 * period_s);  // of Gaussian scatter
  };
  const EvenClock even = longest <= kGap * period ? EvenClock{} : even_clock(time_s);
  std::ranges::nth_element(some, some.begin() + std::ssize(some) / 10);
  if (even.period_s > 0.0 && even.explains(some[some.size() / 10])) {
    period = even.period_s;
    clock.scatter = std::max(scatter(period), even.scatter());
  } else {
    // The median of coarse stamps is one tick too short or too long; a second round with the mean corrects it.
    for (int round = 0; round < 2; ++round) period = mean_period(time_s, period, false);
    clock.scatter = scatter(period);
    for (int round = 0; clock.scatters() && round < 3; ++round) period = mean_period(time_s, period, true);
  }
  clock.period_s = period;
  const std::vector<Hole> gaps = holes(time_s, clock);
  clock.gaps = gaps.size();
  if (!gaps.empty()) clock.first_gap = gaps.front().after;
  for (const Hole& gap : gaps) clock.missing += gap.lost;
  auto gap = gaps.begin();
  for (std::size_t i = 0; i < count; ++i) {
    if (gap != gaps.end() && gap->after == i)
      ++gap;
    else
      clock.worst_jitter_s = std::max(clock.worst_jitter_s, std::abs(step_after(time_s, i) - period));
  }
  return clock;
}

std::vector<Hole> holes(std::span<const double> time_s, const SampleClock& clock) {
  std::vector<Hole> out;
  for_each_hole(time_s, clock.period_s, clock.scatters(), [&](std::size_t i, std::size_t lost, double) {
    out.push_back({i, lost});
  });
  return out;
}

RowTimes::RowTimes(std::span<const double> time_s, const SampleClock& clock)
    : period_s_(clock.period_s), first_s_(time_s.front()), scatters_(clock.scatters()) {
  if (scatters_) holes_ = holes(time_s, clock);
}

double rounded_rate(double period_s) {
  const double rate = 1.0 / period_s;
  const double unit = std::pow(10.0, std::floor(std::log10(rate)) - 8.0);
  return std::round(rate / unit) * unit;
}

double RowTimes::next(double stamp_s) {
  if (!scatters_) return stamp_s - first_s_;
  if (row_ > 0) {
    const bool hole = at_ < holes_.size() && holes_[at_].after + 1 == row_;
    even_s_ += period_s_ * static_cast<double>(hole ? holes_[at_].lost + 1 : 1);
    at_ += hole ? 1 : 0;
  }
  ++row_;
  return even_s_;
}

}  // namespace ifog
