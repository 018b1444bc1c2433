#include "filters/estimator/engine.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "filters/estimator/angle_ledger.h"
#include "filters/estimator/fading_trackers.h"
#include "filters/estimator/innovation_monitor.h"
#include "filters/estimator/rest_filter.h"
#include "filters/estimator/sensor_check.h"
#include "filters/kalman/settled.h"

namespace ifog {
namespace {

// Samples without a new change and with the filter at rest the likeliest, after which the manoeuvre is over.
constexpr int kQuiet = 64;
// P raised by a manoeuvre counts as settled when it is back to this multiple of what it was at rest.
constexpr double kSettledExcess = 1.5;
// Measurements kept for starting the trackers at the beginning of a change.
constexpr std::size_t kHistory = 16;
constexpr double kHealthMemory = 512.0;
// Steps between refreshes of the settled filter's lag, a small linear solve.
constexpr int kLagEvery = 256;

template <int n>
class SizedEngine final : public Engine {
 public:
  explicit SizedEngine(EngineParts parts)
      : settings_(std::move(parts.settings)),
        axes_(parts.axes),
        period_s_(parts.period_s),
        rest_(std::move(parts.model), std::move(parts.rule), settings_.process_noise,
              settings_.measurement_noise),
        check_(settings_.range_radps),
        ledger_(parts.period_s) {}

  void step(const EstimatorInput& in, EstimatorOutput& out) noexcept override {
    out.flags = 0;
    const std::uint32_t valid = screen(in, out);
    const double dt_s = in.dt_s > 0.0 ? in.dt_s : period_s_;
    rest_.predict(dt_s);
    begin_axes(in, valid);

    Axes innovation{};
    for (int axis = 0; axis < axes_; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      if (valid >> a & 1U) innovation[a] = in.rate_radps[a] - rest_.rate(axis);
    }
    out.innovation_radps = innovation;

    if (settings_.follow_manoeuvres) {
      follow(in, valid, innovation, dt_s, out);
    } else {
      update_rest(in, valid, true);
      for (std::size_t a = 0; a < kMaxAxes; ++a) {
        if (valid >> a & 1U) grade(a, innovation[a], covariance_);
      }
    }
    guard(in, valid, out);
    publish(in, valid, dt_s, out);
  }

  void restart() noexcept override {
    rest_.restart();
    monitor_.rearm();
    started_ = 0;
    first_ = true;
    in_manoeuvre_ = held_ = false;
    settling_ = false;
    history_length_ = 0;
    until_lag_ = 0;
  }

  const EstimatorHealth& health() const noexcept override { return health_; }

 private:
  using Axes = std::array<double, kMaxAxes>;

  // Which axes have a measurement that can be used.
  std::uint32_t screen(const EstimatorInput& in, EstimatorOutput& out) noexcept {
    std::uint32_t valid = 0;
    for (int axis = 0; axis < axes_; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      if ((in.valid_axes >> a & 1U) == 0 || !std::isfinite(in.rate_radps[a])) continue;
      if (check_.saturated(in.rate_radps[a])) out.flags |= kSaturated;
      if (check_.stuck(a, in.rate_radps[a])) {
        out.flags |= kStuck;
        continue;
      }
      valid |= 1U << a;
    }
    return valid;
  }

  void begin_axes(const EstimatorInput& in, std::uint32_t valid) noexcept {
    const std::uint32_t fresh = valid & ~started_;
    if (fresh == 0) return;
    for (int axis = 0; axis < axes_; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      if ((fresh >> a & 1U) == 0) continue;
      rest_.shift_to(axis, in.rate_radps[a]);
      // After a restart the debt stands; only where the lag is counted from is new.
      if (booked_ >> a & 1U) {
        ledger_.end_manoeuvre(a, in.rate_radps[a]);
      } else {
        ledger_.begin(a, in.rate_radps[a]);
      }
    }
    started_ |= fresh;
    booked_ |= fresh;
  }

  double noise_scale(const EstimatorInput& in) const noexcept {
    return in.averaged_s > 0.0 ? period_s_ / in.averaged_s : 1.0;
  }

  void update_rest(const EstimatorInput& in, std::uint32_t valid, bool learn) noexcept {
    std::array<int, kMaxAxes> axes{};
    Axes rates{};
    std::size_t count = 0;
    for (int axis = 0; axis < axes_; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      if ((valid >> a & 1U) == 0) continue;
      axes[count] = axis;
      rates[count++] = in.rate_radps[a];
    }
    if (count == 0) {
      rest_.skip();
      covariance_ = rest_.variance();
      return;
    }
    // The first measurement sets the state; its innovation is zero by construction and no evidence.
    covariance_ = rest_.update(axes, rates, count, noise_scale(in), in.sequence, learn && !first_);
    first_ = false;
  }

  // Measurement noise of an axis now: what the monitor sees of innovations at rest, less the filter's own
  // share.
  double noise(std::size_t axis) const noexcept { return monitor_.variance(axis) * (1.0 - rest_gain_); }

  void follow(const EstimatorInput& in, std::uint32_t valid, const Axes& innovation, double dt_s,
              EstimatorOutput& out) noexcept {
    remember(in.rate_radps);
    const InnovationMonitor::Verdict verdict =
        monitor_.test({innovation.data(), static_cast<std::size_t>(axes_)}, valid);
    if (in_manoeuvre_) {
      follow_manoeuvre(in, valid, innovation, verdict, dt_s, out);
      return;
    }
    if (verdict.changed_since > 0) {
      begin_manoeuvre(in, verdict.changed_since, out);
      return;
    }
    if (verdict.suspect) {
      hold(in, valid, dt_s, out);
      return;
    }
    held_ = false;
    if (settling_ && rest_.variance() < kSettledExcess * rest_variance_) settling_ = false;
    update_rest(in, valid, !settling_);
    const double gain = rest_.gain();
    if (!settling_) {
      rest_variance_ =
          monitor_.armed() ? rest_variance_ + (rest_.variance() - rest_variance_) / 64.0 : rest_.variance();
      rest_gain_ = monitor_.armed() ? rest_gain_ + (gain - rest_gain_) / 64.0 : gain;
    }
    for (int axis = 0; axis < axes_; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      if ((valid >> a & 1U) == 0) continue;
      grade(a, innovation[a], covariance_);
      monitor_.learn_start(a, in.rate_radps[a]);
      if (steps_ > 0 && !settling_ && monitor_.learn(a, innovation[a], noise_scale(in)))
        rest_.rule().restart();
    }
    ++steps_;
  }

  // One sample that nothing else supports: passed over, and booked in case the next one supports it.
  void hold(const EstimatorInput& in, std::uint32_t valid, double dt_s, EstimatorOutput& out) noexcept {
    out.flags |= kGated;
    ++health_.gated;
    rest_.skip();
    covariance_ = rest_.variance() + rest_.rule().measurement_noise();
    held_ = true;
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      held_angle_[a] =
          (valid >> a & 1U) != 0 && !in_manoeuvre_ ? (in.rate_radps[a] - last_output_[a]) * dt_s : 0.0;
    }
  }

  void admit_held() noexcept {
    if (!held_) return;
    for (std::size_t a = 0; a < kMaxAxes; ++a) ledger_.admit(a, held_angle_[a]);
    held_ = false;
  }

  void remember(const Axes& rate) noexcept {
    history_[history_at_] = rate;
    history_at_ = (history_at_ + 1) % kHistory;
    if (history_length_ < kHistory) ++history_length_;
  }

  // The last `count` measurements, oldest first.
  std::span<const Axes> recent(std::size_t count) noexcept {
    count = std::min(count, history_length_);
    for (std::size_t i = 0; i < count; ++i) {
      recent_[i] = history_[(history_at_ + kHistory - count + i) % kHistory];
      for (std::size_t a = 0; a < kMaxAxes; ++a) {
        if (!std::isfinite(recent_[i][a])) recent_[i][a] = i > 0 ? recent_[i - 1][a] : last_output_[a];
      }
    }
    return {recent_.data(), count};
  }

  // P- is raised to explain the change from where it began: the filter then stands at the mean of the
  // measurements since, with their variance, as if it had been raised there and had filtered them.
  void jump(int since) noexcept {
    const std::span<const Axes> last = recent(static_cast<std::size_t>(since));
    const auto count = static_cast<double>(last.size());
    for (int axis = 0; axis < axes_; ++axis) {
      double mean = 0.0;
      for (const Axes& rate : last) mean += rate[static_cast<std::size_t>(axis)];
      rest_.shift_to(axis, mean / count);
    }
    rest_.raise_to(rest_.rule().measurement_noise() / count);
    rest_.skip();
    covariance_ = rest_.variance() + rest_.rule().measurement_noise();
    settling_ = true;
    monitor_.rearm();
  }

  void begin_manoeuvre(const EstimatorInput& /*in*/, int since, EstimatorOutput& out) noexcept {
    out.flags |= kManoeuvre;
    ++health_.manoeuvres;
    admit_held();
    ledger_.begin_manoeuvre();
    trackers_.begin(recent(static_cast<std::size_t>(since)));
    jump(since);
    in_manoeuvre_ = true;
    quiet_ = 0;
  }

  void follow_manoeuvre(const EstimatorInput& in, std::uint32_t valid, const Axes& innovation,
                        const InnovationMonitor::Verdict& verdict, double dt_s,
                        EstimatorOutput& out) noexcept {
    out.flags |= kManoeuvre;
    Axes noises{};
    for (std::size_t a = 0; a < kMaxAxes; ++a) noises[a] = noise(a);
    const double steps = dt_s / period_s_;
    trackers_.predict(steps);
    const double level_factor = 1.0 + rest_.variance() / rest_.rule().measurement_noise();
    if (trackers_.improbable(in.rate_radps, noises, valid) && verdict_far(innovation, valid)) {
      if (!held_) {
        hold(in, valid, dt_s, out);
        return;
      }
      admit_held();
      trackers_.begin(recent(2));
      jump(1);
      quiet_ = 0;
      return;
    }
    held_ = false;
    Axes rates = in.rate_radps;
    trackers_.update(rates, noises, valid, innovation, level_factor);
    if (verdict.changed_since > 0) {
      jump(verdict.changed_since);
      quiet_ = 0;
    } else {
      update_rest(in, valid, false);
      quiet_ = trackers_.level_weight() > 0.5 ? quiet_ + 1 : 0;
    }
    for (int axis = 0; axis < axes_; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      if ((valid >> a & 1U) == 0) continue;
      grade(a, trackers_.best_innovation(a), trackers_.best_factor() * noises[a]);
      monitor_.learn(a, trackers_.best_innovation(a), trackers_.best_factor() * (1.0 - rest_gain_));
    }
    if (quiet_ >= kQuiet) end_manoeuvre();
  }

  bool verdict_far(const Axes& innovation, std::uint32_t valid) const noexcept {
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      if ((valid >> a & 1U) != 0 &&
          innovation[a] * innovation[a] > 25.0 * (monitor_.variance(a) + rest_.variance())) {
        return true;
      }
    }
    return false;
  }

  void end_manoeuvre() noexcept {
    in_manoeuvre_ = false;
    for (int axis = 0; axis < axes_; ++axis)
      ledger_.end_manoeuvre(static_cast<std::size_t>(axis), rest_.rate(axis));
  }

  // A covariance that is no longer one, or a state that is no number: start again from what comes next.
  void guard(const EstimatorInput& in, std::uint32_t valid, EstimatorOutput& out) noexcept {
    if (rest_.sound()) return;
    ++health_.divergences;
    ++health_.restarts;
    out.flags |= kRestarted;
    restart();
    begin_axes(in, valid);
    update_rest(in, valid, false);
  }

  void publish(const EstimatorInput& in, std::uint32_t valid, double dt_s, EstimatorOutput& out) noexcept {
    if (--until_lag_ <= 0) {
      until_lag_ = kLagEvery;
      refresh_lag();
    }
    const double rest_variance = rest_.variance();
    const double rest_gain = rest_.gain();
    for (int axis = 0; axis < axes_; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double rest = rest_.rate(axis);
      double rate = rest;
      out.variance_rad2ps2[a] = rest_variance;
      out.gain[a] = rest_gain;
      if (in_manoeuvre_) {
        rate = trackers_.rate(a, rest);
        out.variance_rad2ps2[a] = trackers_.variance(a, rest, rest_variance, noise(a));
        out.gain[a] = trackers_.gain(rest_gain);
      }
      if (settings_.conserve_angle) {
        rate += ledger_.payment(a, lag_s_);
        // An outlier at rest is no rotation; in a manoeuvre every sample may be, and is booked.
        if ((valid >> a & 1U) != 0 && ((out.flags & kGated) == 0 || in_manoeuvre_)) {
          ledger_.book(a, in.rate_radps[a], rate, dt_s, in_manoeuvre_);
          if (!in_manoeuvre_) ledger_.settle(a, rest, lag_s_);
        }
      }
      out.denoised_radps[a] = rate;
      out.innovation_variance[a] = covariance_;
      last_output_[a] = rate;
      health_.measurement_noise[a] = rest_.rule().measurement_noise();
    }
    health_.floor_hits = rest_.rule().floor_hits();
  }

  // Normalised innovation squared and lag-1 autocorrelation, over the last kHealthMemory samples or so.
  void grade(std::size_t axis, double innovation, double variance) noexcept {
    if (!(variance > 0.0)) return;
    const double normalised = innovation / std::sqrt(variance);
    Grade& grade = grades_[axis];
    grade.count = std::min(grade.count + 1.0, kHealthMemory);
    grade.square += (normalised * normalised - grade.square) / grade.count;
    grade.product += (normalised * grade.last - grade.product) / grade.count;
    grade.last = normalised;
    health_.nis_mean[axis] = grade.square;
    health_.whiteness[axis] = grade.square > 0.0 ? grade.product / grade.square : 0.0;
  }

  void refresh_lag() noexcept {
    const Settled now = settled<n>(rest_.transition(), rest_.core().h, rest_.core().gain, rest_.core().p);
    const double lag = std::isfinite(now.lag) ? now.lag : 0.0;
    lag_s_ = std::max(0.0, lag) * period_s_;
    health_.group_delay_s = lag * period_s_;
    health_.correlation_time_s = now.correlation * period_s_;
  }

  FilterSettings settings_;
  int axes_;
  double period_s_;
  RestFilter<n> rest_;
  SensorCheck check_;
  InnovationMonitor monitor_;
  FadingTrackers trackers_;
  AngleLedger ledger_;
  EstimatorHealth health_;
  struct Grade {
    double count = 0.0, square = 0.0, product = 0.0, last = 0.0;
  };
  std::array<Grade, kMaxAxes> grades_{};

  std::uint32_t started_ = 0, booked_ = 0;
  bool first_ = true, in_manoeuvre_ = false, held_ = false, settling_ = false;
  int quiet_ = 0, until_lag_ = 0;
  std::int64_t steps_ = 0;
  double covariance_ = 0.0, rest_variance_ = 0.0, rest_gain_ = 0.0, lag_s_ = 0.0;
  Axes held_angle_{}, last_output_{};
  std::array<Axes, kHistory> history_{}, recent_{};
  std::size_t history_at_ = 0, history_length_ = 0;
};

template <int n>
std::unique_ptr<Engine> make_sized(EngineParts parts) {
  return std::make_unique<SizedEngine<n>>(std::move(parts));
}

}  // namespace

std::unique_ptr<Engine> make_engine(EngineParts parts) {
  using Make = std::unique_ptr<Engine> (*)(EngineParts);
  constexpr std::array<Make, kMaxStates> kMakers{make_sized<1>, make_sized<2>, make_sized<3>, make_sized<4>,
                                                 make_sized<5>, make_sized<6>, make_sized<7>, make_sized<8>};
  const int states = parts.model->states();
  if (states < 1 || states > kMaxStates) {
    throw std::invalid_argument("state: " + std::to_string(states) + " states in all, expected 1 to " +
                                std::to_string(kMaxStates));
  }
  return kMakers[static_cast<std::size_t>(states - 1)](std::move(parts));
}

}  // namespace ifog
