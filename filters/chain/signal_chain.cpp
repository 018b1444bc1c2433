// SPDX-License-Identifier: Apache-2.0
#include "filters/chain/signal_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "filters/chain/plausibility.h"
#include "filters/estimator/start_up.h"
#include "filters/model_file/channel_names.h"
#include "filters/settings/filter_table.h"

namespace ifog {
namespace {

constexpr std::size_t kLeastStartUp = 256;
constexpr std::size_t kMostStartUp = 20000;
// Of the driving noise of a sample over the measurement's, as learned, where changes of rate are followed.
// Ten thousand times any gyro's: what looks quicker was a motion, and a filter that is quicker than the
// trackers of motions would never be found at rest again, nor learn better.
constexpr double kMostLearnedRatio = 1e-3;
// Beyond that by so much, the noise having turned out quieter, it is brought back.
constexpr double kOutOfReach = 2.0;
// Samples lost in a row, at most, after which a sensor at rest still is.
constexpr double kShortGap = 16.0;

// Of the first effect on that channel.
std::uint32_t line_of(const Model& model, const std::string& channel) {
  for (const Effect& effect : model.effects)
    for (const std::string& used : {effect.channel, effect.with_channel})
      if (const ChannelNames names = names_in(used); names.of == channel || names.less == channel)
        return effect.line;
  return 0;
}

// Axes that repeat one value while another does not.
std::uint32_t stuck_beside_others(const Increment& in) noexcept {
  return (in.valid_axes & ~in.stuck_axes) != 0 ? in.stuck_axes : 0;
}

}  // namespace

void ExactSum::add(double term) noexcept {
  const double sum = sum_ + term;
  lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
  sum_ = sum;
}

ChainParts::ChainParts(const ChainSettings& settings)
    : facts_(settings.facts), period_s_(1.0 / settings.facts.nominal_rate_hz) {
  FilterSettings base;
  if (settings.model) {
    identity_ = settings.model->identity();
    if (settings.model->filter) base = *settings.model->filter;
    shares_ = axis_shares(*settings.model, settings.axes);
    use_effects(settings);
  }
  filter_ = settings_in_force(settings.filter, std::move(base));
  learns_process_noise_ = filter_.process_noise <= 0.0 && filter_.state == "random-walk";
  learns_measurement_noise_ = filter_.measurement_noise <= 0.0;
  if (settings.learned) recall(*settings.learned);
  if (filter_.process_noise > 0.0 && filter_.measurement_noise > 0.0) {
    estimator_ = std::make_unique<Estimator>(filter_, facts_.axes, period_s_);
    if (shares_.noise) estimator_->expect_noise(*shares_.noise);
    estimator_->expect_walk(shares_.walk);
    if (settings.learned && learns_measurement_noise_) estimator_->recall_colour(settings.learned->colour);
    return;
  }
  // Built once for its complaints: a wrong setting is told at start, not after the start-up seconds.
  FilterSettings trial = filter_;
  if (trial.process_noise <= 0.0) trial.process_noise = 1e-10;
  if (trial.measurement_noise <= 0.0) trial.measurement_noise = 1e-10;
  const Estimator check(trial, facts_.axes, period_s_);
  // The nearest: a rate that was found from times is as often below what it is meant to be as above.
  start_up_size_ = std::clamp(
      static_cast<std::size_t>(std::round(std::max(0.0, settings.start_up_s * facts_.nominal_rate_hz))),
      kLeastStartUp, kMostStartUp);
  start_up_.resize(start_up_size_ * static_cast<std::size_t>(facts_.axes));
}

ChainParts::~ChainParts() = default;

// A density learned of a random walk is none of another state model's.
void ChainParts::recall(const LearnedNoise& learned) noexcept {
  if (filter_.state != "random-walk") return;
  if (learns_measurement_noise_) filter_.measurement_noise = learned.measurement_noise;
  if (!learns_process_noise_) return;
  filter_.process_noise = learned.process_noise;
  rest_measurement_noise_ = learned.measurement_noise;
  if (learned.is_of(identity_)) {
    rest_noise_.recall(learned.octaves);
  } else {
    learned_otherwise_ = learned;
    rest_noise_.recall_bound(learned.octaves);
  }
}

std::optional<LearnedNoise> ChainParts::learned() const noexcept {
  if (!learns_process_noise_ || !estimator_ || !(rest_measurement_noise_ > 0.0)) return std::nullopt;
  if (learned_otherwise_ && !rest_noise_.knows_enough()) return learned_otherwise_;
  LearnedNoise out{.process_noise = filter_.process_noise,
                   .measurement_noise = rest_measurement_noise_,
                   .colour = estimator_->health().colour,
                   .octaves = rest_noise_.known(),
                   .model = {}};
  out.set_model(identity_);
  return out;
}

void ChainParts::use_effects(const ChainSettings& settings) {
  // Each channel has a limit of its own: the compensator is given ages in units of it.
  try {
    compensator_.emplace(*settings.model, settings.axes, 1.0,
                         settings.powered_ns ? 0.0 : settings.since_power_up_s);
  } catch (const std::invalid_argument& error) {
    throw ModelMisfit(0, error.what());
  }
  powered_ns_ = settings.powered_ns;
  for (const std::string& name : compensator_->channels()) {
    const auto found = std::find(settings.channels.begin(), settings.channels.end(), name);
    if (found == settings.channels.end()) {
      std::string known;
      for (const std::string& channel : settings.channels) known += (known.empty() ? "" : ", ") + channel;
      throw ModelMisfit(line_of(*settings.model, name), "the model uses channel \"" + printable(name) +
                                                            "\", which this sensor does not have; it has: " +
                                                            (known.empty() ? "none" : known));
    }
    const auto index = static_cast<std::size_t>(found - settings.channels.begin());
    wanted_.push_back(index);
    const double allowed =
        index < settings.channel_max_age_s.size() ? settings.channel_max_age_s[index] : 0.0;
    relative_age_max_.push_back(allowed > 0.0 ? 1.0 / allowed : 0.0);
  }
  channel_.resize(wanted_.size());
  relative_age_.resize(wanted_.size());
}

std::vector<std::string> ChainParts::left_out() const {
  return compensator_ ? compensator_->left_out() : std::vector<std::string>{};
}

void ChainParts::compensate(const Increment& in, ChainOutput& out) noexcept {
  out.compensated_radps = in.rate_radps;
  out.delta_theta_rad = in.delta_theta_rad;
  out.compensator_flags = 0;
  if (!compensator_) return;
  if (powered_ns_) {
    // A sample from before that is a recording's, of which nobody knows: no warm-up, rather than all of it.
    compensator_->begin(in.came_ns < *powered_ns_ ? std::numeric_limits<double>::infinity()
                                                  : static_cast<double>(in.came_ns - *powered_ns_) * 1e-9);
    powered_ns_.reset();
  }
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    channel_[i] = in.channel[wanted_[i]];
    relative_age_[i] = static_cast<double>(in.channel_age_s[wanted_[i]]) * relative_age_max_[i];
  }
  Axes missed_s{};
  for (std::size_t i = 0; i < kMaxAxes; ++i) missed_s[i] = in.dt_s - in.covered_s[i];
  compensator_->step({.dt_s = in.dt_s,
                      .rate_radps = in.rate_radps,
                      .missed_s = missed_s,
                      .channels = channel_,
                      .age_s = relative_age_},
                     correction_);
  refuse_impossible(in, out);
  out.compensated_radps = correction_.compensated_radps;
  out.compensator_flags = correction_.flags;
  for (std::size_t i = 0; i < kMaxAxes; ++i)
    if (in.covered_s[i] > 0.0) out.delta_theta_rad[i] -= correction_.correction_radps[i] * in.covered_s[i];
}

// A correction as large as anything the sensor measures is a model gone wrong, whatever its numbers look like
// one by one. It must not reach the angle, which keeps for ever what it is given.
void ChainParts::refuse_impossible(const Increment& in, ChainOutput& out) noexcept {
  for (std::size_t i = 0; i < static_cast<std::size_t>(facts_.axes); ++i) {
    const double most = facts_.full_scale_radps[i] > 0.0 ? facts_.full_scale_radps[i] : kMostRate_radps;
    const bool measured = in.covered_s[i] > 0.0;
    // Written so that NaN fails.
    if (!measured ||
        (std::abs(correction_.correction_radps[i]) < most && std::isfinite(correction_.variance_rad2ps2[i])))
      continue;
    out.flags |= kNotCompensated;
    correction_.correction_radps[i] = 0.0;
    correction_.compensated_radps[i] = in.rate_radps[i];
    correction_.variance_rad2ps2[i] = std::numeric_limits<double>::quiet_NaN();
  }
}

void ChainParts::learn(const Increment& in, const ChainOutput& out) noexcept try {
  if (in.valid_axes == 0) return;  // so that at least one axis has enough for the estimate below
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(facts_.axes); ++axis)
    start_up_[axis * start_up_size_ + collected_] = out.compensated_radps[axis];
  if (++collected_ < start_up_size_) return;
  // What repeats one value shows no noise, and would make that of the others look smaller.
  if (const std::uint32_t stuck = stuck_beside_others(in); stuck != 0)
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(facts_.axes); ++axis)
      if ((stuck >> axis & 1U) != 0)
        std::fill_n(start_up_.begin() + static_cast<std::ptrdiff_t>(axis * start_up_size_), start_up_size_,
                    std::numeric_limits<double>::quiet_NaN());
  const NoiseEstimate noise = estimate_noise(start_up_, facts_.axes, period_s_);
  if (learns_measurement_noise_) filter_.measurement_noise = noise.measurement_noise;
  if (filter_.process_noise <= 0.0) {
    filter_.process_noise = noise.process_noise;
    if (learns_process_noise_ && filter_.follow_manoeuvres) {
      colour_ = noise.measurement_noise / noise.slow_noise;
      filter_.process_noise = within_reach(noise.process_noise, filter_.measurement_noise);
    }
  }
  moved_ = noise.moved;
  rest_noise_.begin_after(start_up_size_);
  estimator_ = std::make_unique<Estimator>(filter_, facts_.axes, period_s_);
  retune();
  shares_.walk = noise.walk_share;
  estimator_->expect_walk(shares_.walk);
  estimator_->owe(owed_);
} catch (const std::exception&) {
  // Data that no noise can be learned from: the next seconds may be better. Until then it is unknown, and
  // said.
  collected_ = 0;
}

double ChainParts::within_reach(double process_noise, double measurement_noise) const noexcept {
  return std::min(process_noise, kMostLearnedRatio * measurement_noise / (colour_ * period_s_));
}

void ChainParts::retune() noexcept { estimator_->retune(filter_.process_noise * colour_, 1.0 / colour_); }

// Noise that turns out quieter than the start-up data said makes a walk that was within reach one that is
// not.
void ChainParts::keep_within_reach() noexcept {
  if (!filter_.follow_manoeuvres) return;
  double noise = 0.0;
  for (const double axis : estimator_->health().measurement_noise) noise = std::max(noise, axis);
  if (!(noise > 0.0) || filter_.process_noise <= kOutOfReach * within_reach(1e300, noise)) return;
  filter_.process_noise = within_reach(filter_.process_noise, noise);
  retune();
}

// The random walk shows itself slowly: what start-up data said of it, perhaps under way, is corrected
// whenever the sensor has rested long enough to say more.
void ChainParts::learn_on(const Increment& in, const ChainOutput& out) noexcept {
  RestSample is = (out.estimate.flags & kAtRest) != 0 ? RestSample::kRest : RestSample::kPassedOver;
  // Few samples that are lost are as good as few that cannot be used. What the sensor does for longer nobody
  // knows.
  const bool hole = (in.flags & kGapBefore) != 0 && in.dt_s > kShortGap * period_s_;
  if ((out.estimate.flags & kManoeuvre) != 0 || hole) is = RestSample::kMotion;
  rest_noise_.take(out.compensated_radps, in.valid_axes & ~stuck_beside_others(in), is);
  keep_within_reach();
  const std::optional<NoiseEstimate> found = rest_noise_.take_news(period_s_);
  if (!found) return;
  filter_.process_noise = found->process_noise;
  if (filter_.follow_manoeuvres) {
    colour_ = found->measurement_noise / found->slow_noise;
    filter_.process_noise = within_reach(found->process_noise, found->measurement_noise);
  }
  rest_measurement_noise_ = found->measurement_noise;
  retune();
  // What the first seconds said of each axis' part of the walk was no better than what they said of the walk.
  shares_.walk.reset();
  estimator_->expect_walk(shares_.walk);
}

void ChainParts::publish_raw(const Increment& in, ChainOutput& out) noexcept {
  out.flags |= kNoiseUnknown;
  out.estimate = EstimatorOutput{};
  if (in.stuck_axes != 0) out.estimate.flags |= kStuck;
  out.estimate.denoised_radps = out.compensated_radps;
  for (std::size_t i = 0; i < static_cast<std::size_t>(facts_.axes); ++i) {
    out.estimate.variance_rad2ps2[i] =
        first_samples_.variance(i, out.compensated_radps[i], (in.valid_axes >> i & 1U) != 0);
    if (compensator_) out.estimate.variance_rad2ps2[i] += correction_.variance_rad2ps2[i];
  }
}

// Of an axis that has had no value 0, with a variance that says how well that is known, would be believed;
// and of one that the filter in use has not been given yet. That one holds what was known of it.
void SignalChain::hold_unmeasured(ChainOutput& out) noexcept {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  EstimatorOutput& now = out.estimate;
  for (std::size_t i = 0; i < static_cast<std::size_t>(parts_->facts_.axes); ++i) {
    if ((known_axes_ >> i & 1U) == 0) {
      now.denoised_radps[i] = now.variance_rad2ps2[i] = kNone;
    } else if ((parts_->measured_axes_ >> i & 1U) != 0 || !std::isfinite(held_radps_[i])) {
      held_radps_[i] = now.denoised_radps[i];
      held_rad2ps2_[i] = now.variance_rad2ps2[i];
    } else {
      now.denoised_radps[i] = held_radps_[i];
      now.variance_rad2ps2[i] = held_rad2ps2_[i];
    }
  }
}

void SignalChain::process(const Increment& in, ChainOutput& out) noexcept {
  ChainParts& parts = *parts_;
  known_axes_ |= in.valid_axes;
  out.flags = 0;
  parts.compensate(in, out);
  for (std::size_t i = 0; i < static_cast<std::size_t>(parts.facts_.axes); ++i) {
    angle_[i].add(out.delta_theta_rad[i]);
    out.angle_rad[i] = angle_[i].value();
  }
  if (parts.estimator_ == nullptr) {
    parts.publish_raw(in, out);
    parts.measured_axes_ = in.valid_axes;  // a raw rate is nobody's estimate
    hold_unmeasured(out);
    parts.measured_axes_ = 0;
    parts.learn(in, out);
    return;
  }
  if (std::exchange(parts.first_, false)) out.flags |= kFilterReset;
  EstimatorInput input;
  input.sequence = in.sequence;
  input.dt_s = in.dt_s;
  input.rate_radps = out.compensated_radps;
  input.covered_s = in.covered_s;
  input.valid_axes = in.valid_axes;
  input.stuck_axes = in.stuck_axes;
  // A mean over so many whole samples, merged or summed: timing jitter makes no noise quieter.
  input.averaged_s = in.samples > 1 ? in.samples * parts.period_s_ : 0.0;
  parts.estimator_->step(input, out.estimate);
  if (parts.learns_process_noise_) parts.learn_on(in, out);
  if (parts.compensator_)
    for (std::size_t i = 0; i < static_cast<std::size_t>(parts.facts_.axes); ++i)
      out.estimate.variance_rad2ps2[i] += parts.correction_.variance_rad2ps2[i];
  parts.measured_axes_ |= in.valid_axes & ~in.stuck_axes;
  hold_unmeasured(out);
}

EstimatorHealth SignalChain::health() const noexcept {
  EstimatorHealth out = parts_->estimator_ ? parts_->estimator_->health() : EstimatorHealth{};
  for (std::uint64_t EstimatorHealth::*counter :
       {&EstimatorHealth::gated, &EstimatorHealth::manoeuvres, &EstimatorHealth::floor_hits,
        &EstimatorHealth::divergences, &EstimatorHealth::restarts})
    out.*counter += before_.*counter;
  return out;
}

std::unique_ptr<ChainParts> SignalChain::swap(std::unique_ptr<ChainParts> parts) noexcept {
  before_ = health();
  if (parts->compensator_ && parts_->compensator_) parts->compensator_->take_over(*parts_->compensator_);
  parts->owed_ = parts_->estimator_ ? parts_->estimator_->owed() : parts_->owed_;
  if (parts->estimator_) parts->estimator_->owe(parts->owed_);
  std::swap(parts_, parts);
  return parts;
}

}  // namespace ifog
