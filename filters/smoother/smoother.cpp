// SPDX-License-Identifier: Apache-2.0
#include "filters/smoother/smoother.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "filters/estimator/estimator.h"
#include "filters/smoother/motion_pace.h"
#include "filters/state_models/state_model.h"

namespace ifog {
namespace {

// Limit: no random walk has a gain of one.
constexpr double kMostGain = 0.999;
// The sensor moves between the forward and the backward detection of a manoeuvre; if they are further apart
// they are two manoeuvres.
constexpr std::size_t kFurthest = 100'000;
// sigma; an outlier regardless of the other direction.
constexpr double kFarAway = 20.0;
// Smallest horizon of a motion in samples, for any filter at rest.
constexpr double kLeastBehind = 48.0;

// Flags of a sample in one direction.
using Found = std::uint8_t;
constexpr Found kMotion = 1, kOutlier = 2, kFarOutlier = 4;

struct Pass {
  Column<Found> found;
  double least_gain = kMostGain;
  LearnedNoise learned;
};

// One axis of a record.
struct Axis {
  std::span<const double> rate, dt_s;
  double period_s;
};

Found found(const EstimatorOutput& out) {
  Found found = (out.flags & kManoeuvre) != 0 ? kMotion : 0;
  if ((out.flags & kGated) == 0) return found;
  found |= kOutlier;
  const double innovation = out.innovation_radps[0];
  if (innovation * innovation > kFarAway * kFarAway * out.innovation_variance[0]) found |= kFarOutlier;
  return found;
}

Pass run(const FilterSettings& settings, const Axis& axis, bool learn_walk, bool backwards) {
  const std::size_t length = axis.rate.size();
  Estimator estimator(settings, 1, axis.period_s, {.walk_share = {}, .learns_walk = learn_walk});
  EstimatorInput in;
  EstimatorOutput out;
  Pass pass;
  pass.found.resize(length);
  for (std::size_t k = 0; k < length; ++k) {
    const std::size_t i = backwards ? length - 1 - k : k;
    in.sequence = i;
    // Backwards, the time step of a sample is that of the one after it.
    in.dt_s = backwards && i + 1 < length ? axis.dt_s[i + 1] : axis.dt_s[i];
    in.covered_s[0] = std::min(in.dt_s, axis.period_s);
    in.valid_axes = std::isfinite(axis.rate[i]) ? 1U : 0U;
    in.rate_radps[0] = axis.rate[i];
    estimator.step(in, out);
    pass.found[i] = found(out);
    const double gain = std::min(out.gain[0], kMostGain);
    if (pass.found[i] != 0 || !(gain > 0.0)) continue;
    pass.least_gain = std::min(pass.least_gain, gain);
  }
  pass.learned = estimator.learned();
  return pass;
}

// Noise of a measurement with the model's colour, as if white: its variance, or the density of long means (the sum of
// the autocovariances), whichever is larger. In units of the white part.
double whole_noise(const FilterSettings& settings, double period_s) {
  const auto model = make_state_model(settings.state, settings.state_parameters, period_s);
  const int n = model->states();
  Eigen::MatrixXd transition(n, n), driving(n, n);
  model->discretise(period_s, transition, driving);
  const Eigen::VectorXd h = model->measurement();
  const Eigen::MatrixXd colour = settings.process_noise * model->colour();
  const auto coloured = (colour.diagonal().array() > 0.0).cast<double>().matrix().asDiagonal();
  const Eigen::MatrixXd sums = Eigen::MatrixXd::Identity(n, n) - coloured * transition * coloured;
  const double variance = h.dot(colour * h);
  const double density = 2.0 * h.dot(sums.partialPivLu().solve(colour * h)) - variance;
  return 1.0 + std::max(variance, density) / settings.measurement_noise;
}

// Walk for which the filter's steady-state gain is K: Q/R = K^2 / (1-K).
double walk_of(double gain, double noise) { return noise * gain * gain / (1.0 - gain); }

// Moving in either direction, and between a forward detection and the backward detection before it.
Column<float> moving(const Pass& forwards, const Pass& backwards) {
  Column<float> all(forwards.found.size(), pace::kRest);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (((forwards.found[i] | backwards.found[i]) & kMotion) != 0) all[i] = pace::kBroken;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if ((forwards.found[i] & kMotion) == 0 || (forwards.found[i - 1] & kMotion) != 0) continue;
    const std::size_t least = i > kFurthest ? i - kFurthest : 0;
    std::size_t j = i;
    while (j > least && (backwards.found[j - 1] & kMotion) == 0) --j;
    if (j == least) continue;
    std::fill(all.begin() + j, all.begin() + i, pace::kBroken);
  }
  return all;
}

// Rejected in both directions, or at rest in one direction if far away. The first measurement of a jump is
// rejected in one direction only.
bool is_outlier(Found forwards, Found backwards, bool rests) {
  return (forwards & backwards & kOutlier) != 0 || (rests && ((forwards | backwards) & kFarOutlier) != 0);
}

// settings: of this axis; steps: its times, nominal samples.
Smoothed smooth_axis(FilterSettings settings, bool learn_walk, const Axis& axis,
                     std::span<const double> steps) {
  const std::size_t length = axis.rate.size();
  // The forward run starts with the noise learned by the backward run.
  const bool learns = learn_walk && settings.state == "random-walk";
  const double whole = whole_noise(settings, axis.period_s);
  const Pass backwards = run(settings, axis, learns, true);
  settings.measurement_noise = backwards.learned.measurement_noise;
  settings.process_noise = backwards.learned.process_noise;
  const Pass forwards = run(settings, axis, false, false);
  Column<float> memories = moving(forwards, backwards);
  Samples rate(axis.rate), walk(length);
  for (std::size_t i = 0; i < length; ++i)
    if (is_outlier(forwards.found[i], backwards.found[i], memories[i] <= pace::kRest)) rate[i] = std::nan("");
  const double noise = whole * settings.measurement_noise;
  // For a model of another rate the walk follows from its smallest gain.
  const double walked = settings.state.starts_with("random-walk") ? settings.process_noise * axis.period_s
                                                                  : walk_of(forwards.least_gain, noise);
  for (std::size_t i = 0; i < length; ++i) walk[i] = walked * steps[i];
  RateCourse course{rate, walk, steps, {}};
  find_paces(course, noise, std::max(kLeastBehind, std::sqrt(noise / walked)), memories);
  course.memories = memories;
  return smooth_course(course, noise);
}

}  // namespace

std::vector<Smoothed> smooth(const FilterSettings& settings, const AxisNoise& noise,
                             std::span<const std::span<const double>> rates, std::span<const double> dt_s,
                             double nominal_period_s) {
  Samples steps(dt_s.size());
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = dt_s[i] / nominal_period_s;
  std::vector<Smoothed> all;
  for (std::size_t a = 0; a < rates.size(); ++a) {
    const double louder = noise.noise_share ? (*noise.noise_share)[a] : 1.0;
    FilterSettings own = settings;
    own.measurement_noise *= louder;
    own.process_noise *= noise.walk_share ? (*noise.walk_share)[a] : louder;
    all.push_back(smooth_axis(own, noise.learn_walk, {rates[a], dt_s, nominal_period_s}, steps));
  }
  return all;
}

}  // namespace ifog
