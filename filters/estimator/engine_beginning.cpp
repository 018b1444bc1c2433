// SPDX-License-Identifier: Apache-2.0
// The engine from its first measurement to where it is known whether the sensor rests.
//
// A filter may begin anywhere in a motion. So nothing is taken for granted: the trackers follow from the
// first measurement on, with what they have had, and the filter at rest has part of what is published as its
// predictions earn it. Noise need not be known for that: what third differences and the settings say of it
// counts for as many degrees of freedom as it has.
#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/estimator/engine.h"

namespace ifog {
namespace {

// Samples missed after which no tracker that is quick foresees anything.
constexpr double kGap = 16.0;

}  // namespace

void Engine::begin() noexcept {
  motion_ = follow_manoeuvres_ ? Motion::beginning : Motion::at_rest;
  waiting_ = false;
  heard_before_ = knowledge_ == Knowledge::heard;
  forget_kept_out();
  surprised_ = {};
  mix_.begin(0.0);
}

void Engine::expect_noise(const Axes& share) noexcept {
  loudness_ = share;
  for (std::size_t a = 0; a < axes_; ++a) noise_[a] = NoiseScale(noise_of_one_ * share[a]);
}

void Engine::begin_axes(const Axes& rate, std::uint32_t valid) noexcept {
  const std::uint32_t fresh = valid & ~started_;
  if (fresh == 0) return;
  // One gain is for all axes, and of this one nothing is known yet.
  if (started_ != 0 && follow_manoeuvres_) {
    rest_->raise_to(rest_->rule().measurement_noise());
    since_moved_ = at_rest_for_ = 0.0;
    change_.restart();
    admit_kept_out();
    begin();
  }
  rest_->shift_to(rate, fresh);
  for (std::size_t a = 0; a < axes_; ++a) {
    if (has(fresh, a)) ledger_.refer(a, rate[a]);
  }
  // The trackers' first measurement is the first that all axes have had.
  trackers_.begin();
  started_ |= fresh;
}

// What the rate does while nobody looks is not known. The filter at rest has what it had, and earns its part
// anew. A motion goes on, and its trackers know themselves how long they foresee.
void Engine::begin_after_gap(const Measurement& m) noexcept {
  double covered_s = 0.0;
  for (std::size_t a = 0; a < axes_; ++a)
    if (has(m.valid, a)) covered_s = std::max(covered_s, m.covered_s(a));
  unmeasured_s_ += std::max(0.0, m.dt_s - covered_s);
  if (m.valid == 0) return;
  if (std::exchange(unmeasured_s_, 0.0) < kGap * period_s_ || knowledge_ == Knowledge::nothing) return;
  for (NoiseScale& noise : noise_) noise.break_off();
  if (in_manoeuvre()) return;
  trackers_.begin();
  admit_kept_out();
  outliers_.clear();
  begin();
}

// Outliers or a jump: nobody will tell any more, and measured they were.
void Engine::admit_kept_out() noexcept {
  for (std::size_t a = 0; a < axes_; ++a) ledger_.admit(a, kept_out(a));
  forget_kept_out();
}

// Where there was such a row a moment ago this one may belong to the same blow.
void Engine::begin_kept_out() noexcept {
  forget_kept_out();
  if (since_blow_ < kBlow) return;
  since_blow_ = 0.0;
  for (std::size_t a = 0; a < axes_; ++a) ledger_.mark(a);
}

void Engine::add_kept_out(const Measurement& m, std::size_t axis, double apart) noexcept {
  kept_out_[axis] += apart * m.covered_s(axis);
  kept_out_s_[axis] += m.covered_s(axis);
}

// An outlier it was, and no rotation, where this measurement is back: where it is nearer to what was kept out
// than to what was published, it goes on with that, and kept out was rotation. So were several in a row, as a
// blow's first half period is: outliers seldom come together, and what they add to the angle is paid slowly.
void Engine::book_kept_out(const Measurement& m) noexcept {
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(m.valid, a) || !(kept_out_s_[a] > 0.0)) continue;
    const double away = kept_out_[a] / kept_out_s_[a];
    const bool several = kept_out_s_[a] > 1.5 * m.covered_s(a);
    const bool on = several || (m.in.rate_radps[a] - published_.rate[a]) * away > 0.5 * away * away;
    if (!on) continue;
    ledger_.admit_at_rest(a, kept_out_[a]);
    if (hardly_tested(a)) untested_[a] += kept_out_[a];
  }
  forget_kept_out();
}

bool Engine::heard(std::uint32_t axes) const noexcept {
  for (std::size_t a = 0; a < axes_; ++a)
    if (has(axes, a) && !noise_[a].heard()) return false;
  return true;
}

void Engine::follow_beginning(const Measurement& m, const Surprise& now, EstimatorOutput& out) noexcept {
  Axes least{};
  const bool foreseen = trackers_.age(0) >= TrackerBank::kParabola;
  const bool far = foreseen && unforeseen(m, now, least) && heard(m.valid);
  hear(m);
  if (far && !waiting_) {
    wait(m, now, out);
    return;
  }
  if (far) {
    find_moving(m, out);
    begin_again(m, now, least);
    publish_mix(now);
    return;
  }
  if (m.valid == 0) {
    rest_->skip();
    if (knowledge_ == Knowledge::nothing)
      publish_rest();
    else
      publish_mix(now);
    return;
  }
  waiting_ = still_waiting(m.valid);
  if (!waiting_) book_kept_out(m);
  if (foreseen) {
    expect_surprise(least);
    // What is louder than it is rough may be the motion that it began in.
    constexpr Axes kWhite{1.0, 1.0, 1.0};
    mix_.judge(trackers_, now, least, kWhite);
  }
  const bool changed =
      heard(m.valid) && change_.take(trackers_, now, noise_, outliers_.most(), lag_samples());
  take_in(m, now);
  judge_beginning(m, changed && (m.valid & ~m.tested) == 0, out);
}

// Kept out until the next one says whether it was an outlier or the first of a jump.
void Engine::wait(const Measurement& m, const Surprise& now, EstimatorOutput& out) noexcept {
  out.flags |= kGated;
  ++health_.gated;
  waiting_ = published_.passed_over = true;
  forget_kept_out();
  waited_ = 0;
  waiting_rate_ = now.rate;
  waiting_axes_ = m.valid;
  waiting_for_ = unforeseen_axes_;
  rest_->skip();
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(m.valid, a)) continue;
    const double apart = m.in.rate_radps[a] - published_.rate[a];
    add_kept_out(m, a, apart);
    published_.variance[a] += apart * apart;
  }
}

void Engine::take_in(const Measurement& m, const Surprise& now) noexcept {
  for (std::size_t a = 0; a < axes_; ++a)
    if (has(m.valid, a) && !noise_[a].known())
      foresight_[a].take(trackers_, a, m.in.rate_radps[a], m.noise_scale);
  trackers_.correct(m.in.rate_radps, m.valid);
  // Of noise that was heard before nothing is learned: what is left may be a motion's that is not known yet.
  const bool first = knowledge_ == Knowledge::nothing, learns = !heard_before_;
  const double predicted = rest_->measurement_variance();
  update_rest(m, learns);
  if (!first) {
    learn_noise(m, learns ? m.valid : m.valid & ~m.tested);
    if (learns) average_rest(predicted);
  }
  mix_.weigh(trackers_);
  mix_.compare(trackers_, now);
  publish_mix(now);
  for (std::size_t a = 0; a < axes_; ++a) published_.variance[a] += mix_.rest_weight() * change_.unseen(a);
}

// Rest or motion is known where the noise is and one of them explains the measurements. Of coloured noise the
// trackers follow what is none, and as its sums are wider than white noise's by about its colour, so much
// more has to speak for motion; what is slower the test of changes will tell.
void Engine::judge_beginning(const Measurement& m, bool changed, EstimatorOutput& out) noexcept {
  double colour = 1.0;
  bool white = true;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(m.valid, a)) continue;
    if (!noise_[a].known()) return;
    white = white && noise_[a].white();
    colour = std::max(colour, noise_[a].colour());
  }
  if (changed || mix_.rest_ratio() < -ChangeTest::kEvidence * colour) {
    find_moving(m, out);
    judge_manoeuvre();
  } else if (mix_.rest_is_right() || !white) {
    come_to_rest();
    if (!white) change_.forget();
  }
}

bool Engine::hardly_known(std::uint32_t axes) const noexcept {
  for (std::size_t a = 0; a < axes_; ++a)
    if (has(axes, a) && noise_[a].colour_known()) return false;
  return true;
}

// Of one axis that is not the noise it was told all of them move.
void Engine::doubt_motion() noexcept {
  Axes mean{};
  double variance = 0.0;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(started_, a)) continue;
    if (!(doubted_motion_.count(a) > 0.0) ||
        !noise_[a].explains(doubted_motion_.variance(a), doubted_motion_.foreseen(a)))
      return;
    mean[a] = doubted_motion_.mean(a);
  }
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(started_, a)) continue;
    noise_[a].take_for_colour(doubted_motion_.variance(a));
    // Of a mean of noise whose neighbours are alike for as long as its colour says.
    variance = std::max(variance, noise_[a].rest() * noise_[a].colour() / doubted_motion_.count(a));
  }
  move_rest(mean, variance);
  come_to_rest();
  change_.forget();
}

// What was fallen short of until now is the manoeuvre's.
void Engine::find_moving(const Measurement& m, EstimatorOutput& out) noexcept {
  out.flags |= kManoeuvre;
  ++health_.manoeuvres;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (has(m.valid, a)) noise_[a].take_roughness();
    owe_to_manoeuvre(a, kBlow);
  }
  ledger_.pace(mix_.length(trackers_, rest_->gain()));
  motion_ = Motion::manoeuvre;
  forget_unmeasured(m.valid);
}

}  // namespace ifog
