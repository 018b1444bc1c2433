// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/glitches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "drivers/row_times/median.h"
#include "filters/allan/runs.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr double kFar = 30.0;
// 1.5 is the variance, relative to the noise, of a white sample minus the mean of its two neighbours.
constexpr double kOfMedian = 1.4826 / 1.224744871391589;
// Samples per local block. With fewer than kLeast second differences the local deviation is not used; with
// kLeast its error reaches a fifth.
constexpr std::size_t kNear = 64, kLeast = 16;
constexpr double kLocalAbove = 2.0;
// More belong to the sensor, as where each turn crosses a dead zone within one sample.
constexpr std::size_t kOneInAtMost = 200;
constexpr std::size_t kLongest = 7;       // samples, except at the beginning of a stretch
constexpr double kRounding = 1e-12;       // relative
constexpr std::size_t kEnough = 100'000;  // enough second differences for the median

// Calls use(i, away) for each sample that has both neighbours, with its distance from their mean, except where
// one of the three has the magnitude `without`.
template <typename Use>
void for_each_middle(std::span<const double> rate, std::span<const Stretch> parts, double without, Use use) {
  for (const Stretch& part : parts) {
    double before = 0.0, middle = 0.0;
    for (std::size_t i = part.begin; i < part.end; ++i) {
      const bool all = std::abs(before) != without && std::abs(middle) != without &&
                       std::abs(rate[i]) != without && i >= part.begin + 2;
      if (all) use(i - 1, std::abs(middle - 0.5 * (before + rate[i])));
      before = middle;
      middle = rate[i];
    }
  }
}

// Noise deviation that a leap is compared with.
class Yardstick {
 public:
  Yardstick(std::span<const double> rate, std::span<const Stretch> parts, LeapOf of)
      : rate_(rate), parts_(parts) {
    for_each_run(rate, parts, [&](const Run& run) { add(run); });
    if (of == LeapOf::kOneValue) without_ = largest_;
    std::vector<double> some;
    const std::size_t stride = rate.size() / kEnough + 1;
    std::size_t next = 0;  // multiple of the stride
    for_each_middle(rate, parts, without_, [&](std::size_t i, double away) {
      while (next < i) next += stride;
      if (i == next) some.push_back(away);
    });
    if (some.size() < 3) return;
    all_ = kOfMedian * median(some);
    // Most neighbours of a sensor with coarse resolution are equal except for rounding.
    least_ = std::max(kRounding * largest_, 0.5 * smallest_step_);
  }
  // A rate has magnitudes up to its largest, in a crest of two samples at most where values do not repeat.
  [[nodiscard]] bool is_placeholder(const Run& run) const {
    int power = 0;  // -1 as an unsigned count is one less than a power of two
    const bool wraps = std::frexp(std::round(largest_ / smallest_step_) + 1.0, &power) == 0.5 && power > 8;
    const bool held = repeats_.are_rare() && run.length > 2, begins = std::isnan(run.before);
    return std::abs(run.value) == largest_ && 2.0 * second_ < largest_ && !wraps &&
           (run.length > kLongest ? held && begins : held || times_ > 1);
  }
  // The samples around a blow or the start of motion leap, too.
  [[nodiscard]] bool is_alone(const Run& run, double between) const {
    const double most = 0.25 * std::abs(run.value - between);
    const std::size_t end = std::min(run.begin + kLongest + 1, rate_.size());
    for (std::size_t i = run.begin - std::min(run.begin, kLongest); i < end; ++i)
      if (std::abs(rate_[i] - between) > most && std::abs(rate_[i] - run.value) > most) return false;
    return true;
  }
  // Lower limit of at().
  [[nodiscard]] double least() const { return std::max(all_, least_); }
  // Deviation at sample i: the whole record's, or the local one if that is higher, so that growing noise is
  // no fault; 0 if the value does not change.
  [[nodiscard]] double at(std::size_t i) const {
    const std::size_t block = i / kNear;
    double near = 0.0;
    for (std::size_t b = block - std::min<std::size_t>(block, 1); b < block + 2; ++b)
      near = std::max(near, near_at(b));
    return std::max(near > kLocalAbove * all_ ? near : all_, least_);
  }

 private:
  // Deviation of one block of samples. Computed only where a leap is possible.
  [[nodiscard]] double near_at(std::size_t block) const {
    // The parts within the block, with one more sample on either side.
    const std::size_t begin = block * kNear, end = std::min(begin + kNear, rate_.size());
    std::vector<Stretch> here;
    for (const Stretch& part : parts_)
      if (part.end > begin && part.begin < end)
        here.push_back({std::max(part.begin + 1, begin) - 1, std::min(part.end, end + 1)});
    std::vector<double> away;
    for_each_middle(rate_, here, without_, [&](std::size_t, double each) { away.push_back(each); });
    return away.size() >= kLeast ? kOfMedian * median(away) : 0.0;
  }

  void add(const Run& run) {
    const double size = std::abs(run.value);
    repeats_.add(run);
    if (const double step = std::abs(run.value - run.before); step > kRounding * size)
      smallest_step_ = std::min(smallest_step_, step);
    if (size > largest_) second_ = std::exchange(largest_, size), times_ = 0;
    if (size < largest_) second_ = std::max(second_, size);
    times_ += size == largest_ ? 1 : 0;
  }

  std::span<const double> rate_;
  std::span<const Stretch> parts_;
  Repeats repeats_;
  double without_ = -1.0;  // magnitude of placeholders, if any
  double all_ = 0.0, least_ = 0.0, largest_ = 0.0, second_ = 0.0;
  double smallest_step_ = std::numeric_limits<double>::infinity();
  std::size_t times_ = 0;  // number of runs of largest_
};

}  // namespace

Glitches find_glitches(std::span<const double> rate, std::span<const Stretch> parts, LeapOf of) {
  Glitches out;
  Yardstick yardstick(rate, parts, of);
  std::size_t samples = 0;
  for (const Stretch& part : parts) samples += part.size();
  // One outlier is accepted even in a very short record.
  const std::size_t most = samples / kOneInAtMost + 1;
  std::size_t end = rate.size(), various = 0;  // end of the last outlier; samples that are no placeholder
  for_each_run(rate, parts, [&](const Run& run) {
    const bool placeholder = of == LeapOf::kOneValue && yardstick.is_placeholder(run);
    // At an end of the record a placeholder has one neighbour.
    const double before = placeholder && std::isnan(run.before) ? run.after : run.before,
                 after = placeholder && std::isnan(run.after) ? run.before : run.after,
                 between = 0.5 * (before + after), away = std::abs(run.value - between);
    if (!(of == LeapOf::kOneValue ? placeholder : run.length == 1)) return;
    if (!(away > kFar * yardstick.least()) || std::abs(after - before) >= 0.5 * away) return;
    if (of == LeapOf::kOneSample && !yardstick.is_alone(run, between)) return;
    const double deviation = yardstick.at(run.begin);
    if (!(deviation > 0.0) || away <= kFar * deviation) return;
    // The sample between two outliers looks like one too.
    if (run.begin == end) return;
    end = run.begin + run.length;
    if (out.count == 0) out.first = run.begin;
    out.count += run.length;
    out.most_times = std::max(out.most_times, away / deviation);
    various += placeholder ? 0 : run.length;
    if (various <= most) out.few.push_back({{run.begin, end}, placeholder ? std::nan("") : between});
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
                   glitches.few.empty() ? "more than one in 200, which these figures take for noise"
                                        : "a fault of the logger or the line, dropped");
}

}  // namespace ifog
