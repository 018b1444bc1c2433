// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/engine.h"

#include <algorithm>
#include <cmath>

namespace ifog {
namespace {

// Samples between updates of the lag; by sequence number, so that a replay updates at the same samples.
constexpr std::uint64_t kLagEvery = 256;
// Largest rate at rest, rad/s (1.1 deg/s): above the bias of any fibre-optic gyro.
constexpr double kMostRestRate = 0.02;
// Lags at rest after which the end of a manoeuvre has faded from the filter.
constexpr double kYoungLags = 7.0;
// Largest payment / standard deviation of the filter at rest; costs 25 % of its variance.
constexpr double kMostPaid = 0.5;

}  // namespace

Engine::Engine(const FilterSettings& settings, const KnownNoise& known, std::unique_ptr<RestFilter> rest,
               int axes, double period_s)
    : settings_(settings),
      smooths_(settings.wideband == "noise"),
      follows_(settings.follow_manoeuvres && (rest->rate_alone() || rest->rule().hypotheses().size() == 1)),
      axes_(static_cast<std::size_t>(axes)),
      period_s_(period_s),
      rest_(std::move(rest)),
      noise_(settings, known, axes_, period_s, rest_->colour_variance()),
      begins_(axes_, period_s, follows_, *rest_),
      follow_(begins_) {}

void Engine::restart() noexcept {
  rest_->restart();
  const Lanes owed = follow_.ledger.owed();
  follow_ = begins_;
  if (owed.abs().sum() > 0.0) follow_.ledger.owe(owed);
  noise_.gap();
  started_ = 0;
  unmeasured_ = {};
}

Axes Engine::owed() const noexcept {
  if (!settings_.conserve_angle) return {};
  return to_axes(follow_.ledger.owed());
}

void Engine::owe(const Axes& angle_rad) noexcept {
  const Lanes angle = to_lanes(angle_rad);
  if (angle.allFinite() && (angle != 0.0).any()) follow_.ledger.owe(angle);
}

void Engine::step(const EstimatorInput& in, EstimatorOutput& out) noexcept {
  out.flags = 0;
  Step s{in,
         out,
         in.dt_s > 0.0 ? in.dt_s : period_s_,
         in.averaged_s > 0.0 ? period_s_ / in.averaged_s : 1.0,
         {}};
  screen(s);
  const double before = rest_->rate().variance;
  rest_->predict(s.dt_s);
  const double grown = std::max(0.0, rest_->rate().variance - before);
  begin_axes(s);
  if (settings_.follow_manoeuvres) {
    follow_.trackers.predict(s.dt_s / period_s_);
    noise_.take(s.sample, follow_.trackers.since());
    weigh(s);
    follow(s);
  } else {
    weigh(s);
    take(s, true);
    publish_rest(s);
  }
  if (settings_.guard) guard(s);
  if (follow_.in_manoeuvre()) out.flags |= kManoeuvre;
  if (rests(s)) out.flags |= kAtRest;
  learn(s);
  unmeasured_.take(s.sample, s.rate, s.variance, s.gain, grown * noise_.walk_share(), started_);
  follow_.published = s.rate;
  if (settings_.conserve_angle) pay(s);
  publish(s);
}

// Determines the axes with a usable measurement.
void Engine::screen(Step& s) noexcept {
  for (std::size_t a = 0; a < axes_; ++a) {
    if ((s.in.valid_axes >> a & 1U) == 0 || !std::isfinite(s.in.rate_radps[a])) continue;
    if ((s.in.stuck_axes >> a & 1U) != 0) {
      s.out.flags |= kStuck;
      continue;
    }
    s.sample.valid |= 1U << a;
    s.sample.rate[static_cast<Eigen::Index>(a)] = s.in.rate_radps[a];
  }
  s.sample.mask = mask_of(s.sample.valid);
}

// The first measurement of an axis sets its state.
void Engine::begin_axes(const Step& s) noexcept {
  Follower& f = follow_;
  // After a gap the rate is unknown, so the filter at rest must be confirmed by measurements.
  if (follows_ && !f.moving && s.sample.valid != 0 && s.dt_s > kShortGap * period_s_) {
    f.moving = true;
    f.failed_nats = 0.0;
    f.ledger.admit();
    f.mix.begin_from_rest();
    f.change.begin();
  }
  const std::uint32_t first = s.sample.valid & ~started_;
  if (first == 0) return;
  rest_->shift_to(s.sample.rate, first);
  f.trackers.seed(s.sample.rate, mask_of(first));
  // An axis that starts later restarts the common gain.
  if (follows_ && started_ != 0) {
    rest_->set_variance(noise_.mean_known());
    f.since_moved = 0.0;
    f.moving = true;
    f.trackers.begin();
    f.trackers.seed(rest_->rate().value, Lanes::Ones());
    f.mix.begin(0);
    f.change.begin();
  }
  started_ |= first;
}

void Engine::weigh(Step& s) noexcept {
  Sample& m = s.sample;
  m.rest_factor = noise_.white() + rest_->measured().variance / (noise_.mean_known() * s.noise_scale);
  m.scale = noise_.each(&Noise::tested) * s.noise_scale;
  if (smooths_) m.scale *= noise_.each(&Noise::excess);
  // The amplitude of a model's colour varies, such as that of a dither: slowly, and for a while.
  if (!rest_->rate_alone()) {
    m.scale *= to_lanes(health_.nis_mean).max(1.0).min(kOtherNoise);
    m.louder = kOtherNoise;
  } else {
    m.decay = noise_.each(&Noise::decay);
  }
  m.innovation = m.mask * (m.rate - rest_->measured().value);
  m.inverse = m.mask / m.scale;
  const Lanes covered = to_lanes(s.in.covered_s);
  m.covered_s = (covered > 0.0).select(covered, s.dt_s);
  m.surprise = m.innovation * m.innovation * m.inverse * (1.0 / m.rest_factor);
  const RestFilter::Reading clean = rest_->without_colour();
  m.apart = m.mask * (m.rate - clean.value);
  m.apart_factor = 1.0 + clean.variance / (noise_.mean_known() * s.noise_scale);
  s.out.innovation_radps = to_axes(m.innovation);
}

void Engine::follow(Step& s) noexcept {
  if (s.sample.valid == 0) {
    rest_->skip();
    follow_.moving ? publish_mix(s) : publish_rest(s);
    return;
  }
  Follower& f = follow_;
  // Outliers must exceed the present shaking. Without a tracker of the motion they cannot be recognised.
  const Lanes allowed = f.moving ? noise_.each(&Noise::over_known) : Lanes::Ones();
  switch (f.moving && f.mix.raw()
              ? Outliers::Verdict::usual
              : f.outliers.take(f.trackers, s.sample, allowed, f.moving, !smooths_, f.lag())) {
    case Outliers::Verdict::waits:
      s.outlier = true;
      rest_->skip();
      follow_.moving ? publish_mix(s) : publish_rest(s);
      return wait(s);
    case Outliers::Verdict::jump:
      return jump(s);
    case Outliers::Verdict::usual:
      // In a manoeuvre an outlier may be rotation.
      f.in_manoeuvre() ? f.ledger.admit() : f.ledger.dismiss();
      break;
  }
  follow_.moving ? follow_manoeuvre(s) : follow_rest(s);
}

// An unpredicted measurement may be an outlier, or the first sample of a motion. What is more probable in this run
// is published.
void Engine::wait(Step& s) noexcept {
  const Lanes square = s.sample.innovation * s.sample.innovation;
  const double chance = follow_.outliers.chance();
  if (chance < 0.5) {
    s.rate = (s.sample.mask > 0.0).select(s.sample.rate, s.rate);
    s.variance = (s.sample.mask > 0.0).select(s.sample.scale + chance * square, s.variance);
    return;
  }
  s.out.flags |= kGated;
  ++health_.gated;
  s.variance += square;
}

// Enough unpredicted measurements are a new rate.
void Engine::jump(Step& s) noexcept {
  follow_.change.forget_angle();
  follow_.outliers.end_run();
  move_rest((s.sample.mask > 0.0).select(s.sample.rate, follow_.published), s.sample.scale);
  weigh(s);
  begin_manoeuvre(s, ChangeTest::kShaking);
}

void Engine::follow_rest(Step& s) noexcept {
  Follower& f = follow_;
  s.sample.short_rad = f.ledger.shortfall_at_rest();
  std::optional<std::size_t> found = f.change.take(f.trackers, s.sample, f.outliers.rarity(), f.lag());
  if (found == ChangeTest::kShaking && smooths_) found.reset();
  f.trackers.correct(s.sample.rate, s.sample.mask);
  if (found) return begin_manoeuvre(s, *found);
  take(s, f.since_moved > kRestMemory);
  publish_rest(s);
}

void Engine::begin_manoeuvre(Step& s, std::size_t tracker) noexcept {
  Follower& f = follow_;
  const bool shaking = tracker == ChangeTest::kShaking;
  // Unpredicted motion may have lasted any time.
  const std::size_t predicts = std::min(tracker, f.trackers.size() - 1);
  f.ledger.admit();
  f.ledger.owe_late(f.change.angle(predicts), f.trackers.horizon(predicts), f.settled);
  s.out.flags |= kManoeuvre;
  if (!f.moving) ++health_.manoeuvres;
  f.moving = true;
  f.failed_nats = kEvidence;
  f.mix.begin(shaking ? 0 : tracker);
  f.change.begin();
  if (shaking) {  // no tracker predicts it, so what they remember is of no use
    f.trackers.begin();
    f.trackers.seed((s.sample.mask > 0.0).select(s.sample.rate, f.published), Lanes::Ones());
  } else {
    if (tracker + 1 < f.trackers.size()) f.trackers.begin_from(tracker + 1, tracker);
    move_rest(f.trackers.rate(tracker), f.trackers.gains(tracker).output * s.sample.scale);
  }
  take(s, false);
  publish_mix(s);
}

void Engine::follow_manoeuvre(Step& s) noexcept {
  Follower& f = follow_;
  take(s, false);
  const RestFilter::Reading rest = rest_->without_colour();
  // Covariance of the error and the measurement's noise, over R: of white noise the gain, whatever the rule's R.
  const double common =
      rest_->rate_alone() ? rest.gain : rest.variance / (noise_.mean_known() * s.noise_scale);
  f.mix.take(f.trackers, s.sample, noise_.each(&Noise::colour), rest.value, common);
  publish_mix(s);
  if (f.mix.rest_failed()) {
    move_rest(s.rate, s.variance.min(s.sample.scale));
    f.mix.begin_rest();
    f.failed_nats += Mix::kFailed;
  }
  if (f.mix.rest_found()) {
    f.moving = false;
    f.change.begin();
  }
}

// The filter at rest uses the clipped measurement. learn: its rule learns from the innovation.
void Engine::take(Step& s, bool learn) noexcept {
  const Sample& m = s.sample;
  if (m.valid == 0) {
    rest_->skip();
    return;
  }
  RestFilter::Measured measured{m.rate, m.valid, s.noise_scale, Lanes::Ones()};
  if (settings_.follow_manoeuvres) {
    if (greatest(m.surprise) > kMostSquare) {
      const Lanes most = kMostDeviations * (m.scale * m.rest_factor).sqrt();
      measured.rate += m.innovation.max(-most).min(most) - m.innovation;
    }
    // The mean of all axes, measured or not, as the gain is common.
    measured.share = noise_.share();
    if (smooths_) measured.share *= noise_.each(&Noise::excess);
    const double more = smooths_ ? noise_.mean(measured.share) : 1.0;
    measured.share *= 1.0 / more;
    measured.noise_scale *= more * noise_.over_given();
  }
  // The first measurement sets the state; its innovation is zero and no evidence.
  rest_->update(measured, s.in.sequence, learn && follow_.since_moved > 0.0);
  follow_.since_moved += 1.0;
  if (!learn || !(rest_->covariance() > 0.0)) return;
  const Lanes normalised = m.innovation / (rest_->covariance() * measured.share).sqrt();
  for (std::size_t a = 0; a < axes_; ++a)
    if ((m.valid >> a & 1U) != 0) grades_.take(a, normalised[static_cast<Eigen::Index>(a)], health_);
}

void Engine::move_rest(const Lanes& rate, const Lanes& variance) noexcept {
  rest_->shift_to(rate, started_);
  rest_->set_variance(noise_.mean(variance / noise_.share()));
  follow_.since_moved = 0.0;
}

// After divergence (invalid covariance or state) restarts the filter from this measurement.
void Engine::guard(Step& s) noexcept {
  if (rest_->sound() && s.rate.allFinite()) return;
  ++health_.divergences;
  s.out.flags |= kRestarted;
  restart();
  begin_axes(s);
  take(s, false);
  publish_rest(s);
}

// Half of the variance is due to measurement noise (more if coloured: README.md), half due to the walk.
void Engine::publish_rest(Step& s) noexcept {
  s.rate = rest_->rate().value;
  s.gain = rest_->rate().gain;
  s.variance.setConstant(rest_->rate().variance);
  if (!settings_.follow_manoeuvres) return;
  const double rule = rest_->rule().measurement_noise() / settings_.measurement_noise;
  const Lanes colour = colour_of_sum(s.sample.decay, follow_.lag() / (1.0 + follow_.lag()));
  s.variance *= 0.5 * (noise_.walk_share() + noise_.share() * colour / rule);
  s.variance += follow_.change.change_variance() + noise_.each(&Noise::rounding);
}

void Engine::publish_mix(Step& s) noexcept {
  // Present variance of a measurement; an excess may be noise.
  const Lanes level = noise_.each(&Noise::known) * noise_.each(&Noise::significant_excess) * s.noise_scale;
  const Mix::Published mix =
      follow_.mix.publish(follow_.trackers, rest_->rate().value, rest_->rate().variance * noise_.share(),
                          s.sample.scale.max(level), follow_.lag());
  s.rate = mix.rate;
  s.variance = mix.variance;
  s.gain = mix.gain + follow_.mix.rest_weight() * rest_->rate().gain;
}

// Books the rate's shortfall and adds this sample's payment.
void Engine::pay(Step& s) noexcept {
  using enum Ledger::Account;
  Follower& f = follow_;
  Ledger& ledger = f.ledger;
  const bool follows = settings_.follow_manoeuvres;
  // Before it has settled, the filter does not recover its lag by itself.
  f.at_rest_for = f.moving ? 0.0 : f.at_rest_for + 1.0;
  const bool settled =
      follows && f.at_rest_for >= kYoungLags * std::max(f.settled_lag, 1.0 / rest_->rate().gain);
  if (settled && !f.settled) f.change.forget_angle();
  f.settled = settled;
  const Lanes fell_short = (s.sample.rate - s.rate) * s.sample.mask * s.sample.covered_s;
  // In a manoeuvre the filter at rest has a share according to its weight.
  const double rests = s.outlier ? 0.0 : f.moving ? f.mix.rest_weight() : 1.0;
  ledger.book((1.0 - rests) * fell_short, s.outlier ? kDoubt : kDebt);
  ledger.book(rests * fell_short, f.settled ? kCarried : kTail);
  if (f.moving) ledger.pace(f.mix.length(f.trackers, follow_.lag()));
  // Angle in a gap is unknown and not booked.
  const Lanes dt_s = (s.sample.mask > 0.0).select(s.sample.covered_s, Lanes::Constant(s.dt_s));
  Lanes most = Lanes::Constant(1e300);
  if (follows) most = kMostPaid * (rest_->rate().variance * noise_.share()).sqrt();
  const Lanes paid = ledger.pay(most, f.lag(), dt_s);
  s.rate += paid;
  if (follows) s.variance = s.variance.max(paid * paid);
}

bool Engine::rests(const Step& s) const noexcept {
  if (!settings_.follow_manoeuvres || follow_.moving || s.outlier || s.sample.valid == 0 ||
      follow_.since_moved < kRestMemory || follow_.change.suspected())
    return false;
  return (rest_->rate().value.abs() * mask_of(started_) <= kMostRestRate).all();
}

void Engine::learn(const Step& s) noexcept {
  if (!settings_.follow_manoeuvres) return;
  const bool at_rest = (s.out.flags & kAtRest) != 0;
  if (s.dt_s > kShortGap * period_s_ || s.noise_scale != 1.0) noise_.gap();
  if (!s.outlier && (at_rest || follow_.moving))
    noise_.learn(s.in.rate_radps, s.sample.valid, at_rest, *rest_);
}

void Engine::publish(const Step& s) noexcept {
  for (std::size_t a = 0; a < axes_; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    const double variance = s.variance[i] + unmeasured_.more()[i];
    s.out.denoised_radps[a] = s.rate[i];
    // A rule without a floor may make the covariance negative; then the variance is that of one measurement.
    s.out.variance_rad2ps2[a] = variance >= 0.0 ? variance : settings_.measurement_noise;
    s.out.gain[a] = s.gain;
    s.out.innovation_variance[a] =
        rest_->covariance() * (settings_.follow_manoeuvres ? noise_.share()[i] : 1.0);
    health_.measurement_noise[a] = rest_->rule().measurement_noise();
    if (settings_.follow_manoeuvres) health_.measurement_noise[a] *= noise_.share()[i] * noise_.over_given();
  }
  health_.floor_hits = rest_->rule().floor_hits();
  if (s.in.sequence % kLagEvery == 0 || follow_.settled_lag == 0.0) refresh_lag();
  health_.group_delay_s =
      period_s_ * follow_.settled_lag * (follow_.moving ? follow_.mix.rest_weight() : 1.0);
}

// Updates the lag of the filter at rest after it has settled.
void Engine::refresh_lag() noexcept {
  const Settled now = rest_->settled();
  if (!std::isfinite(now.lag) || !std::isfinite(now.correlation)) return;
  follow_.settled_lag = now.lag;
  health_.correlation_time_s = now.correlation * period_s_;
  follow_.trackers.reach(follow_.lag());
}

}  // namespace ifog
