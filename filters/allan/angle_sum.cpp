// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/angle_sum.h"

#include <algorithm>
#include <array>
#include <utility>

#include "filters/allan/two_sum.h"

namespace ifog {

AngleSum::AngleSum(const SeriesView& rate_radps, std::span<const Stretch> stretches) {
  find_mean(rate_radps, stretches);
  if (rate_radps.in_memory().size() < rate_radps.size() || rate_radps.size() > kMostInMemory) {
    std::vector<double> some(LongSeries::kAtOnce);  // written in blocks
    std::size_t held = 0, total = stretches.size();
    for (const Stretch& s : stretches) total += s.size();
    long_.expect(total);
    sum_up(rate_radps, stretches, [&](double angle) {
      some[held++] = angle;
      if (held < some.size()) return;
      long_.add(some);
      held = 0;
    });
    long_.add(std::span(some).first(held));
    return;
  }
  std::size_t total = stretches.size();
  for (const Stretch& s : stretches) total += s.size();
  angle_.reserve(total);
  sum_up(rate_radps, stretches, [this](double angle) { angle_.push_back(angle); });
}

AngleSum::AngleSum(std::vector<double>&& rate_radps, std::span<const Stretch> stretches) {
  const std::size_t n = rate_radps.size();
  if (stretches.size() != 1 || stretches[0].size() != n || rate_radps.capacity() == n) {
    *this = AngleSum(SeriesView(rate_radps), stretches);
    rate_radps = {};
    return;
  }
  find_mean(rate_radps, stretches);
  angle_ = std::move(rate_radps);
  parts_.push_back({0, n + 1});
  angle_.push_back(0.0);
  double high = 0.0, low = 0.0, error = 0.0, rate = angle_[0];
  angle_[0] = 0.0;
  for (std::size_t i = 1; i <= n; ++i) {
    two_sum(high, rate - mean_, high, error);
    low += error;
    rate = std::exchange(angle_[i], high + low);
  }
}

void AngleSum::find_mean(const SeriesView& rate_radps, std::span<const Stretch> stretches) {
  constexpr std::size_t kLanes = 4;  // independent sums for instruction-level parallelism
  std::array<double, kLanes> sum{}, rest{};
  std::size_t total = 0;
  for (const Stretch& s : stretches) {
    total += s.size();
    for_each_piece(rate_radps, s.begin, s.end, [&](std::span<const double> rates, std::size_t) {
      std::size_t i = 0;
      double error = 0.0;
      const auto add = [&](std::size_t lane, double rate) {
        two_sum(sum[lane], rate, sum[lane], error);
        rest[lane] += error;
      };
      for (; i + kLanes <= rates.size(); i += kLanes)
        for (std::size_t lane = 0; lane < kLanes; ++lane) add(lane, rates[i + lane]);
      for (; i < rates.size(); ++i) add(0, rates[i]);
    });
  }
  double all = 0.0, left = 0.0, error = 0.0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    two_sum(all, sum[lane], all, error);
    left += error + rest[lane];
  }
  mean_ = total > 0 ? (all + left) / static_cast<double>(total) : 0.0;
}

template <typename Add>
void AngleSum::sum_up(const SeriesView& rate_radps, std::span<const Stretch> stretches, Add add) {
  std::size_t first = 0;
  for (const Stretch& s : stretches) {
    parts_.push_back({first, s.size() + 1});
    first += s.size() + 1;
    double high = 0.0, low = 0.0, error = 0.0;
    add(0.0);
    for_each_piece(rate_radps, s.begin, s.end, [&](std::span<const double> rates, std::size_t) {
      for (const double rate : rates) {
        // The error of the rounded mean is a constant, which a second difference cancels.
        two_sum(high, rate - mean_, high, error);
        low += error;
        add(high + low);
      }
    });
  }
}

SeriesView AngleSum::angle() const { return angle_.empty() ? SeriesView(long_) : SeriesView(angle_); }

std::size_t AngleSum::longest() const {
  std::size_t n = 0;
  for (const Part& part : parts_) n = std::max(n, part.angles - 1);
  return n;
}

}  // namespace ifog
