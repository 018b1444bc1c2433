// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/monitor/sensor_view.h"

#include <limits>
#include <utility>

#include "msgs/counters.h"

namespace ifog::tools {
namespace {

double deviation(const Moments& of) {
  return of.count() < 2.0 ? std::numeric_limits<double>::quiet_NaN() : of.deviation();
}

}  // namespace

void SensorView::take(const rate_t& message) {
  ++messages_;
  ++in_interval_;
  received_ = true;
  model_ = message.model;
  way_.take(message);
  for (std::size_t i = 0; i < kFlagNames.size(); ++i)
    if ((message.flags & kFlagNames[i].flag) != 0) ++flagged_[i];
  sums_.resize(static_cast<std::size_t>(message.axes));
  history_.resize(sums_.size());
  if (axes_.size() > sums_.size()) axes_.clear();
  for (std::size_t a = 0; a < sums_.size(); ++a) {
    Sums& sums = sums_[a];
    sums.denoised.add(message.denoised[a]);
    sums.raw.add(message.raw[a]);
    sums.raw_low = std::fmin(sums.raw_low, message.raw[a]);  // ignores NaN
    sums.raw_high = std::fmax(sums.raw_high, message.raw[a]);
    sums.angle = message.angle[a];
  }
}

void SensorView::take(status_t message) {
  status_.message = std::move(message);
  received_ = status_.received = true;
  status_.age_s = 0.0;
}

void SensorView::end_interval(double seconds) {
  rate_hz_ = static_cast<double>(in_interval_) / seconds;
  judged_ = true;
  shown_ = shown_ || in_interval_ > 0 || status_.message;
  silent_s_ = std::exchange(received_, false) ? 0.0 : silent_s_ + seconds;
  status_.age_s = std::exchange(status_.received, false) ? 0.0 : status_.age_s + seconds;
  flagged_before_ = std::exchange(flagged_, {});
  axes_.clear();
  for (std::size_t a = 0; a < sums_.size(); ++a) {
    const Sums sums = std::exchange(sums_[a], {});
    const double rate_radps = sums.denoised.mean();
    if (in_interval_ > 0)
      axes_.push_back({rate_radps, deviation(sums.denoised), deviation(sums.raw), sums.angle});
    history_[a].push_back({sums.raw_low, sums.raw_high, rate_radps});
    if (history_[a].size() > kRemembered) history_[a].pop_front();
  }
  in_interval_ = 0;
}

std::vector<SensorView::Count> SensorView::flags() const {
  std::vector<Count> out;
  for (std::size_t i = 0; i < kFlagNames.size(); ++i)
    if (flagged_before_[i] > 0) out.push_back({kFlagNames[i].name, flagged_before_[i]});
  return out;
}

std::vector<SensorView::Count> SensorView::all_losses() const {
  const status_t s = status_.message.value_or(status_t{});
  std::vector<Count> out{{"lost on LCM", way_.lost()}};
  for (const StatusCounter& each : kStatusCounters)
    if (*each.loss != '\0') out.push_back({each.loss, s.*each.count});
  return out;
}

std::vector<SensorView::Count> SensorView::losses() const {
  std::vector<Count> out = all_losses();
  for (std::size_t i = 0; i < forgotten_.size(); ++i) {
    // A restarted daemon counts from 0.
    if (out[i].count >= forgotten_[i]) out[i].count -= forgotten_[i];
  }
  std::erase_if(out, [](const Count& each) { return each.count == 0; });
  return out;
}

void SensorView::forget_losses() {
  forgotten_.clear();
  for (const Count& each : all_losses()) forgotten_.push_back(each.count);
}

}  // namespace ifog::tools
