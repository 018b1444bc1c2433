// SPDX-License-Identifier: Apache-2.0
// The engine under way: from a change of rate that was found to the end of the motion.
#include <algorithm>
#include <cmath>

#include "filters/estimator/engine.h"

namespace ifog {
namespace {

// In a manoeuvre a measurement waits for the next one when the filter at rest and all trackers find it this
// many sigmas away, or of what has lately been the least.
constexpr double kFar = 5.5;
constexpr double kSurpriseMemory = 20.0;
constexpr double kMostSurprise = 400.0;

}  // namespace

// The filter at rest stands where it is told, with that variance, as if it had been raised when the rate
// changed and had filtered since. What its lag owes then is not returned by it.
void Engine::move_rest(const Axes& rate, double variance) noexcept {
  rest_->shift_rate_to(rate, started_);
  rest_->raise_to(variance);
  for (std::size_t a = 0; a < axes_; ++a) ledger_.refer(a, rest_->rate(a));
  since_moved_ = at_rest_for_ = 0.0;
}

// All is begun with these measurements.
void Engine::forget_unmeasured(std::uint32_t valid) noexcept {
  for (std::size_t a = 0; a < axes_; ++a)
    if (has(valid, a)) unmeasured_.forget(a);
}

// It began with what was kept out a moment ago, longer ago than the test has looked back.
bool Engine::of_blow(std::size_t axis, double seen_over) const noexcept {
  return since_blow_ < kBlow && since_blow_ >= seen_over && !hardly_tested(axis);
}

// What a change of rate that was just found has left behind beside what the test has seen of it. seen_over:
// samples that the test has looked back on.
void Engine::owe_to_manoeuvre(std::size_t axis, double seen_over) noexcept {
  if (of_blow(axis, seen_over)) ledger_.move_to_manoeuvre(axis, ledger_.since_mark(axis));
  ledger_.admit(axis, kept_out_[axis]);
  kept_out_[axis] = kept_out_s_[axis] = 0.0;
  ledger_.move_to_manoeuvre(axis, untested_[axis]);
  untested_[axis] = 0.0;
  noise_[axis].follow_motion();
}

// Measurements that looked like outliers are a jump: all begin with them.
void Engine::jump(EstimatorOutput& out) noexcept {
  out.flags |= kManoeuvre;
  ++health_.manoeuvres;
  const std::span<const Axes> run = outliers_.run();
  const auto count = static_cast<double>(run.size());
  Axes mean{};
  for (std::size_t a = 0; a < axes_; ++a) {
    for (const Axes& rate : run) mean[a] += rate[a] / count;
    owe_to_manoeuvre(a, 0.0);
  }
  since_blow_ = kBlow;
  ledger_.pace(count);
  trackers_.begin(run);
  move_rest(mean, rest_->rule().measurement_noise() / count);
  rest_->skip();
  outliers_.clear();
  mix_.begin(0.0);
  motion_ = Motion::manoeuvre;
  surprised_ = {};
  published_.gain = 1.0 / count;
  for (std::size_t a = 0; a < axes_; ++a) {
    published_.rate[a] = rest_->rate(a);
    published_.variance[a] = rest_variance(a);
  }
}

void Engine::begin_manoeuvre(const Measurement& m, std::size_t tracker, EstimatorOutput& out) noexcept {
  out.flags |= kManoeuvre;
  ++health_.manoeuvres;
  Axes rate{};
  const double seen_over = ChangeTest::horizon(trackers_.memory(tracker));
  for (std::size_t a = 0; a < axes_; ++a) {
    rate[a] = trackers_.rate(tracker, a);
    // What the test has seen is among what it was too blunt for, and of a blow.
    if (!hardly_tested(a) && !of_blow(a, seen_over))
      ledger_.move_to_before(a, change_.fallen_short(tracker, a), seen_over);
    owe_to_manoeuvre(a, seen_over);
  }
  since_blow_ = kBlow;
  ledger_.pace(trackers_.length(tracker));
  mix_.begin(std::min(since_moved_, ChangeTest::horizon(trackers_.memory(tracker))));
  trackers_.begin_from(std::min(tracker + 1, trackers_.size()), tracker);
  double scale = 0.0;
  for (std::size_t a = 0; a < axes_; ++a) scale = std::max(scale, noise_[a].now());
  move_rest(rate, trackers_.output_factor(tracker) * scale);
  motion_ = Motion::manoeuvre;
  forget_unmeasured(m.valid);
  update_rest(m, false);
  outliers_.clear();
  surprised_ = {};
  publish_rest();
}

// Whether nobody foresaw this measurement, by what has lately surprised the best of all.
bool Engine::unforeseen(const Measurement& m, const Surprise& now, Axes& least) noexcept {
  bool far = false;
  unforeseen_axes_ = 0;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(now.valid, a)) continue;
    double smallest = 1e300;
    for (std::size_t j = 0; j < trackers_.size(); ++j) {
      const double apart = m.in.rate_radps[a] - trackers_.rate(j, a);
      // Of who knows nothing any more nothing is unforeseen.
      if (!trackers_.foresees(j, a)) smallest = 0.0;
      smallest = std::min(smallest, apart * apart / (trackers_.factor(j, a) * now.scale[a]));
    }
    least[a] = smallest;
    const double own = m.innovation[a] * m.innovation[a] / (now.rest_factor * now.scale[a]);
    far = far || own > kFar * kFar;
    if (smallest > kFar * kFar * std::max(1.0, surprised_[a])) unforeseen_axes_ |= 1U << a;
  }
  return far && unforeseen_axes_ != 0;
}

// An axis that has not come for long may be gone for good.
bool Engine::still_waiting(std::uint32_t valid) noexcept {
  return waiting_ && (valid & waiting_for_) == 0 && ++waited_ <= OutlierRun::kMost;
}

void Engine::expect_surprise(const Axes& least) noexcept {
  for (std::size_t a = 0; a < axes_; ++a)
    surprised_[a] += (std::min(least[a], kMostSurprise) - surprised_[a]) / kSurpriseMemory;
}

// A blow goes on as it began, and its next sample is no outlier for being as far off. An axis that has only
// one of the two measurements has been there all along.
void Engine::begin_again(const Measurement& m, const Surprise& now, const Axes& least) noexcept {
  std::array<Axes, 2> both{waiting_rate_, now.rate};
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(m.valid, a))
      both[1][a] = both[0][a];
    else if (!has(waiting_axes_, a))
      both[0][a] = both[1][a];
  }
  trackers_.begin(both);
  forget_unmeasured(m.valid);
  double scale = 0.0;
  for (std::size_t a = 0; a < axes_; ++a) {
    surprised_[a] = std::max(surprised_[a], least[a]);
    scale = std::max(scale, noise_[a].now());
  }
  move_rest(both[1], scale);
  mix_.begin(0.0);
  motion_ = Motion::manoeuvre;
  waiting_ = false;
  rest_->skip();
  mix_.weigh(trackers_);
}

void Engine::follow_manoeuvre(const Measurement& m, const Surprise& now, EstimatorOutput& out) noexcept {
  out.flags |= kManoeuvre;
  Axes least{};
  const bool unforeseen_now = unforeseen(m, now, least);
  hear(m);
  if (unforeseen_now && !waiting_) {
    out.flags |= kGated;
    ++health_.gated;
    waiting_ = true;
    waited_ = 0;
    waiting_rate_ = now.rate;
    waiting_axes_ = m.valid;
    waiting_for_ = unforeseen_axes_;
    rest_->skip();
    for (std::size_t a = 0; a < axes_; ++a) published_.variance[a] += m.innovation[a] * m.innovation[a];
    return;
  }
  if (unforeseen_now) {
    begin_again(m, now, least);
    publish_mix(now);
    return;
  }
  if (m.valid == 0) {
    rest_->skip();
    publish_mix(now);
    return;
  }
  waiting_ = still_waiting(m.valid);
  expect_surprise(least);
  mix_.judge(trackers_, now, least, colours());
  if (hardly_known(m.valid)) doubted_motion_.take(trackers_, m.in.rate_radps, m.valid, m.noise_scale);
  trackers_.correct(m.in.rate_radps, m.valid);
  update_rest(m, false);
  mix_.weigh(trackers_);
  mix_.compare(trackers_, now);
  publish_mix(now);
  ledger_.pace(mix_.length(trackers_, rest_->gain()));
  judge_manoeuvre();
  if (in_manoeuvre() && doubted_motion_.complete()) doubt_motion();
}

// Where there was motion lately it may go on, and is no colour; but where no colour is known yet there may
// have been none, and of what is to be learned it is found.
std::uint32_t Engine::learning(std::uint32_t valid) const noexcept {
  if (!change_.lately_moved()) return valid;
  for (std::size_t a = 0; a < axes_; ++a)
    if (noise_[a].colour_known()) valid &= ~(1U << a);
  return valid;
}

// Of noise that is white, or may be, 1.
Axes Engine::colours() const noexcept {
  Axes colour{};
  for (std::size_t a = 0; a < axes_; ++a)
    colour[a] = noise_[a].white() || !noise_[a].colour_known() ? 1.0 : noise_[a].colour();
  return colour;
}

// Who is to begin afresh, and whether the motion is over.
void Engine::judge_manoeuvre() noexcept {
  if (mix_.rest_is_wrong()) {
    double variance = 0.0, scale = 0.0;
    for (std::size_t a = 0; a < axes_; ++a) {
      variance = std::max(variance, published_.variance[a]);
      scale = std::max(scale, noise_[a].now());
    }
    move_rest(published_.rate, std::min(variance, scale));
    mix_.begin_rest();
  }
  if (const std::size_t broken = mix_.broken(trackers_); broken < trackers_.size())
    trackers_.begin_from(broken, broken - 1);
  if (mix_.rest_is_right()) {
    change_.restart();
    come_to_rest();
  }
}

void Engine::come_to_rest() noexcept {
  motion_ = Motion::at_rest;
  doubted_motion_ = {};
  outliers_.clear();
  publish_rest();
}

void Engine::publish_mix(const Surprise& now) noexcept {
  published_.gain = mix_.gain(trackers_, rest_->gain());
  for (std::size_t a = 0; a < axes_; ++a) {
    const double rest = rest_->rate(a), variance = rest_variance(a);
    const double scale = now.scale[a] > 0.0 ? now.scale[a] : health_.measurement_noise[a];
    published_.rate[a] = mix_.rate(trackers_, a, rest);
    const MotionMix::Doubt doubt = mix_.doubt(trackers_, a, rest, variance, scale);
    published_.variance[a] = doubt.noise + doubt.bias + doubt.other;
    if (!conserve_angle_) continue;
    published_.shared[a] = ledger_.common() * doubt.noise;
    published_.returned[a] = doubt.bias;
  }
}

}  // namespace ifog
