// SPDX-License-Identifier: Apache-2.0
#include "tools/report/plot_data.h"

#include <glib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "filters/distributions/median.h"

namespace ifog::report {

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
