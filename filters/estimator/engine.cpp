// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/engine.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ifog {
namespace {

// Samples between refreshes of the settled filter's lag, a small linear solve; by the sequence, so that a
// part of a recording has them where the whole has.
constexpr std::uint64_t kLagEvery = 256;
// Samples: what was not tested at the beginning belongs to no manoeuvre that begins later.
constexpr double kUntestedKept = 256.0;
// Where the noise looks coloured and how slow it is has yet to be found, a test of this many more is blunt.
constexpr double kColouredUntested = 4096.0;
// So many lags after it was moved the filter at rest has settled; until then it is a mean, with gain 1 / n.
constexpr double kSettledLags = 2.0;
// A motion that ends slowly is taken for over while it goes on below the noise: so many lags after that its
// tail is over, too.
constexpr double kTailLags = 8.0;
// Of a sensor at rest, rad/s: beyond the bias of any fibre-optic gyro, and 1.1 °/s.
constexpr double kMostRestRate = 0.02;
}  // namespace

Engine::Engine(const FilterSettings& settings, std::unique_ptr<RestFilter> rest, SteadyGain* steady, int axes,
               double period_s)
    : follow_manoeuvres_(settings.follow_manoeuvres),
      conserve_angle_(settings.conserve_angle),
      guard_(settings.guard),
      axes_(static_cast<std::size_t>(axes)),
      period_s_(period_s),
      rest_(std::move(rest)),
      steady_(steady),
      trackers_(axes_),
      change_(rest_->rate_alone(), axes_),
      ledger_(period_s, settings.follow_manoeuvres),
      noise_of_one_(settings.measurement_noise) {
  noise_.fill(NoiseScale(settings.measurement_noise));
  begin();
}

void Engine::step(const EstimatorInput& in, EstimatorOutput& out) noexcept {
  out.flags = 0;
  Measurement m{in, screen(in, out), in.dt_s > 0.0 ? in.dt_s : period_s_,
                in.averaged_s > 0.0 ? period_s_ / in.averaged_s : 1.0};
  if (m.noise_scale != 1.0) m.to_nominal = std::sqrt(1.0 / m.noise_scale);
  const double before = rest_->variance();
  rest_->predict(m.dt_s);
  const double grown = std::max(0.0, rest_->variance() - before);
  begin_axes(in.rate_radps, m.valid);
  if (follow_manoeuvres_) begin_after_gap(m);
  for (std::size_t a = 0; a < axes_; ++a) {
    if (has(m.valid, a)) m.innovation[a] = in.rate_radps[a] - rest_->measurement(a);
    if (noise_[a].known()) m.tested |= 1U << a;
  }
  out.innovation_radps = m.innovation;
  since_blow_ = std::min(since_blow_ + 1.0, kBlow);
  published_.passed_over = false;
  published_.returned = published_.shared = {};

  if (follow_manoeuvres_) {
    follow(m, out);
  } else {
    update_rest(m, true);
    publish_rest();
  }
  if (guard_) guard(m, out);
  if (rests(m)) out.flags |= kAtRest;
  know_unmeasured(m, grown);
  publish(m, out);
}

// The filter's gain and variance are of the axes that are measured.
void Engine::know_unmeasured(const Measurement& m, double grown) noexcept {
  Axes variance = published_.variance;
  for (std::size_t a = 0; motion_ == Motion::at_rest && a < axes_; ++a) variance[a] = rest_variance(a);
  for (std::size_t a = 0; a < axes_; ++a) {
    const double walked = grown * walk_share(a);
    if (has(m.valid, a))
      unmeasured_.measure(a, published_.gain, variance[a], m.in.rate_radps[a] - published_.rate[a],
                          noise_[a].now() * m.noise_scale);
    else if (m.valid == 0 && motion_ == Motion::at_rest)  // the filter is not measured either
      unmeasured_.miss_with_all(a, walked);
    else if (has(started_, a))
      unmeasured_.miss(a, walked, published_.rate, variance);
  }
}

void Engine::restart() noexcept {
  rest_->restart();
  trackers_.begin();
  change_.restart();
  outliers_.restart();
  for (NoiseScale& noise : noise_) noise.break_off();
  started_ = 0;
  knowledge_ = Knowledge::nothing;
  doubted_motion_ = {};
  begin();
  untested_ = {};
  unmeasured_ = {};
  in_tail_ = false;
  since_blow_ = kBlow;
  since_moved_ = at_rest_for_ = 0.0;
  lag_turn_ = kNoTurn;
}

void Engine::recall_colour(const Axes& colour) noexcept {
  for (std::size_t a = 0; a < axes_; ++a) noise_[a].recall(colour[a]);
}

Axes Engine::owed() const noexcept {
  Axes angle{};
  if (!conserve_angle_) return angle;
  for (std::size_t a = 0; a < axes_; ++a) angle[a] = ledger_.owed(a) + kept_out(a);
  return angle;
}

void Engine::owe(const Axes& angle_rad) noexcept {
  for (std::size_t a = 0; a < axes_; ++a) {
    if (std::isfinite(angle_rad[a]) && angle_rad[a] != 0.0) ledger_.owe(a, angle_rad[a]);
  }
}

// Which axes have a measurement that can be used.
std::uint32_t Engine::screen(const EstimatorInput& in, EstimatorOutput& out) noexcept {
  std::uint32_t valid = 0;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(in.valid_axes, a) || !std::isfinite(in.rate_radps[a])) continue;
    if (in.stuck_axes ? has(*in.stuck_axes, a) : check_.stuck(a, in.rate_radps[a])) {
      out.flags |= kStuck;
      continue;
    }
    valid |= 1U << a;
  }
  return valid;
}

void Engine::update_rest(const Measurement& m, bool learn) noexcept {
  if (m.valid == 0) {
    rest_->skip();
    return;
  }
  // The first measurement sets the state; its innovation is zero by construction and no evidence.
  const bool learns = learn && knowledge_ != Knowledge::nothing;
  double noise_scale = m.noise_scale;
  if (follow_manoeuvres_ && steady_ != nullptr) {
    const double louder = louder_by(m.valid);
    steady_->hear_louder(louder);
    louder_ = louder;
    if (!learns) noise_scale *= louder;
  }
  rest_->update(m.in.rate_radps, m.valid, noise_scale, m.in.sequence, learns);
  if (knowledge_ == Knowledge::nothing) knowledge_ = Knowledge::told;
  since_moved_ += 1.0;
  // Where it goes under way, in the tail of a motion, or while its gain is that of a filter that was moved,
  // what it lags behind by will not be returned.
  at_rest_for_ = in_manoeuvre() ? 0.0 : at_rest_for_ + 1.0;
  const bool settled = at_rest_for_ * rest_->gain() > kTailLags;
  for (std::size_t a = 0; !settled && a < axes_; ++a) ledger_.refer(a, rest_->rate(a));
  // A filter that has just begun has no motion behind it, and owes but its noise.
  in_tail_ = !settled && (in_tail_ || in_manoeuvre());
  ledger_.follow_tail(in_tail_ && rest_->gain() > 0.0 ? period_s_ / rest_->gain() : 0.0);
  // Under way, too, a filter that has had time to settle and was not found wrong is to be as far from the
  // measurements as it believes; that of a larger model is only moved by its level, and may take longer.
  const bool doubtful = learn || (rest_->rate_alone() && since_moved_ > kSettledLags * lag_samples());
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(m.valid, a) || !(rest_->covariance() > 0.0)) continue;
    const double normalised = m.innovation[a] / std::sqrt(innovation_variance(a));
    if (doubtful) doubt(a, normalised);
    if (learn) grade(a, normalised);
  }
}

bool Engine::hardly_tested(std::size_t axis) const noexcept {
  return !noise_[axis].white() && tested_for_[axis] < kColouredUntested;
}

// A filter that has just begun is as slow as what it has had is long.
double Engine::lag_samples() const noexcept {
  const bool young = rest_->rate_alone() && rest_->gain() > 0.0 && since_moved_ < kLagEvery;
  return std::max({longest_lag_, 1.0, young ? std::min(since_moved_, 1.0 / rest_->gain()) : 0.0});
}

Surprise Engine::surprise(const Measurement& m) const noexcept {
  Surprise now;
  for (std::size_t a = 0; a < axes_; ++a)
    now.rate[a] = has(m.valid, a) ? m.in.rate_radps[a] : published_.rate[a];
  now.innovation = m.innovation;
  // Of R nothing: it is in the scale, and what both say of it must not differ.
  const double usual = rest_variance_ + rest_->rule().measurement_noise();
  if (beginning() && knowledge_ != Knowledge::heard)
    now.rest_factor = 1.0 + rest_->measurement_variance() / rest_->rule().measurement_noise();
  else if (rest_variance_ > 0.0)
    now.rest_factor = std::max(1.0, 1.0 + (rest_->measurement_variance() - rest_variance_) / usual);
  for (std::size_t a = 0; a < axes_; ++a) {
    now.covered_s[a] = m.covered_s(a);
    now.scale[a] = noise_[a].now() * m.noise_scale;
    now.degrees[a] = noise_[a].degrees();
    if (has(m.valid, a) && (noise_[a].known() || beginning()) && now.scale[a] > 0.0) now.valid |= 1U << a;
  }
  return now;
}

void Engine::follow(const Measurement& m, EstimatorOutput& out) noexcept {
  trackers_.predict(m.dt_s / period_s_);
  const Surprise now = surprise(m);
  if (in_manoeuvre()) {
    follow_manoeuvre(m, now, out);
  } else if (beginning()) {
    follow_beginning(m, now, out);
  } else {
    follow_rest(m, now, out);
  }
}

void Engine::follow_rest(const Measurement& m, const Surprise& now, EstimatorOutput& out) noexcept {
  const double lag = lag_samples();
  if (now.valid != 0) outliers_.take(now, lag);
  const bool keep_out = now.valid != 0 && outliers_.keep_out();
  if (now.valid != 0 && outliers_.jump()) {
    hear(m);
    jump(out);
    forget_unmeasured(m.valid);
    return;
  }
  hear(m);
  if (now.valid != 0 && outliers_.run().empty()) book_kept_out(m);
  if (now.valid != 0 && outliers_.began()) begin_kept_out();
  if (keep_out) {
    out.flags |= kGated;
    ++health_.gated;
    published_.passed_over = true;
    for (std::size_t a = 0; a < axes_; ++a)
      if (has(m.valid, a)) add_kept_out(m, a, m.in.rate_radps[a] - rest_->rate(a));
  }
  std::optional<std::size_t> changed;
  if (keep_out && outliers_.run().size() == 1) {
    trackers_.pass_over();
  } else if (m.valid != 0) {
    if (now.valid != 0) changed = change_.take(trackers_, now, noise_, outliers_.most(), lag);
    for (std::size_t a = 0; a < axes_; ++a)
      if (has(m.valid, a) && !noise_[a].known())
        foresight_[a].take(trackers_, a, m.in.rate_radps[a], m.noise_scale);
    trackers_.correct(m.in.rate_radps, m.valid);
  }
  if (changed) {
    begin_manoeuvre(m, *changed, out);
    return;
  }
  if (keep_out) {
    rest_->skip();
  } else {
    const double predicted = rest_->measurement_variance();
    const bool learns = since_moved_ > kRestMemory || knowledge_ != Knowledge::heard;
    update_rest(m, learns);
    if (m.valid != 0 && knowledge_ != Knowledge::nothing) learn_noise(m, learning(m.valid));
    if (learns) average_rest(predicted);
  }
  publish_rest();
  // Until the next measurement says which, it may be the first of a jump.
  for (std::size_t a = 0; keep_out && a < axes_; ++a)
    published_.variance[a] += m.innovation[a] * m.innovation[a];
}

bool Engine::rests(const Measurement& m) const noexcept {
  if (!follow_manoeuvres_ || motion_ != Motion::at_rest || lost_ || published_.passed_over || m.valid == 0 ||
      (m.valid & ~m.tested) != 0 || at_rest_for_ < kRestMemory || change_.suspected())
    return false;
  for (std::size_t a = 0; a < axes_; ++a)
    if (has(started_, a) && !(std::abs(rest_->rate(a)) <= kMostRestRate)) return false;
  return true;
}

// At rest the variance is the filter's own where the noise is white. Half of it is noise; where neighbours
// have something in common that is more by as much as their mean over a long time varies more. Half is the
// walk's, and an axis' own share of that. Where a change of rate may have begun, it is what the filter may be
// off by.
void Engine::publish_rest() noexcept {
  published_.gain = rest_->gain();
  // Of an innovation, as the filter believes it to be.
  const double believed = rest_variance_ + louder_ * rest_->rule().measurement_noise();
  const double lag = lag_samples();
  for (std::size_t a = 0; a < axes_; ++a) {
    published_.rate[a] = rest_->rate(a);
    published_.variance[a] = rest_variance(a);
    if (!follow_manoeuvres_ || !noise_[a].known() || !(believed > 0.0)) continue;
    const double louder = std::max(1.0, noise_[a].with_tails() / (loudness_[a] * believed));
    const Wider wider =
        change_.wider(trackers_, a, lag, noise_[a], {1.0 / louder, walk_share(a) / loudness_[a]});
    published_.variance[a] *= 0.5 * (wider.walk + wider.noise * louder);
    published_.variance[a] += noise_[a].rounding(published_.rate[a], published_.variance[a]) +
                              noise_[a].vibration() + change_.unseen(a);
  }
}

void Engine::publish(const Measurement& m, EstimatorOutput& out) noexcept {
  const double believed = rest_->rule().measurement_noise();
  for (std::size_t a = 0; a < axes_; ++a) {
    double rate = published_.rate[a];
    double variance = unmeasured_.variance(a, published_.variance[a]);
    if (conserve_angle_) {
      const double dt_s = m.covered_s(a);
      const auto paid = ledger_.payment(a, rest_->rate(a), rest_variance(a), dt_s);
      rate += paid.rate();
      // Of a lag that lasts the payments are the return: the rate is off by the greater of the two.
      variance += std::max(0.0, paid.rate() * paid.rate() - published_.returned[a]) + published_.shared[a];
      // An outlier at rest is no rotation; in a manoeuvre every sample may be, and is booked.
      const double short_by =
          has(m.valid, a) && !published_.passed_over ? m.in.rate_radps[a] - published_.rate[a] : 0.0;
      // What a filter that is lost falls short of is no lag's, whatever it takes itself for.
      const bool under_way = in_manoeuvre() || (follow_manoeuvres_ && lost_);
      const double grown = ledger_.book(a, short_by * dt_s, paid, dt_s, rest_->rate(a), under_way);
      // What was fallen short of before its noise was known no test has seen: a filter that begins under way
      // finds that out late, and owes it to the manoeuvre.
      if (!has(m.tested, a) || beginning()) {
        untested_[a] += grown;
        tested_for_[a] = 0.0;
      } else {
        tested_for_[a] += 1.0;
        if (hardly_tested(a)) {
          if (!under_way) untested_[a] += grown;
        } else if (tested_for_[a] > kUntestedKept) {
          untested_[a] = 0.0;
        }
      }
    }
    out.denoised_radps[a] = rate;
    // A rule without a floor may take the covariance below zero: it then says nothing of the rate but what
    // one measurement does.
    out.variance_rad2ps2[a] = variance >= 0.0 ? variance : noise_of_one_;
    out.gain[a] = published_.gain;
    out.innovation_variance[a] = innovation_variance(a);
    health_.measurement_noise[a] = loudness_[a] * believed;
    health_.colour[a] = noise_[a].colour();
  }
  health_.floor_hits = rest_->rule().floor_hits();
  if (const std::uint64_t turn = m.in.sequence / kLagEvery; turn != lag_turn_) {
    lag_turn_ = turn;
    refresh_lag();
  }
  // A tracker has no lag in a rate, slope or curvature that lasts.
  health_.group_delay_s = motion_ != Motion::at_rest ? mix_.rest_weight() * lag_s_ : lag_s_;
}

// The lag of the filter at rest, not of one that has just been moved and still has to forget by how much.
void Engine::refresh_lag() noexcept {
  const Settled now = rest_->settled();
  // A filter that has taken in nothing yet has neither.
  if (!std::isfinite(now.lag) || !std::isfinite(now.correlation)) return;
  const double lag = std::max(0.0, now.lag);
  if (follow_manoeuvres_ && lag_s_ > 0.0 && (in_manoeuvre() || since_moved_ < longest_lag_) &&
      lag < longest_lag_)
    return;
  lag_s_ = lag * period_s_;
  Axes rest{};
  for (std::size_t a = 0; a < axes_; ++a) rest[a] = rest_->rate(a);
  ledger_.set_lag(lag_s_, rest);
  longest_lag_ = lag;
  trackers_.reach(lag);
  health_.correlation_time_s = now.correlation * period_s_;
}

}  // namespace ifog
