// SPDX-License-Identifier: Apache-2.0
#include "filters/promise/running_trial.h"

#include <algorithm>
#include <cmath>

#include "filters/promise/promise.h"
#include "filters/rest/rest.h"

namespace ifog {
namespace {

constexpr std::size_t kMostMeans = std::size_t{1} << 14U;
constexpr std::size_t kFewestAtRest = 100;
constexpr double kAtRest = 1e-3;  // rad/s, as in rest.h: largest range of the means at rest
constexpr double kFewAway = 0.005;

// Range without a few values at either end.
double range_of(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  const auto few = static_cast<std::size_t>(kFewAway * static_cast<double>(values.size()));
  return values[values.size() - 1 - few] - values[few];
}

}  // namespace

void RunningTrial::widen() {
  stretch_s_ *= 2.0;
  for (std::vector<Sums>& means : means_) {
    for (std::size_t i = 0; i < means.size(); ++i) {
      const Sums here = means[i];
      Sums& pair = means[i / 2];
      pair = i % 2 == 0 ? here
                        : Sums{pair.before + here.before, pair.after + here.after, pair.count + here.count};
    }
    means.resize((means.size() + 1) / 2);
  }
}

void RunningTrial::add(double time_s, std::span<const double> before_radps,
                       std::span<const double> after_radps) {
  if (std::isnan(first_s_)) first_s_ = time_s;
  if (!(time_s >= first_s_) || !std::isfinite(time_s)) return;
  while ((time_s - first_s_) / stretch_s_ >= static_cast<double>(kMostMeans)) widen();
  const auto at = static_cast<std::size_t>((time_s - first_s_) / stretch_s_);
  for (std::size_t axis = 0; axis < means_.size(); ++axis) {
    std::vector<Sums>& means = means_[axis];
    if (means.size() <= at) means.resize(at + 1);
    if (!std::isfinite(before_radps[axis]) || !std::isfinite(after_radps[axis])) continue;
    means[at].before += before_radps[axis];
    means[at].after += after_radps[axis];
    means[at].count += 1.0;
  }
}

std::optional<ShareThere> RunningTrial::weigh(std::size_t axis) const {
  const std::vector<Sums>& means = means_[axis];
  std::vector<double> time_s, before, after;
  for (std::size_t i = 0; i < means.size(); ++i) {
    const Sums& each = means[i];
    time_s.push_back(static_cast<double>(i) * stretch_s_);
    before.push_back(each.count > 0.0 ? each.before / each.count : std::nan(""));
    after.push_back(each.count > 0.0 ? each.after / each.count : std::nan(""));
  }
  const std::span<const double> rate(before);
  const Rest rest = find_rest(std::span(&rate, 1), {}, stretch_s_);
  std::size_t resting = 0;
  for (const Stretch& each : rest.at_rest)
    for (std::size_t i = each.begin; i < each.end; ++i) resting += std::isfinite(before[i]) ? 1 : 0;
  if (resting < kFewestAtRest || rest.turned > 0 || range_of(before) > kAtRest) return std::nullopt;
  const PromiseKept kept = weigh_promise({time_s, before, after, rest.at_rest});
  if (!std::isfinite(kept.share_error)) return std::nullopt;
  return ShareThere{kept.share, kept.share_error, verdict(kept) == PromiseVerdict::broken};
}

}  // namespace ifog
