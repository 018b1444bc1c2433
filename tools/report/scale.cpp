// SPDX-License-Identifier: Apache-2.0
#include "tools/report/scale.h"

#include <glib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "drivers/row_times/median.h"
#include "tools/report/text.h"

namespace ifog::report {

void Bounds::take(double value, bool log) {
  if (!std::isfinite(value) || (log && value <= 0.0)) return;
  low = std::min(low, value);
  high = std::max(high, value);
}

Scale::Scale(const ChartAxis& axis, const Bounds& data, double from_px, double to_px)
    : log_(axis.log), names_(axis.names), from_(from_px), to_(to_px) {
  low_ = axis.low.value_or(data.low);
  high_ = axis.high.value_or(data.high);
  if (log_) {
    low_ = std::log10(low_);
    high_ = std::log10(high_);
  }
  const double span = high_ - low_;
  const double margin = span > 0.0 ? 0.04 * span : (log_ ? 0.5 : std::max(std::abs(low_), 1e-30));
  if (!axis.low) low_ -= margin;
  if (!axis.high) high_ += margin;
  const double least = std::max(1e-12 * std::max(std::abs(low_), std::abs(high_)), 1e-300);
  if (high_ - low_ < least) {
    low_ -= least;
    high_ += least;
  }
}

double Scale::operator()(double value) const {
  return from_ + ((log_ ? std::log10(value) : value) - low_) / (high_ - low_) * (to_ - from_);
}

double Scale::low() const { return log_ ? std::pow(10.0, low_) : low_; }

double Scale::high() const { return log_ ? std::pow(10.0, high_) : high_; }

bool Scale::drawable(double value) const { return std::isfinite(value) && (!log_ || value > 0.0); }

bool Scale::inside(double exponent) const { return exponent >= low_ - 1e-9 && exponent <= high_ + 1e-9; }

std::vector<Tick> Scale::ticks(int wanted) const {
  std::vector<Tick> out;
  if (log_) {
    const bool dense = high_ - low_ < 0.5 * wanted;
    for (int d = static_cast<int>(std::floor(low_)); d <= static_cast<int>(std::ceil(high_)); ++d)
      for (const double m : {1.0, 2.0, 5.0})
        if ((dense || m == 1.0) && inside(d + std::log10(m)))
          out.push_back({m * std::pow(10.0, d), number(m * std::pow(10.0, d), 1), m == 1.0});
    return out;
  }
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (const double at = static_cast<double>(i) + 1.0; at >= low_ && at <= high_)
      out.push_back({at, names_[i], true});
  if (!names_.empty()) return out;
  const double raw = (high_ - low_) / wanted;
  int decade = static_cast<int>(std::floor(std::log10(raw)));
  const double ten = std::pow(10.0, decade);
  const double step = ten * (raw / ten < 1.5 ? 1.0 : raw / ten < 3.5 ? 2.0 : raw / ten < 7.5 ? 5.0 : 10.0);
  if (raw / ten >= 7.5) ++decade;
  const double reach = std::max(std::abs(low_), std::abs(high_));
  int power = static_cast<int>(std::floor(std::log10(reach)));
  if (power >= -4 && power < 6) power = 0;
  const double first = std::ceil(low_ / step);
  const int count = static_cast<int>(std::floor(high_ / step) - first) + 1;
  for (int k = 0; k < count; ++k) {
    const double at = (first + k) * step;
    out.push_back({at, at_power(at, std::max(0, power - decade), power), true});
  }
  return out;
}

std::vector<double> Scale::minor_ticks() const {
  std::vector<double> out;
  if (!log_) return out;
  for (int d = static_cast<int>(std::floor(low_)); d <= static_cast<int>(std::ceil(high_)); ++d)
    for (int m = 2; m < 10; ++m)
      if (inside(d + std::log10(m))) out.push_back(m * std::pow(10.0, d));
  return out;
}

TimeAxis::TimeAxis(double first_s, double last_s)
    : first_s_(first_s), last_s_(last_s), unit_(time_unit(last_s - first_s)) {
  constexpr double kLong = 1e5, kFar = 10.0;  // kLong in s; kFar in lengths of the picture
  const double far = std::max(std::abs(first_s), std::abs(last_s));
  if (far >= kLong && far > kFar * (last_s - first_s)) origin_s_ = std::floor(first_s);
}

std::vector<double> TimeAxis::operator()(std::vector<double> time_s) const {
  for (double& time : time_s) time = (*this)(time);
  return time_s;
}

std::string TimeAxis::label() const {
  const std::string since = origin_s_ == 0.0 ? "" : " since " + at_power(origin_s_, 0, 0) + " s";
  return "time" + since + " (" + unit_.name + ")";
}

ChartAxis TimeAxis::axis(bool numbered) const {
  return {numbered ? label() : "", false, (*this)(first_s_), (*this)(last_s_), numbered};
}

static_assert(std::endian::native == std::endian::little, "a page's script reads them as they lie in memory");

Thinned thinned(std::span<const double> x, std::span<const double> y) {
  constexpr std::size_t kMost = 5000,
                        kStretches = 1500;  // twice the pixels of a screen
  const std::size_t size = std::min(x.size(), y.size());
  if (size <= kMost) return {{x.begin(), x.end()}, {y.begin(), y.end()}};
  Thinned out;
  for (std::size_t k = 0; k < kStretches; ++k) {
    const std::size_t from = size * k / kStretches, to = size * (k + 1) / kStretches;
    const auto begin = y.begin() + static_cast<std::ptrdiff_t>(from),
               end = y.begin() + static_cast<std::ptrdiff_t>(to);
    // NaN compares as less, so it is kept only if the stretch has nothing else.
    const auto less = [](double a, double b) { return std::isnan(b) ? !std::isnan(a) : a < b; };
    const auto more = [](double a, double b) { return std::isnan(b) ? !std::isnan(a) : a > b; };
    auto first = std::min_element(begin, end, less), second = std::min_element(begin, end, more);
    if (second < first) std::swap(first, second);
    for (const auto at : {first, second}) {
      const auto i = static_cast<std::size_t>(at - y.begin());
      if (!out.x.empty() && out.x.back() == x[i]) continue;
      out.x.push_back(x[i]);
      out.y.push_back(y[i]);
    }
  }
  return out;
}

void open_at_holes(std::vector<double>& time, std::vector<double>& y) {
  constexpr double kHole = 10.0;
  if (time.size() < 3) return;
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  const double most = kHole * median(std::move(steps));
  std::vector<double> open_time, open_y;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (i > 0 && time[i] - time[i - 1] > most) {
      open_time.push_back(0.5 * (time[i] + time[i - 1]));
      open_y.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    open_time.push_back(time[i]);
    open_y.push_back(y[i]);
  }
  time = std::move(open_time);
  y = std::move(open_y);
}

std::string packed(std::span<const double> values) {
  const std::vector<float> narrow(values.begin(), values.end());
  const std::unique_ptr<char, decltype(&g_free)> text(
      g_base64_encode(reinterpret_cast<const guchar*>(narrow.data()), narrow.size() * sizeof(float)),
      &g_free);
  return text.get();
}

}  // namespace ifog::report
