#include "filters/estimator/engine.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ifog {
namespace {

// Samples without a new change and with the filter at rest the likeliest, after which the manoeuvre is over.
constexpr int kQuiet = 64;
// In coloured noise a tracker may for ever predict better than the filter at rest. A manoeuvre is also over
// when for this many samples the filter at rest has explained the measurements as well as it does at rest.
constexpr int kCalmSamples = 256;
// P raised by a manoeuvre counts as settled when a measurement lowers it by less than this: it has then come
// to its end, or is a hundredth of R. What it was before the manoeuvre is no measure: the rule may have taken
// the beginning of the manoeuvre for noise, and must learn again to know better.
constexpr double kSettled = 0.99;
// Averages of the filter at rest, in samples.
constexpr double kRestMemory = 64.0;
constexpr double kHealthMemory = 512.0;
// Lost: more than half of the innovations in that memory beyond three of the sigmas the rule gives them,
// which no rule that has adapted and no outlier brings about. Well again: fewer than a tenth.
constexpr double kBeyond = 3.0;
constexpr double kLost = 0.5;
constexpr double kWell = 0.1;
// Steps between refreshes of the settled filter's lag, a small linear solve.
constexpr int kLagEvery = 256;
// In a manoeuvre a measurement is held back only when the filter at rest, too, finds it this many sigmas
// away.
constexpr double kFar = 5.0;

bool has(std::uint32_t set, std::size_t axis) noexcept { return (set >> axis & 1U) != 0; }

}  // namespace

Engine::Engine(const FilterSettings& settings, std::unique_ptr<RestFilter> rest, int axes, double period_s)
    : follow_manoeuvres_(settings.follow_manoeuvres),
      conserve_angle_(settings.conserve_angle),
      axes_(static_cast<std::size_t>(axes)),
      period_s_(period_s),
      rest_(std::move(rest)),
      ledger_(period_s) {}

void Engine::step(const EstimatorInput& in, EstimatorOutput& out) noexcept {
  out.flags = 0;
  Measurement m{in,
                screen(in, out),
                in.dt_s > 0.0 ? in.dt_s : period_s_,
                in.averaged_s > 0.0 ? period_s_ / in.averaged_s : 1.0,
                {}};
  rest_->predict(m.dt_s);
  begin_axes(in.rate_radps, m.valid);
  for (std::size_t a = 0; a < axes_; ++a) {
    if (has(m.valid, a)) m.innovation[a] = in.rate_radps[a] - rest_->measurement(a);
  }
  out.innovation_radps = m.innovation;

  if (follow_manoeuvres_) {
    follow(m, out);
  } else {
    update_rest(m, true);
  }
  guard(m, out);
  publish(m, out);
}

void Engine::restart() noexcept {
  rest_->restart();
  monitor_.rearm();
  started_ = 0;
  first_ = true;
  in_manoeuvre_ = held_ = settling_ = false;
  history_length_ = 0;
  until_lag_ = 0;
}

std::array<double, kMaxAxes> Engine::owed() const noexcept {
  Axes angle{};
  if (!conserve_angle_) return angle;
  for (std::size_t a = 0; a < axes_; ++a)
    if (has(booked_, a)) angle[a] = ledger_.owed(a);
  return angle;
}

void Engine::owe(const std::array<double, kMaxAxes>& angle_rad) noexcept {
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!std::isfinite(angle_rad[a]) || angle_rad[a] == 0.0) continue;
    ledger_.owe(a, angle_rad[a]);
    booked_ |= 1U << a;
  }
}

// Which axes have a measurement that can be used.
std::uint32_t Engine::screen(const EstimatorInput& in, EstimatorOutput& out) noexcept {
  std::uint32_t valid = 0;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(in.valid_axes, a) || !std::isfinite(in.rate_radps[a])) continue;
    if (check_.stuck(a, in.rate_radps[a])) {
      out.flags |= kStuck;
      continue;
    }
    valid |= 1U << a;
  }
  return valid;
}

void Engine::begin_axes(const Axes& rate, std::uint32_t valid) noexcept {
  const std::uint32_t fresh = valid & ~started_;
  if (fresh == 0) return;
  rest_->shift_to(rate, fresh);
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(fresh, a)) continue;
    // After a restart the debt stands; only where the lag is counted from is new.
    if (has(booked_, a)) {
      ledger_.end_manoeuvre(a, rate[a]);
    } else {
      ledger_.begin(a, rate[a]);
    }
  }
  started_ |= fresh;
  booked_ |= fresh;
}

void Engine::update_rest(const Measurement& m, bool learn) noexcept {
  if (m.valid == 0) {
    rest_->skip();
    return;
  }
  // The first measurement sets the state; its innovation is zero by construction and no evidence.
  rest_->update(m.in.rate_radps, m.valid, m.noise_scale, m.in.sequence, learn && !first_);
  first_ = false;
  if (!learn) return;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (has(m.valid, a)) grade(a, m.innovation[a], rest_->covariance());
  }
}

void Engine::follow(const Measurement& m, EstimatorOutput& out) noexcept {
  remember(m.in.rate_radps, m.valid);
  const InnovationMonitor::Verdict verdict =
      monitor_.test({m.innovation.data(), axes_}, m.valid, !in_manoeuvre_);
  if (in_manoeuvre_) {
    follow_manoeuvre(m, verdict, out);
  } else if (verdict.changed_since > 0) {
    begin_manoeuvre(verdict.changed_since, out);
  } else if (verdict.suspect) {
    hold(m, out);
  } else {
    held_ = false;
    follow_rest(m);
  }
  judge_noise(m);
}

// A manoeuvre throughout which every axis had nothing but noise was none, and is over.
void Engine::judge_noise(const Measurement& m) noexcept {
  bool all_noise = m.valid != 0;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(m.valid, a)) continue;
    noise_or_motion_.take(a, m.in.rate_radps[a],
                          in_manoeuvre_ ? trackers_.best_innovation(a) : m.innovation[a]);
    monitor_.allow(a, noise_or_motion_.variance(a), noise_or_motion_.widening(a));
    all_noise = all_noise && noise_or_motion_.noise(a);
  }
  manoeuvre_samples_ = in_manoeuvre_ ? std::min(manoeuvre_samples_ + 1, NoiseOrMotion::kWindow) : 0;
  if (!all_noise || manoeuvre_samples_ < NoiseOrMotion::kWindow) return;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (has(m.valid, a)) monitor_.adopt(a, noise_or_motion_.variance(a), noise_or_motion_.widening(a));
  }
  jump(kHistory);
  end_manoeuvre();
}

void Engine::follow_rest(const Measurement& m) noexcept {
  update_rest(m, !settling_);
  if (settling_) {
    settling_ = m.valid == 0 || rest_->variance() < kSettled * settling_variance_;
    settling_variance_ = rest_->variance();
    return;
  }
  const double share = monitor_.armed() ? 1.0 / kRestMemory : 1.0;
  rest_gain_ += share * (rest_->measurement_gain() - rest_gain_);
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(m.valid, a)) continue;
    monitor_.learn_still(a, m.in.rate_radps[a]);
    // Learned while the sensor moved, the rule's window holds motion, not noise.
    if (steps_ > 0 && monitor_.learn(a, m.innovation[a], m.noise_scale)) rest_->rule().restart();
  }
  ++steps_;
}

// Measurement noise of an axis now: what the monitor sees of innovations at rest, less the filter's own
// share.
double Engine::noise(std::size_t axis) const noexcept { return monitor_.variance(axis) * (1.0 - rest_gain_); }

// A sample that nothing else supports yet: passed over, and booked in case the next one supports it. In noise
// with tails or a colour it takes several in a row.
void Engine::hold(const Measurement& m, EstimatorOutput& out) noexcept {
  out.flags |= kGated;
  ++health_.gated;
  rest_->skip();
  if (!held_) held_angle_ = {};
  held_ = true;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(m.valid, a) || in_manoeuvre_) continue;
    held_angle_[a] += (m.in.rate_radps[a] - last_output_[a]) * m.covered_s(a);
    // Clipped, it counts for the scale: what happens to one sample in a hundred is the sensor's noise.
    monitor_.learn(a, m.innovation[a], m.noise_scale);
  }
}

void Engine::admit_held() noexcept {
  if (!held_) return;
  for (std::size_t a = 0; a < axes_; ++a) ledger_.admit(a, held_angle_[a]);
  held_ = false;
}

void Engine::remember(const Axes& rate, std::uint32_t valid) noexcept {
  Axes& place = history_[history_at_];
  for (std::size_t a = 0; a < axes_; ++a) place[a] = has(valid, a) ? rate[a] : last_output_[a];
  history_at_ = (history_at_ + 1) % kHistory;
  if (history_length_ < kHistory) ++history_length_;
}

// The last `count` measurements, oldest first.
std::span<const Axes> Engine::recent(std::size_t count) noexcept {
  count = std::min(count, history_length_);
  for (std::size_t i = 0; i < count; ++i)
    recent_[i] = history_[(history_at_ + kHistory - count + i) % kHistory];
  return {recent_.data(), count};
}

// P- is raised to explain the change from where it began: the filter then stands at the mean of the
// measurements since, with their variance, as if it had been raised there and had filtered them.
void Engine::jump(int since) noexcept {
  const std::span<const Axes> last = recent(static_cast<std::size_t>(since));
  const auto count = static_cast<double>(last.size());
  Axes mean{};
  for (const Axes& rate : last) {
    for (std::size_t a = 0; a < axes_; ++a) mean[a] += rate[a] / count;
  }
  rest_->shift_to(mean, started_);
  rest_->raise_to(rest_->rule().measurement_noise() / count);
  rest_->skip();
  settling_ = true;
  settling_variance_ = rest_->variance();
  monitor_.rearm();
}

void Engine::begin_manoeuvre(int since, EstimatorOutput& out) noexcept {
  out.flags |= kManoeuvre;
  ++health_.manoeuvres;
  admit_held();
  ledger_.begin_manoeuvre();
  trackers_.begin(recent(static_cast<std::size_t>(since)));
  jump(since);
  in_manoeuvre_ = true;
  quiet_ = calm_ = 0;
}

void Engine::follow_manoeuvre(const Measurement& m, const InnovationMonitor::Verdict& verdict,
                              EstimatorOutput& out) noexcept {
  out.flags |= kManoeuvre;
  Axes noises{};
  for (std::size_t a = 0; a < axes_; ++a) noises[a] = noise(a);
  trackers_.predict(m.dt_s / period_s_);
  const double level_factor = 1.0 + rest_->measurement_variance() / rest_->rule().measurement_noise();
  if (trackers_.improbable(m.in.rate_radps, noises, m.valid) && far_from_rest(m)) {
    if (!held_) {
      hold(m, out);
      return;
    }
    admit_held();
    trackers_.begin_again(recent(2));
    jump(1);
    quiet_ = calm_ = 0;
    return;
  }
  held_ = false;
  trackers_.update(m.in.rate_radps, noises, m.valid, m.innovation, level_factor);
  if (verdict.changed_since > 0) {
    jump(verdict.changed_since);
    quiet_ = calm_ = 0;
  } else {
    update_rest(m, false);
    quiet_ = trackers_.level_weight() > 0.5 ? quiet_ + 1 : 0;
    calm_ = verdict.calm ? calm_ + 1 : 0;
  }
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(m.valid, a)) continue;
    monitor_.learn(a, trackers_.best_innovation(a), trackers_.best_factor() * (1.0 - rest_gain_));
  }
  if (quiet_ >= kQuiet || calm_ >= kCalmSamples) end_manoeuvre();
}

bool Engine::far_from_rest(const Measurement& m) const noexcept {
  for (std::size_t a = 0; a < axes_; ++a) {
    const double bound = kFar * kFar * (monitor_.variance(a) + rest_->measurement_variance());
    if (has(m.valid, a) && m.innovation[a] * m.innovation[a] > bound) return true;
  }
  return false;
}

void Engine::end_manoeuvre() noexcept {
  in_manoeuvre_ = false;
  for (std::size_t a = 0; a < axes_; ++a) ledger_.end_manoeuvre(a, rest_->rate(a));
}

// Divergence: a covariance that is no longer one, a state that is no number, or a filter that for long has
// been further from the measurements than it believes possible, its rule having had all the time to adapt.
// Either way it starts again from this measurement. If that does not help, the noise it was told is wrong,
// and starting again and again would not mend it: it is then left alone until it has been well.
void Engine::guard(const Measurement& m, EstimatorOutput& out) noexcept {
  bool lost = false, well = true;
  for (std::size_t a = 0; a < axes_; ++a) {
    lost = lost || grades_[a].beyond > kLost;
    well = well && grades_[a].beyond < kWell;
  }
  if (well) lost_ = false;
  const bool newly_lost = lost && !lost_;
  lost_ = lost_ || lost;
  if (rest_->sound() && !newly_lost) return;
  ++health_.divergences;
  ++health_.restarts;
  out.flags |= kRestarted;
  restart();
  begin_axes(m.in.rate_radps, m.valid);
  update_rest(m, false);
}

void Engine::publish(const Measurement& m, EstimatorOutput& out) noexcept {
  for (std::size_t a = 0; a < axes_; ++a) {
    const double rest = rest_->rate(a);
    double rate = rest;
    out.variance_rad2ps2[a] = rest_->variance();
    out.gain[a] = rest_->gain();
    if (in_manoeuvre_) {
      rate = trackers_.rate(a, rest);
      out.variance_rad2ps2[a] = trackers_.variance(a, rest, rest_->variance(), noise(a));
      out.gain[a] = trackers_.gain(rest_->gain());
    }
    if (conserve_angle_) {
      rate += ledger_.payment(a, lag_s_);
      // An outlier at rest is no rotation; in a manoeuvre every sample may be, and is booked.
      if (has(m.valid, a) && ((out.flags & kGated) == 0 || in_manoeuvre_)) {
        ledger_.book(a, m.in.rate_radps[a], rate, m.covered_s(a), in_manoeuvre_);
        if (!in_manoeuvre_) ledger_.settle(a, rest, lag_s_);
      }
    }
    out.denoised_radps[a] = rate;
    out.innovation_variance[a] = rest_->covariance();
    last_output_[a] = rate;
    health_.measurement_noise[a] = rest_->rule().measurement_noise();
  }
  health_.floor_hits = rest_->rule().floor_hits();
  // Last, so that a payment never divides what was owed at one lag by another.
  if (--until_lag_ <= 0) {
    until_lag_ = kLagEvery;
    refresh_lag();
  }
}

// Normalised innovation squared and lag-1 autocorrelation, over the last kHealthMemory samples or so.
void Engine::grade(std::size_t axis, double innovation, double variance) noexcept {
  if (!(variance > 0.0)) return;
  const double normalised = innovation / std::sqrt(variance);
  Grade& grade = grades_[axis];
  grade.count = std::min(grade.count + 1.0, kHealthMemory);
  grade.square += (normalised * normalised - grade.square) / grade.count;
  grade.product += (normalised * grade.last - grade.product) / grade.count;
  grade.last = normalised;
  health_.nis_mean[axis] = grade.square;
  health_.whiteness[axis] = grade.square > 0.0 ? grade.product / grade.square : 0.0;
  // From zero, so that it takes most of the memory to be lost: not the start-up of an adaptive rule.
  grade.beyond += ((normalised * normalised > kBeyond * kBeyond ? 1.0 : 0.0) - grade.beyond) / kHealthMemory;
}

void Engine::refresh_lag() noexcept {
  const Settled now = rest_->settled();
  // A filter that has taken in nothing yet has neither.
  if (!std::isfinite(now.lag) || !std::isfinite(now.correlation)) return;
  lag_s_ = std::max(0.0, now.lag) * period_s_;
  health_.group_delay_s = now.lag * period_s_;
  health_.correlation_time_s = now.correlation * period_s_;
}

}  // namespace ifog
