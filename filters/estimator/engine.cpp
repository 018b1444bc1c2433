// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/engine.h"

#include <algorithm>
#include <cmath>

#include "filters/random/log_exp.h"

namespace ifog {

Engine::Engine(const FilterSettings& settings, std::unique_ptr<RestFilter> rest, int axes, double period_s)
    : settings_(settings),
      axes_(static_cast<std::size_t>(axes)),
      period_s_(period_s),
      rest_(std::move(rest)),
      follow_(axes_, period_s) {
  noise_.fill(Noise(settings.measurement_noise));
  refresh_shares();
  follow_.moving = settings.follow_manoeuvres && rest_->rate_alone();
}

void Engine::restart() noexcept {
  rest_->restart();
  const Lanes owed = follow_.ledger.owed();
  follow_ = Follower(axes_, period_s_);
  follow_.moving = settings_.follow_manoeuvres && rest_->rate_alone();
  if (owed.abs().sum() > 0.0) follow_.ledger.owe(owed);
  walk_.break_off();
  started_ = 0;
  settled_lag_ = 0.0;
  unmeasured_ = {};
}

void Engine::expect_noise(const Axes& share) noexcept {
  for (std::size_t a = 0; a < axes_; ++a) noise_[a] = Noise(share[a] * settings_.measurement_noise);
  refresh_shares();
}

void Engine::expect_walk(const std::optional<Axes>& share) noexcept {
  shares_.expected_walk = share;
  refresh_shares();
}

void Engine::learn_walk(double ratio, double samples) noexcept {
  learns_walk_ = true;
  if (samples > 0.0) walk_.recall(ratio, samples);
}

LearnedNoise Engine::learned() const noexcept {
  LearnedNoise out;
  out.process_noise = settings_.process_noise;
  for (std::size_t a = 0; a < axes_; ++a) out.noise[a] = noise_[a].known();
  out.measurement_noise = shares_.mean_noise;
  out.samples = learns_walk_ ? walk_.samples() : 0.0;
  return out;
}

Axes Engine::owed() const noexcept {
  if (!settings_.conserve_angle) return {};
  return to_axes(follow_.ledger.owed());
}

void Engine::owe(const Axes& angle_rad) noexcept {
  const Lanes angle = to_lanes(angle_rad);
  if (angle.allFinite() && (angle != 0.0).any()) follow_.ledger.owe(angle);
}

Lanes Engine::of_noise(double (Noise::*figure)() const noexcept) const noexcept {
  Lanes all = Lanes::Ones();
  for (std::size_t a = 0; a < axes_; ++a) all[static_cast<Eigen::Index>(a)] = (noise_[a].*figure)();
  return all;
}

double Engine::mean(const Lanes& of) const noexcept {
  return (of * mask_of(axes_of_sensor(axes_))).sum() / static_cast<double>(axes_);
}

void Engine::refresh_shares() noexcept {
  shares_.mean_noise = mean(of_noise(&Noise::known));
  shares_.noise = of_noise(&Noise::known) / shares_.mean_noise;
  shares_.walk = shares_.expected_walk ? to_lanes(*shares_.expected_walk) : shares_.noise;
}

// Of the filter at rest, samples; after a move it is as slow as what it has received since is long.
double Engine::lag() const noexcept {
  return std::max(1.0, std::min(settled_lag_, follow_.since_moved + 1.0));
}

void Engine::step(const EstimatorInput& in, EstimatorOutput& out) noexcept {
  out.flags = 0;
  Step s{in,
         out,
         in.dt_s > 0.0 ? in.dt_s : period_s_,
         in.averaged_s > 0.0 ? period_s_ / in.averaged_s : 1.0,
         {}};
  screen(s);
  const double before = rest_->variance();
  rest_->predict(s.dt_s);
  const double grown = std::max(0.0, rest_->variance() - before);
  begin_axes(s);
  if (settings_.follow_manoeuvres) {
    follow_.trackers.predict(s.dt_s / period_s_);
    for (std::size_t a = 0; a < axes_; ++a)
      if ((s.sample.valid >> a & 1U) != 0)
        noise_[a].take(in.rate_radps[a], follow_.trackers.since()[static_cast<Eigen::Index>(a)]);
    weigh(s);
    follow(s);
  } else {
    weigh(s);
    take(s, true);
    publish_rest(s);
  }
  if (settings_.guard) guard(s);
  if (follow_.moving && follow_.failed_nats >= kEvidence && settings_.follow_manoeuvres &&
      follow_.mix.rest_weight() < 0.5)
    out.flags |= kManoeuvre;
  if (rests(s)) out.flags |= kAtRest;
  learn(s);
  know_unmeasured(s, grown);
  follow_.published = s.rate;
  if (settings_.conserve_angle) pay(s);
  publish(s);
}

// Which axes have a measurement that can be used.
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
  const bool follows = settings_.follow_manoeuvres && rest_->rate_alone();
  // What the rate did in a gap nobody knows: the filter at rest has to stand by what is measured now.
  if (follows && !f.moving && s.sample.valid != 0 && s.dt_s > kShortGap * period_s_) {
    f.moving = true;
    f.failed_nats = 0.0;
    f.mix.begin_from_rest();
    f.change.begin();
  }
  const std::uint32_t first = s.sample.valid & ~started_;
  if (first == 0) return;
  rest_->shift_to(s.sample.rate, first);
  f.trackers.seed(s.sample.rate, mask_of(first));
  // An axis that comes late is one that begins, and all share one gain.
  if (follows && started_ != 0) {
    rest_->set_variance(shares_.mean_noise);
    f.since_moved = 0.0;
    f.moving = true;
    f.trackers.begin();
    f.trackers.seed(rest_->rate(), Lanes::Ones());
    f.mix.begin(0);
    f.change.begin();
  }
  started_ |= first;
}

void Engine::weigh(Step& s) noexcept {
  Sample& m = s.sample;
  const bool smooths = settings_.wideband == "noise";
  const double projected = rest_->measurement_variance() / shares_.mean_noise;
  m.rest_factor = 1.0 + projected / s.noise_scale;
  m.log_rest_factor = logarithm(m.rest_factor);
  m.rest_gain = std::min(1.0, projected / (projected + s.noise_scale));
  m.scale = of_noise(&Noise::tested) * s.noise_scale;
  if (smooths) m.scale *= of_noise(&Noise::heard);
  m.innovation = m.mask * (m.rate - rest_->measurement());
  m.inverse = m.mask / m.scale;
  const Lanes covered = to_lanes(s.in.covered_s);
  m.covered_s = (covered > 0.0).select(covered, s.dt_s);
  m.surprise = m.innovation * m.innovation * m.inverse / m.rest_factor;
  s.out.innovation_radps = to_axes(m.innovation);
}

void Engine::follow(Step& s) noexcept {
  if (s.sample.valid == 0) {
    rest_->skip();
    follow_.moving ? publish_mix(s) : publish_rest(s);
    return;
  }
  switch (judge_outlier(s)) {
    case Outliers::Verdict::waits:
      s.out.flags |= kGated;
      ++health_.gated;
      s.outlier = true;
      rest_->skip();
      follow_.moving ? publish_mix(s) : publish_rest(s);
      // Until the next measurement says which, it may be the first of a jump.
      s.variance += s.sample.innovation * s.sample.innovation;
      return;
    case Outliers::Verdict::jump:
      jump(s);
      break;
    case Outliers::Verdict::usual:
      if (follow_.outliers.run() > 0) break;
      // In a manoeuvre an outlier may be rotation.
      follow_.moving ? follow_.ledger.admit() : follow_.ledger.dismiss();
      break;
  }
  follow_.moving ? follow_manoeuvre(s) : follow_rest(s);
}

Outliers::Verdict Engine::judge_outlier(const Step& s) noexcept {
  const Trackers& trackers = follow_.trackers;
  // Where nothing follows the motion nothing tells an outlier from it.
  if (follow_.moving && follow_.mix.raw()) return Outliers::Verdict::usual;
  // Nor behind a gap.
  if (greatest(s.sample.mask * trackers.since()) > kShortGap) {
    follow_.outliers.end_run();
    return Outliers::Verdict::usual;
  }
  Lanes least = s.sample.surprise;
  // The raw one, a parabola through three measurements, predicts nothing better than others.
  for (std::size_t j = 1; j < trackers.size(); ++j) {
    if (!trackers.predicts(j)) {
      least.setZero();
      break;
    }
    const Lanes error = s.sample.rate - trackers.rate(j);
    least = least.min(error * error * s.sample.inverse / trackers.factor(j));
  }
  // What shaking makes is no outlier among the like.
  if (follow_.moving) least /= of_noise(&Noise::shaken);
  Eigen::Index worst = 0;
  const double most = least.maxCoeff(&worst);
  return follow_.outliers.take(most, s.sample, worst, follow_.moving, lag());
}

// So many measurements that nothing predicts are a new rate: followers begin with this one.
void Engine::jump(Step& s) noexcept {
  Follower& f = follow_;
  f.trackers.begin();
  f.trackers.seed(f.published, Lanes::Ones());
  f.trackers.predict(1.0);
  f.ledger.admit();
  f.outliers.end_run();
  move_rest((s.sample.mask > 0.0).select(s.sample.rate, f.published), s.sample.scale);
  weigh(s);
  begin_to_move(s);
  f.mix.begin(0);
  f.change.begin();
}

void Engine::follow_rest(Step& s) noexcept {
  Follower& f = follow_;
  s.sample.short_rad = f.ledger.take_short_at_rest();
  std::optional<std::size_t> found =
      f.change.take(f.trackers, s.sample, of_noise(&Noise::colour), f.outliers.rarity(), lag());
  if (found == ChangeTest::kShaking && settings_.wideband == "noise") found.reset();
  f.trackers.correct(s.sample.rate, s.sample.mask);
  if (found) {
    begin_manoeuvre(s, *found);
    take(s, false);
    publish_mix(s);
    return;
  }
  take(s, f.since_moved > kRestMemory);
  publish_rest(s);
}

void Engine::begin_to_move(Step& s) noexcept {
  s.out.flags |= kManoeuvre;
  if (!follow_.moving) ++health_.manoeuvres;
  follow_.moving = true;
  follow_.failed_nats = kEvidence;
}

void Engine::begin_manoeuvre(Step& s, std::size_t tracker) noexcept {
  Follower& f = follow_;
  const bool shaking = tracker == ChangeTest::kShaking;
  // What nothing predicts may have gone on for as long as anything.
  const std::size_t foresees = std::min(tracker, f.trackers.size() - 1);
  f.ledger.admit();
  f.ledger.owe_late(f.change.angle(foresees), f.trackers.horizon(foresees), f.settled);
  begin_to_move(s);
  f.mix.begin(shaking ? 0 : tracker);
  f.change.begin();
  if (shaking) return;
  if (tracker + 1 < f.trackers.size()) f.trackers.begin_from(tracker + 1, tracker);
  move_rest(f.trackers.rate(tracker), f.trackers.gains(tracker).output * s.sample.scale);
}

void Engine::follow_manoeuvre(Step& s) noexcept {
  Follower& f = follow_;
  f.mix.take(f.trackers, s.sample, of_noise(&Noise::colour));
  take(s, false);
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

// The filter at rest takes the measurement in, clipped. learn: its rule learns of the innovation.
void Engine::take(Step& s, bool learn) noexcept {
  const Sample& m = s.sample;
  if (m.valid == 0) {
    rest_->skip();
    return;
  }
  RestFilter::Measured measured{m.rate, m.valid, s.noise_scale, Lanes::Ones()};
  if (settings_.follow_manoeuvres) {
    const Lanes most = kMostDeviations * (m.scale * m.rest_factor).sqrt();
    measured.rate += m.innovation.max(-most).min(most) - m.innovation;
    // The mean of all axes, whichever are measured: one gain is for all.
    measured.share = of_noise(&Noise::known);
    if (settings_.wideband == "noise") measured.share *= of_noise(&Noise::heard);
    const double of_all = mean(measured.share);
    measured.share /= of_all;
    measured.noise_scale *= of_all / settings_.measurement_noise;
  }
  // The first measurement sets the state: its innovation is zero and no evidence.
  rest_->update(measured, s.in.sequence, learn && follow_.since_moved > 0.0);
  follow_.since_moved += 1.0;
  if (!learn || !(rest_->covariance() > 0.0)) return;
  const Lanes normalised = m.innovation / (rest_->covariance() * measured.share).sqrt();
  for (std::size_t a = 0; a < axes_; ++a)
    if ((m.valid >> a & 1U) != 0) grades_.take(a, normalised[static_cast<Eigen::Index>(a)], health_);
}

void Engine::move_rest(const Lanes& rate, const Lanes& variance) noexcept {
  rest_->shift_to(rate, started_);
  const double of_all = mean(variance / shares_.noise);
  // Colour and lines that a larger model has found stay known.
  if (rest_->rate_alone() || of_all > rest_->variance()) rest_->set_variance(of_all);
  follow_.since_moved = 0.0;
}

// Divergence: a covariance that is none any more, a state that is no number, or a filter that for long has
// been further from the measurements than it believes possible. It starts again from this measurement.
void Engine::guard(Step& s) noexcept {
  const bool lost = grades_.newly_lost() && !settings_.follow_manoeuvres;
  if (rest_->sound() && s.rate.allFinite() && !lost) return;
  ++health_.divergences;
  ++health_.restarts;
  s.out.flags |= kRestarted;
  restart();
  begin_axes(s);
  take(s, false);
  publish_rest(s);
}

}  // namespace ifog
