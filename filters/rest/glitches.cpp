// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/glitches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "filters/distributions/median.h"
#include "filters/rest/runs.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr double kFar = 30.0;
// In white noise a sample less the median of its neighbours has 1.5 times its variance.
constexpr double kOfMedian = 1.4826 / 1.224744871391589;
// Samples about one: a change of the noise fills at least half of a block or of the next one. Of fewer second
// differences no deviation is computed, and of as many it is off by a fifth at times.
constexpr std::size_t kNear = 64, kLeast = 16;
constexpr double kLouder = 2.0;
constexpr std::size_t kOneInAtMost = 1000;
constexpr std::size_t kLongest = 7;       // samples of one value: of more it is a value that was repeated
constexpr double kRounding = 1e-12;       // of a value
constexpr std::size_t kEnough = 100'000;  // second differences whose median is as good as that of all

// A sample with two neighbours: how far it is from what is between them, and from the one before.
struct Middle {
  double value = 0.0, away = 0.0, step = 0.0;
};

// use(i, middle) for each.
template <typename Use>
void for_each_middle(const SeriesView& rate, std::span<const Stretch> parts, Use use) {
  for (const Stretch& part : parts) {
    double before = 0.0, middle = 0.0;
    for_each_piece(rate, part.begin, part.end, [&](std::span<const double> values, std::size_t first) {
      for (std::size_t k = 0; k < values.size(); ++k) {
        if (first + k >= part.begin + 2)
          use(first + k - 1,
              Middle{middle, std::abs(middle - 0.5 * (before + values[k])), std::abs(middle - before)});
        before = middle;
        middle = values[k];
      }
    });
  }
}

// What a leap is measured against.
class Yardstick {
 public:
  Yardstick(const SeriesView& rate, std::span<const Stretch> parts) : rate_(rate), parts_(parts) {
    std::vector<double> some;
    const std::size_t stride = rate.size() / kEnough + 1;
    std::size_t next = 0;  // multiple of the stride
    double smallest_step = std::numeric_limits<double>::infinity();
    for_each_middle(rate, parts, [&](std::size_t i, const Middle& middle) {
      while (next < i) next += stride;
      if (i == next) some.push_back(middle.away);
      const double size = std::abs(middle.value);
      if (size >= largest_) times_ = size > largest_ ? 1 : times_ + 1;
      largest_ = std::max(largest_, size);
      if (middle.step > kRounding * std::abs(middle.value))
        smallest_step = std::min(smallest_step, middle.step);
    });
    if (some.size() < 3) return;
    all_ = kOfMedian * median(some);
    // Most neighbours of a coarse sensor are the same, but for the rounding of their digits.
    least_ = std::max(kRounding * largest_, std::isfinite(smallest_step) ? 0.5 * smallest_step : 0.0);
  }
  // Farthest from zero, which the record is more than once.
  [[nodiscard]] bool is_placeholder(double value) const { return times_ > 1 && std::abs(value) == largest_; }
  // Whether even between the farthest values nothing can leap.
  [[nodiscard]] bool is_quiet() const { return 2.0 * largest_ <= kFar * least(); }
  // No more than at() says anywhere.
  [[nodiscard]] double least() const { return std::max(all_, least_); }
  // At sample i: noise of the whole record, or of the neighbourhood where that is higher, so that growing noise is
  // no fault; 0 where nothing moves. i: none before that of the last call.
  [[nodiscard]] double at(std::size_t i) {
    const std::size_t block = i / kNear;
    double near = 0.0;
    for (std::size_t b = block - std::min<std::size_t>(block, 1); b < block + 2; ++b)
      near = std::max(near, near_at(b));
    return std::max(near > kLouder * all_ ? near : all_, least_);
  }

 private:
  struct Near {
    std::size_t block = std::numeric_limits<std::size_t>::max();
    double deviation = 0.0;
  };

  // The deviation of a block of samples, of those of them that have two neighbours. Worked out when something
  // in it or next to it may leap, which is seldom.
  double near_at(std::size_t block) {
    Near& known = near_[block % near_.size()];
    if (known.block == block) return known.deviation;
    // Parts and their first and last samples besides what is asked for.
    const std::size_t begin = block * kNear, end = std::min(begin + kNear, rate_.size());
    std::vector<Stretch> here;
    for (const Stretch& part : parts_)
      if (part.end > begin && part.begin < end)
        here.push_back({std::max(part.begin + 1, begin) - 1, std::min(part.end, end + 1)});
    std::vector<double> away;
    for_each_middle(rate_, here, [&](std::size_t, const Middle& middle) { away.push_back(middle.away); });
    known = {block, away.size() >= kLeast ? kOfMedian * median(away) : 0.0};
    return known.deviation;
  }

  const SeriesView& rate_;
  std::span<const Stretch> parts_;
  std::array<Near, 4> near_;  // by block, in turn
  double all_ = 0.0, least_ = 0.0, largest_ = 0.0;
  std::size_t times_ = 0;  // that largest_ stands
};

}  // namespace

Glitches find_glitches(const SeriesView& rate, std::span<const Stretch> parts, LeapOf of) {
  Glitches out;
  Yardstick yardstick(rate, parts);
  if (yardstick.is_quiet()) return out;
  std::size_t samples = 0;
  for (const Stretch& part : parts) samples += part.size();
  // One in the shortest of records is no habit of its sensor yet.
  const std::size_t most = samples / kOneInAtMost + 1;
  std::size_t end = 0, various = 0;  // end: of the last one; various: samples that are no placeholder
  for_each_run(rate, parts, [&](const Run& run) {
    const double between = 0.5 * (run.before + run.after), away = std::abs(run.value - between);
    const bool placeholder = of == LeapOf::kOneValue && yardstick.is_placeholder(run.value);
    const bool wanted = placeholder || (run.length == 1) == (of == LeapOf::kOneSample);
    if (run.length > kLongest || !wanted) return;
    if (!(away > kFar * yardstick.least()) || std::abs(run.after - run.before) >= 0.5 * away) return;
    const double deviation = yardstick.at(run.begin);
    if (!(deviation > 0.0) || away <= kFar * deviation) return;
    // Between two that leap the one in the middle stands apart as well.
    if (run.begin == end) return;
    end = run.begin + run.length;
    if (out.count == 0) out.first = run.begin;
    out.count += run.length;
    out.most_times = std::max(out.most_times, away / deviation);
    various += placeholder ? 0 : run.length;
    for (std::size_t i = run.begin; i < end && various <= most; ++i) out.few.push_back({i, between});
  });
  if (various > most) out.few.clear();
  return out;
}

std::string in_words(const Glitches& glitches, const std::function<double(std::size_t)>& time_s) {
  if (glitches.count == 0) return "";
  const bool one = glitches.count == 1;
  return formatted("%zu sample%s away and back (%sat %s s, up to %.2g times the noise): %s", glitches.count,
                   one ? " leaps" : "s leap", one ? "" : "the first ",
                   told_time(time_s(glitches.first)).c_str(), glitches.most_times,
                   glitches.few.empty() ? "more than one in a thousand, which these figures take for noise"
                                        : "a fault of the logger or the line, dropped");
}

}  // namespace ifog
