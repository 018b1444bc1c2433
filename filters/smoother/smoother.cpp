// SPDX-License-Identifier: Apache-2.0
#include "filters/smoother/smoother.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "filters/estimator/estimator.h"
#include "filters/smoother/lone_outliers.h"
#include "filters/smoother/motion_pace.h"
#include "filters/smoother/rest_likelihood.h"
#include "filters/smoother/roughness.h"

namespace ifog {
namespace {

// A gain of one has no walk that makes it; this one follows every sample.
constexpr double kMostGain = 0.999;
// Between where a manoeuvre is found forwards and where it is found backwards it is under way; further apart
// they are two.
constexpr std::size_t kFurthest = 100'000;
// An outlier that is one whatever the other direction says of it, sigma.
constexpr double kFarAway = 20.0;
// A motion is looked at over this many samples at least, however quick the filter at rest is.
constexpr double kLeastBehind = 48.0;

// What one direction finds a sample of one axis to be.
enum class Found : std::uint8_t { rest, kept_out, far_out, motion };

// One direction of one axis.
struct Pass {
  FiledVector<Found> found;
  double least_gain = kMostGain;
};

// One axis of a record.
struct Axis {
  std::span<const double> rate, dt_s;
  double period_s;
};

Found found(const EstimatorOutput& out) {
  if ((out.flags & kManoeuvre) != 0) return Found::motion;
  if ((out.flags & kGated) == 0) return Found::rest;
  const double innovation = out.innovation_radps[0];
  return innovation * innovation > kFarAway * kFarAway * out.innovation_variance[0] ? Found::far_out
                                                                                    : Found::kept_out;
}

Pass run(const FilterSettings& settings, const Axis& axis, bool backwards) {
  const std::size_t length = axis.rate.size();
  Estimator estimator(settings, 1, axis.period_s);
  EstimatorInput in;
  EstimatorOutput out;
  Pass pass;
  pass.found.resize(length);
  for (std::size_t k = 0; k < length; ++k) {
    const std::size_t i = backwards ? length - 1 - k : k;
    in.sequence = i;
    // Backwards the time to this sample is what forwards is the time to the one after it.
    in.dt_s = backwards && i + 1 < length ? axis.dt_s[i + 1] : axis.dt_s[i];
    in.covered_s[0] = std::min(in.dt_s, axis.period_s);
    in.valid_axes = std::isfinite(axis.rate[i]) ? 1U : 0U;
    in.rate_radps[0] = axis.rate[i];
    estimator.step(in, out);
    pass.found[i] = found(out);
    const double gain = std::min(out.gain[0], kMostGain);
    if (pass.found[i] != Found::rest || !(gain > 0.0)) continue;
    pass.least_gain = std::min(pass.least_gain, gain);
  }
  return pass;
}

// The walk that would settle the filter's gain at K: Q/R = K^2 / (1-K).
double walk_of(double gain, double noise) { return noise * gain * gain / (1.0 - gain); }

// Where it moves in either direction, and from where a change was found forwards back to where it was found
// backwards.
FiledVector<float> moving(const Pass& forwards, const Pass& backwards) {
  FiledVector<float> all(forwards.found.size(), pace::kRest);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (forwards.found[i] == Found::motion || backwards.found[i] == Found::motion) all[i] = pace::kBroken;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (forwards.found[i] != Found::motion || forwards.found[i - 1] == Found::motion) continue;
    const std::size_t least = i > kFurthest ? i - kFurthest : 0;
    std::size_t j = i;
    while (j > least && backwards.found[j - 1] != Found::motion) --j;
    if (j == least) continue;
    std::fill(all.begin() + static_cast<std::ptrdiff_t>(j), all.begin() + static_cast<std::ptrdiff_t>(i),
              pace::kBroken);
  }
  return all;
}

// By one direction the scale of the noise may not be known yet.
bool is_out(Found forwards, Found backwards) {
  const auto kept_out = [](Found found) { return found == Found::kept_out || found == Found::far_out; };
  return (kept_out(forwards) && kept_out(backwards)) || forwards == Found::far_out ||
         backwards == Found::far_out;
}

// Without outliers. The first of a jump is kept out in one direction and of the motion that both find.
Samples believed(const Axis& axis, const Pass& forwards, const Pass& backwards,
                 std::span<const float> memories, std::span<const double> steps, double noise) {
  Samples out(axis.rate);
  std::vector<std::size_t> lone;
  for (std::size_t i = 0; i < out.size();) {
    std::size_t end = i + 1;
    if (memories[i] <= pace::kRest) {
      if (is_out(forwards.found[i], backwards.found[i])) out[i] = std::nan("");
    } else {
      while (end < out.size() && memories[end] > pace::kRest) ++end;
      find_lone_outliers(axis.rate, steps, noise, i, end, lone);
    }
    i = end;
  }
  for (const std::size_t i : lone) out[i] = std::nan("");
  return out;
}

// Where it rests. walk: as it is known, 0: to be found.
RestOfRecord rest_of(std::span<const double> rate, std::span<const float> memories, double walk) {
  RestLikelihood rest;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    if (memories[i] <= pace::kRest && std::isfinite(rate[i])) rest.take(rate[i]);
    if (memories[i] > pace::kRest && i > 0 && memories[i - 1] <= pace::kRest) rest.break_off();
  }
  rest.finish();
  return rest.fit(walk);
}

// settings: of this axis; steps: its times, nominal samples.
Smoothed smooth_axis(const FilterSettings& settings, bool learn_walk, const Axis& axis,
                     std::span<const double> steps) {
  const std::size_t length = axis.rate.size();
  const Pass forwards = run(settings, axis, false);
  const Pass backwards = run(settings, axis, true);
  FiledVector<float> memories = moving(forwards, backwards);
  const double rough = roughness(axis.rate, steps);
  const double told = std::isfinite(rough) && rough > 0.0 ? rough : settings.measurement_noise;
  const Samples rate = believed(axis, forwards, backwards, memories, steps, told);
  // At rest the walk is the model's. One with more states walks as its least gain says.
  const bool random_walk = settings.state == "random-walk";
  const double known =
      random_walk ? settings.process_noise * axis.period_s : walk_of(forwards.least_gain, told);
  const RestOfRecord rest = rest_of(rate, memories, learn_walk && random_walk ? 0.0 : known);
  const double noise = rest.noise > 0.0 ? rest.noise : told;
  const double walked = rest.noise > 0.0 ? rest.walk : known;
  Samples walk(length);
  for (std::size_t i = 0; i < length; ++i) walk[i] = walked * steps[i];
  RateCourse course{rate, walk, steps, {}};
  find_paces(course, noise, std::max(kLeastBehind, std::sqrt(noise / walked)), memories);
  course.memories = memories;
  return smooth_course(course, noise);
}

// Each axis's noise over the mean of all, by its roughness; 1 where that is not known.
std::vector<double> loudness(std::span<const std::span<const double>> rates, std::span<const double> steps) {
  std::vector<double> rough;
  double mean = 0.0, known = 0.0;
  for (const std::span<const double> rate : rates) {
    const double own = roughness(rate, steps);
    rough.push_back(std::isfinite(own) ? own : 0.0);
    if (!(rough.back() > 0.0)) continue;
    known += 1.0;
    mean += (rough.back() - mean) / known;
  }
  for (double& own : rough) own = own > 0.0 ? own / mean : 1.0;
  return rough;
}

}  // namespace

std::vector<Smoothed> smooth(const FilterSettings& settings, const AxisNoise& noise,
                             std::span<const std::span<const double>> rates, std::span<const double> dt_s,
                             double nominal_period_s) {
  Samples steps(dt_s.size());
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = dt_s[i] / nominal_period_s;
  const std::vector<double> rough = loudness(rates, steps);
  std::vector<Smoothed> all;
  for (std::size_t a = 0; a < rates.size(); ++a) {
    const double louder = noise.noise_share ? (*noise.noise_share)[a] : rough[a];
    FilterSettings own = settings;
    own.measurement_noise *= louder;
    own.process_noise *= noise.walk_share ? (*noise.walk_share)[a] : louder;
    all.push_back(smooth_axis(own, noise.learn_walk, {rates[a], dt_s, nominal_period_s}, steps));
  }
  return all;
}

}  // namespace ifog
