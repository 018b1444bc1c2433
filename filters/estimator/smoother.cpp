// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/smoother.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "filters/estimator/estimator.h"
#include "filters/estimator/motion_pace.h"
#include "filters/estimator/start_up.h"

namespace ifog {
namespace {

// A gain of one has no walk that makes it; this one follows every sample.
constexpr double kMostGain = 0.999;
// Between where a manoeuvre is found forwards and where it is found backwards it is under way; further apart
// they are two.
constexpr std::size_t kFurthest = 100'000;
// Samples at rest that show how loud the noise is there.
constexpr std::size_t kEnoughRest = 256;
// A motion is looked at over this many samples at least, however quick the filter at rest is.
constexpr double kLeastBehind = 48.0;

// One direction of one axis.
struct Pass {
  std::vector<std::uint8_t> moving;
  std::vector<double> noises;  // at rest: R so that the filter's variance comes out
  double least_gain = kMostGain;
};

Pass run(const FilterSettings& settings, std::span<const double> rate, std::span<const double> dt_s,
         double period_s, bool backwards) {
  const std::size_t length = rate.size();
  Estimator estimator(settings, 1, period_s);
  EstimatorInput in;
  EstimatorOutput out;
  Pass pass;
  pass.moving.resize(length);
  for (std::size_t k = 0; k < length; ++k) {
    const std::size_t i = backwards ? length - 1 - k : k;
    in.sequence = i;
    // Backwards the time to this sample is what forwards is the time to the one after it.
    in.dt_s = backwards && i + 1 < length ? dt_s[i + 1] : dt_s[i];
    in.valid_axes = std::isfinite(rate[i]) ? 1U : 0U;
    in.rate_radps[0] = rate[i];
    estimator.step(in, out);
    pass.moving[i] = (out.flags & kManoeuvre) != 0 ? 1 : 0;
    const double gain = std::min(out.gain[0], kMostGain);
    if (pass.moving[i] != 0 || !(gain > 0.0)) continue;
    // That of a settled filter is K R, its colour included.
    if (!backwards) pass.noises.push_back(out.variance_rad2ps2[0] / gain);
    pass.least_gain = std::min(pass.least_gain, gain);
  }
  return pass;
}

// The walk that would settle the filter's gain at K: Q/R = K^2 / (1-K).
double walk_of(double gain, double noise) { return noise * gain * gain / (1.0 - gain); }

// Where it moves in either direction, and from where a change was found forwards back to where it was found
// backwards.
std::vector<float> moving(const Pass& forwards, const Pass& backwards) {
  std::vector<float> all(forwards.moving.size(), pace::kRest);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (forwards.moving[i] != 0 || backwards.moving[i] != 0) all[i] = pace::kBroken;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (forwards.moving[i] == 0 || forwards.moving[i - 1] != 0) continue;
    const std::size_t least = i > kFurthest ? i - kFurthest : 0;
    std::size_t j = i;
    while (j > least && backwards.moving[j - 1] == 0) --j;
    if (j == least) continue;
    std::fill(all.begin() + static_cast<std::ptrdiff_t>(j), all.begin() + static_cast<std::ptrdiff_t>(i),
              pace::kBroken);
  }
  return all;
}

// R at rest: the median, as the variance is larger where a change of rate was only suspected. Of an axis that
// hardly rests, what third differences leave of its motion.
double noise_of(Pass& forwards, std::span<const double> rate, double told) {
  std::vector<double>& noises = forwards.noises;
  if (noises.size() >= kEnoughRest) {
    const auto middle = noises.begin() + static_cast<std::ptrdiff_t>(noises.size() / 2);
    std::nth_element(noises.begin(), middle, noises.end());
    return *middle;
  }
  const double rough = roughness(rate);
  return std::isfinite(rough) && rough > 0.0 ? rough : told;
}

// settings: of this axis.
Smoothed smooth_axis(const FilterSettings& settings, std::span<const double> rate,
                     std::span<const double> dt_s, double period_s) {
  const std::size_t length = rate.size();
  Pass forwards = run(settings, rate, dt_s, period_s, false);
  std::vector<float> memories = moving(forwards, run(settings, rate, dt_s, period_s, true));
  const double noise = noise_of(forwards, rate, settings.measurement_noise);
  // At rest the walk is the model's. One with more states walks as its least gain says.
  std::vector<double> walk(length), steps(length);
  for (std::size_t i = 0; i < length; ++i) {
    walk[i] = settings.state == "random-walk" ? settings.process_noise * dt_s[i]
                                              : walk_of(forwards.least_gain, noise);
    steps[i] = dt_s[i] / period_s;
  }
  RateCourse course{rate, walk, steps, {}};
  const double lag = std::sqrt(noise / (settings.process_noise * period_s));
  find_paces(course, noise, std::max(kLeastBehind, lag), memories);
  course.memories = memories;
  return smooth_course(course, noise);
}

}  // namespace

std::vector<Smoothed> smooth(const FilterSettings& settings, const std::optional<Axes>& walk_share,
                             std::span<const std::vector<double>> rates, std::span<const double> dt_s,
                             double nominal_period_s) {
  // What is told is of the mean of all axes; of each it is as much more as its noise is rougher.
  std::vector<double> rough;
  double mean = 0.0, known = 0.0;
  for (const std::vector<double>& rate : rates) {
    const double own = roughness(rate);
    rough.push_back(std::isfinite(own) ? own : 0.0);
    if (!(rough.back() > 0.0)) continue;
    known += 1.0;
    mean += (rough.back() - mean) / known;
  }
  std::vector<Smoothed> all;
  for (std::size_t a = 0; a < rates.size(); ++a) {
    FilterSettings own = settings;
    const double louder = rough[a] > 0.0 ? rough[a] / mean : 1.0;
    own.measurement_noise *= louder;
    own.process_noise *= walk_share ? (*walk_share)[a] : louder;
    all.push_back(smooth_axis(own, rates[a], dt_s, nominal_period_s));
  }
  return all;
}

}  // namespace ifog
