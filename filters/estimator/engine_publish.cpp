// SPDX-License-Identifier: Apache-2.0
// What the engine publishes of a step, and what it learns of the noise by it.
#include <algorithm>
#include <cmath>

#include "filters/estimator/engine.h"

namespace ifog {
namespace {

// Samples between refreshes of the settled filter's lag, by the sequence so that a replay has them where the
// run had.
constexpr std::uint64_t kLagEvery = 256;
// Largest rate of a sensor at rest, rad/s: beyond the bias of any fibre-optic gyro, and 1.1 deg/s.
constexpr double kMostRestRate = 0.02;
// Lags of rest after which the end of a manoeuvre, and where it moved the filter to, have faded.
constexpr double kYoungLags = 7.0;
// Of the standard deviation of the filter at rest, that is paid: a quarter of its variance for as long as it takes.
constexpr double kMostPaid = 0.5;
// Known noise is replaced where a stretch differs by this factor.
constexpr double kOtherNoise = 2.0;
// Louder noise than is known has to be white for so long, and for two stretches.
constexpr double kLouder_s = 60.0, kLouderSamples = 8192.0;

}  // namespace

// Half of the variance is the measurements' noise, more where it is coloured, and half the walk's.
void Engine::publish_rest(Step& s) noexcept {
  s.rate = rest_->rate();
  s.gain = rest_->gain();
  s.variance.setConstant(rest_->variance());
  if (!settings_.follow_manoeuvres) return;
  Lanes wide = follow_.change.wide(follow_.trackers, lag());
  // The width is that of the known noise, of which a filter that follows coloured noise leaves less to its
  // rule.
  if (greatest(wide) > 1.0)
    wide = (wide > 1.0).select(wide * settings_.measurement_noise / rest_->rule().measurement_noise(), wide);
  const Lanes walk = learns_walk_ ? (shares_.walk * wide).eval() : shares_.walk;
  s.variance *= 0.5 * (walk + shares_.noise * wide);
  s.variance += follow_.change.unseen() + of_noise(&Noise::rounding);
}

void Engine::publish_mix(Step& s) noexcept {
  // A measurement's variance as it is heard: what is louder may be noise.
  const Lanes heard = of_noise(&Noise::known) * of_noise(&Noise::louder) * s.noise_scale;
  const Mix::Published mix = follow_.mix.publish(
      follow_.trackers, rest_->rate(), rest_->variance() * shares_.noise, s.sample.scale.max(heard));
  s.rate = mix.rate;
  s.variance = mix.variance;
  s.gain = mix.gain + follow_.mix.rest_weight() * rest_->gain();
}

// Books what the rate falls short of, and adds the payment of this sample.
void Engine::pay(Step& s) noexcept {
  using enum Ledger::Account;
  Follower& f = follow_;
  Ledger& ledger = f.ledger;
  const bool follows = settings_.follow_manoeuvres;
  // Until it has settled nothing that the filter lags behind by returns by itself.
  f.at_rest_for = f.moving ? 0.0 : f.at_rest_for + 1.0;
  if (!s.outlier) {
    const bool settled = follows && f.at_rest_for >= kYoungLags * std::max(settled_lag_, 1.0 / rest_->gain());
    if (settled && !f.settled) f.change.forget_angle();
    f.settled = settled;
  }
  ledger.book((s.sample.rate - s.rate) * s.sample.mask * s.sample.covered_s, s.outlier   ? kDoubt
                                                                             : f.moving  ? kDebt
                                                                             : f.settled ? kCarried
                                                                                         : kTail);
  if (f.moving) ledger.pace(f.mix.length(f.trackers, lag()));
  ledger.pace_tail(lag());
  // What a gap hides is no angle.
  const Lanes dt_s = (s.sample.mask > 0.0).select(s.sample.covered_s, Lanes::Constant(s.dt_s));
  Lanes most = Lanes::Constant(1e300);
  if (follows) most = kMostPaid * (rest_->variance() * shares_.noise).sqrt();
  const Lanes paid = ledger.pay(most, dt_s);
  s.rate += paid;
  if (follows) s.variance = s.variance.max(paid * paid);
}

bool Engine::rests(const Step& s) const noexcept {
  if (!settings_.follow_manoeuvres || follow_.moving || s.outlier || s.sample.valid == 0 ||
      follow_.since_moved < kRestMemory || follow_.change.suspected())
    return false;
  return (rest_->rate().abs() * mask_of(started_) <= kMostRestRate).all();
}

// The noise: at rest its walk, and R where that is less than is known; in a manoeuvre R, where what looks
// like one is white over every octave for a minute.
void Engine::learn(const Step& s) noexcept {
  if (!settings_.follow_manoeuvres) return;
  const bool rest = (s.out.flags & kAtRest) != 0, gap = s.dt_s > kShortGap * period_s_;
  if (gap || (rest && !follow_.moving && s.noise_scale != 1.0)) walk_.break_off();
  if (s.outlier || (!rest && !follow_.moving)) return;
  walk_.set_stretch(rest ? Walk::kStretch : std::max(kLouderSamples, kLouder_s / period_s_));
  walk_.take(s.in.rate_radps, s.sample.valid, rest);
  const std::optional<Walk::Found> found = walk_.take_news();
  if (!found) return;
  bool other = false;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!(found->noise[a] > 0.0) || !found->white) continue;
    const double heard = found->noise[a], known = noise_[a].known();
    if (rest ? kOtherNoise * heard < known : heard > kOtherNoise * known) {
      noise_[a].set_known(heard);
      other = true;
    }
  }
  if (other) {
    refresh_shares();
    rest_->rule().restart();
  }
  if (!learns_walk_) return;
  settings_.process_noise = found->ratio * shares_.mean_noise / period_s_;
  rest_->retune(settings_.process_noise);
}

// The filter's variance is of the axes that are measured.
void Engine::know_unmeasured(const Step& s, double grown) noexcept {
  for (std::size_t a = 0; a < axes_; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    if ((s.sample.valid >> a & 1U) != 0)
      unmeasured_.measure(a, s.gain, s.variance[i], s.sample.rate[i] - s.rate[i], s.sample.scale[i]);
    else if (s.sample.valid == 0 && !follow_.moving)
      unmeasured_.miss_with_all(a, grown * shares_.walk[i]);
    else if ((started_ >> a & 1U) != 0)
      unmeasured_.miss(a, grown * shares_.walk[i], to_axes(s.rate), to_axes(s.variance));
  }
}

void Engine::publish(const Step& s) noexcept {
  for (std::size_t a = 0; a < axes_; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    const double variance = unmeasured_.variance(a, s.variance[i]);
    s.out.denoised_radps[a] = s.rate[i];
    // A rule without a floor may take the covariance below zero: it then says no more than one measurement
    // does.
    s.out.variance_rad2ps2[a] = variance >= 0.0 ? variance : settings_.measurement_noise;
    s.out.gain[a] = s.gain;
    s.out.innovation_variance[a] =
        rest_->covariance() * (settings_.follow_manoeuvres ? shares_.noise[i] : 1.0);
    health_.measurement_noise[a] =
        settings_.follow_manoeuvres
            ? rest_->rule().measurement_noise() * noise_[a].known() / settings_.measurement_noise
            : rest_->rule().measurement_noise();
    health_.colour[a] = noise_[a].colour();
  }
  health_.floor_hits = rest_->rule().floor_hits();
  if (s.in.sequence % kLagEvery == 0 || settled_lag_ == 0.0) refresh_lag();
  health_.group_delay_s = period_s_ * settled_lag_ *
                          (follow_.moving && settings_.follow_manoeuvres ? follow_.mix.rest_weight() : 1.0);
}

// The lag of the filter at rest once it has settled.
void Engine::refresh_lag() noexcept {
  const Settled now = rest_->settled();
  if (!std::isfinite(now.lag) || !std::isfinite(now.correlation)) return;
  settled_lag_ = now.lag;
  health_.correlation_time_s = now.correlation * period_s_;
  follow_.trackers.reach(lag());
}

}  // namespace ifog
