// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/glitches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

namespace ifog {
namespace {

constexpr double kFar = 30.0;
constexpr std::size_t kEnough = 100'000;  // second differences whose median is as good as that of all

// use(i, away, apart) for each sample with two neighbours: how far it is from their middle, and they from
// each other.
template <typename Use>
void for_each_middle(const SeriesView& rate, std::span<const Stretch> parts, Use use) {
  for (const Stretch& part : parts) {
    double before = 0.0, middle = 0.0;
    for_each_piece(rate, part.begin, part.end, [&](std::span<const double> values, std::size_t first) {
      for (std::size_t k = 0; k < values.size(); ++k) {
        if (first + k >= part.begin + 2)
          use(first + k - 1, std::abs(middle - 0.5 * (before + values[k])), std::abs(values[k] - before));
        before = middle;
        middle = values[k];
      }
    });
  }
}

}  // namespace

Glitches find_glitches(const SeriesView& rate, std::span<const Stretch> parts) {
  std::vector<double> some;
  const std::size_t stride = rate.size() / kEnough + 1;
  for_each_middle(rate, parts, [&](std::size_t i, double away, double) {
    if (i % stride == 0) some.push_back(away);
  });
  Glitches out;
  if (some.size() < 3) return out;
  std::nth_element(some.begin(), some.begin() + std::ssize(some) / 2, some.end());
  // Of white noise a sample less the middle of its neighbours has 1.5 times its variance.
  const double deviation = 1.4826 * some[some.size() / 2] / std::sqrt(1.5);
  if (!(deviation > 0.0)) return out;  // more than half of the record stands still
  for_each_middle(rate, parts, [&](std::size_t i, double away, double apart) {
    if (away <= kFar * deviation || apart >= 0.5 * away) return;
    if (out.count++ == 0) out.first = i;
    out.most_times = std::max(out.most_times, away / deviation);
  });
  return out;
}

std::string in_words(const Glitches& glitches, const std::function<double(std::size_t)>& time_s) {
  if (glitches.count == 0) return "";
  const bool one = glitches.count == 1;
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(),
                "%zu sample%s away and back (%sat %.6g s, up to %.2g times the noise): a fault of the logger "
                "or the line, which "
                "these figures take for noise",
                glitches.count, one ? " leaps" : "s leap", one ? "" : "the first ", time_s(glitches.first),
                glitches.most_times);
  return text.data();
}

}  // namespace ifog
