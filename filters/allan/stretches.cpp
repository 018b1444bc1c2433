// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/stretches.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace ifog {
namespace {

constexpr double kGap = 1.5;     // in periods
constexpr double kSurely = 2.1;  // likewise: stamps that keep their order are off by less than half a period
constexpr std::size_t kLeastBeside = 2;

// How many samples on either side say whether the stamps stay late behind a step: two, and where the stamps
// scatter by themselves as many as their median needs to be worth a tenth of a period.
std::size_t samples_beside(std::vector<double> steps, double period) {
  constexpr double kScatters = 0.1, kWorth = 0.1;  // of a period
  constexpr std::size_t kMostBeside = 64;
  for (double& step : steps) step = std::abs(step - period);
  std::nth_element(steps.begin(), steps.begin() + std::ssize(steps) / 2, steps.end());
  const double scatter =
      1.4826 * steps[steps.size() / 2] / (std::numbers::sqrt2 * period);  // of a stamp, as of Gaussians
  if (scatter < kScatters) return kLeastBeside;
  const double wanted = std::ceil(std::numbers::pi * (scatter / kWorth) * (scatter / kWorth));
  return std::clamp<std::size_t>(static_cast<std::size_t>(std::min(wanted, 1e3)), kLeastBeside, kMostBeside);
}

// Some steps of the time with the samples around them.
class Steps {
 public:
  Steps(std::span<const double> time_s, std::size_t first, std::size_t samples, std::size_t beside)
      : time_s_(time_s), first_(first), samples_(samples), beside_(beside) {}

  // From sample i to the next.
  [[nodiscard]] double step(std::size_t i) const { return at(i + 1) - at(i); }
  // A late stamp followed by an early one is jitter; a gap leaves all that follows late. The step is judged
  // by the second sample on either side, which what one bad stamp does has no part in; and of stamps that
  // scatter, by the medians on either side as well.
  [[nodiscard]] bool is_gap(std::size_t i, double period) const {
    if (step(i) <= kGap * period) return false;
    const std::size_t low = i >= kLeastBeside ? i - kLeastBeside : 0;
    const std::size_t high = std::min(i + 1 + kLeastBeside, samples_ - 1);
    const double across = (at(high) - at(low)) / period;
    if (across - static_cast<double>(high - low) <= kGap - 1.0) return false;
    return beside_ == kLeastBeside || late_for_good(i, period);
  }

 private:
  [[nodiscard]] double at(std::size_t i) const { return time_s_[i - first_]; }
  // By the medians on either side, up to the next step that no scatter makes: another hole says nothing of
  // this one.
  [[nodiscard]] bool late_for_good(std::size_t i, double period) const {
    const double surely = kSurely * period;
    if (step(i) > surely) return true;
    std::vector<double> before, behind;
    for (std::size_t k = 0; k < std::min(beside_, i + 1); ++k) {
      if (k > 0 && step(i - k) > surely) break;
      before.push_back((at(i - k) - at(i)) / period + static_cast<double>(k));
    }
    for (std::size_t k = 0; k < std::min(beside_, samples_ - 1 - i); ++k) {
      if (k > 0 && step(i + k) > surely) break;
      behind.push_back((at(i + 1 + k) - at(i)) / period - static_cast<double>(k + 1));
    }
    if (2 * std::min(before.size(), behind.size()) < beside_) return false;  // too few to say
    return median(behind) - median(before) > kGap - 1.0;
  }
  static double median(std::vector<double>& values) {
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  std::span<const double> time_s_;
  std::size_t first_, samples_, beside_;
};

// use(steps, i) for every step i in order.
template <typename Use>
void for_each_step(const SeriesView& time_s, std::size_t beside, Use use) {
  const std::size_t samples = time_s.size();
  std::vector<double> room;
  for (std::size_t begin = 0; begin + 1 < samples; begin += kSeriesPiece) {
    const std::size_t end = std::min(begin + kSeriesPiece, samples - 1);
    const std::size_t low = begin - std::min(begin, beside);
    const std::size_t high = std::min(end + 1 + beside, samples);
    const Steps steps(time_s.piece(low, high - low, room), low, samples, beside);
    for (std::size_t i = begin; i < end; ++i) use(steps, i);
  }
}

}  // namespace

SampleClock sample_clock(const SeriesView& time_s) {
  if (time_s.size() < 2) throw std::invalid_argument("a sample time needs two samples");
  const std::size_t count = time_s.size() - 1;
  // The median of a hundred thousand steps is as good as that of all.
  std::vector<double> some;
  const std::size_t stride = count / 100'000 + 1;
  some.reserve(count / stride + 1);
  for_each_step(time_s, kLeastBeside, [&](const Steps& steps, std::size_t i) {
    if (i % stride == 0) some.push_back(steps.step(i));
  });
  std::nth_element(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(some.size() / 2), some.end());
  double period = some[some.size() / 2];
  if (!(period > 0.0)) throw std::invalid_argument("time does not increase");

  const std::size_t beside = samples_beside(std::move(some), period);
  SampleClock clock;
  const double all_s = time_s.at(count) - time_s.at(0);
  // Coarse stamps make the median one tick too short or too long; a second round with the mean settles it.
  for (int round = 0; round < 2; ++round) {
    clock = {};
    double gaps_s = 0.0;
    for_each_step(time_s, beside, [&](const Steps& steps, std::size_t i) {
      if (!steps.is_gap(i, period)) return;
      if (clock.gaps++ == 0) clock.first_gap = i;
      gaps_s += steps.step(i);
    });
    if (clock.gaps == count) throw std::invalid_argument("no two samples are one sample time apart");
    period = (all_s - gaps_s) / static_cast<double>(count - clock.gaps);
  }
  clock.period_s = period;
  clock.beside = beside;
  for_each_step(time_s, beside, [&](const Steps& steps, std::size_t i) {
    const double step = steps.step(i);
    if (steps.is_gap(i, period))
      clock.missing += static_cast<std::size_t>(std::max(0.0, std::round(step / period) - 1.0));
    else
      clock.worst_jitter_s = std::max(clock.worst_jitter_s, std::abs(step - period));
  });
  return clock;
}

std::vector<std::size_t> holes(const SeriesView& time_s, const SampleClock& clock) {
  std::vector<std::size_t> gaps;
  for_each_step(time_s, clock.beside, [&](const Steps& steps, std::size_t i) {
    if (steps.is_gap(i, clock.period_s)) gaps.push_back(i);
  });
  return gaps;
}

std::vector<Stretch> stretches(const SeriesView& time_s, const SeriesView& rate_radps,
                               const SampleClock& clock) {
  const std::vector<std::size_t> gaps = holes(time_s, clock);
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
      const bool last = gap != gaps.end() && *gap == i;
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
