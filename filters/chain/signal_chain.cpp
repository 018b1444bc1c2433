// SPDX-License-Identifier: Apache-2.0
#include "filters/chain/signal_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "filters/chain/plausibility.h"
#include "filters/model_file/channel_names.h"
#include "filters/settings/filter_table.h"
#include "filters/state_models/state_model.h"

namespace ifog {
namespace {

// Missing samples after which a sensor at rest is still assumed to be at rest.
constexpr double kShortGap = 16.0;
// Samples for learning the noise: octaves up to 256 samples at least.
constexpr double kLeastStartUp = 4096.0, kMostStartUp = 20000.0;

// Line of the first effect on this channel.
std::uint32_t line_of(const Model& model, const std::string& channel) {
  for (const Effect& effect : model.effects)
    for (const std::string& used : {effect.channel, effect.with_channel})
      if (const ChannelNames names = names_in(used); names.of == channel || names.less == channel)
        return effect.line;
  return 0;
}

}  // namespace

ChainParts::ChainParts(const ChainSettings& settings)
    : facts_(settings.facts), period_s_(1.0 / settings.facts.nominal_rate_hz) {
  FilterSettings base;
  if (settings.model) {
    identity_ = settings.model->identity();
    if (settings.model->filter) base = *settings.model->filter;
    use_effects(settings);
  }
  filter_ = settings_in_force(settings.filter, std::move(base));
  use_noise(settings);
}

// Each value is from the settings, else the model's filter, else its noise terms, else an earlier run.
// Unknown R and random walk are learned.
void ChainParts::use_noise(const ChainSettings& settings) {
  const double rate_hz = facts_.nominal_rate_hz;
  if (settings.model) {
    double noise = filter_.measurement_noise;
    if (noise > 0.0 && filter_.process_noise > 0.0)
      noise += filter_.process_noise *
               make_state_model(filter_.state, filter_.state_parameters, period_s_)->colour_variance();
    const NoiseOfAxes known = noise_of_axes(*settings.model, settings.axes, rate_hz, noise);
    shares_ = known.shares;
    if (filter_.measurement_noise <= 0.0 && known.sample) {
      filter_.measurement_noise = *known.sample;
      of_long_means_ = true;
    }
    if (filter_.process_noise <= 0.0 && known.walk && filter_.state == "random-walk")
      filter_.process_noise = *known.walk;
  }
  learns_process_noise_ = filter_.process_noise <= 0.0;
  const bool learns_measurement_noise = filter_.measurement_noise <= 0.0;
  of_long_means_ = of_long_means_ || learns_measurement_noise;
  double ratio = kMostRatio, samples = 0.0;
  if (settings.learned && filter_.state == "random-walk") {
    const LearnedNoise& learned = *settings.learned;
    if (learns_measurement_noise) {
      filter_.measurement_noise = learned.measurement_noise;
      if (!shares_.noise && learned.measurement_noise > 0.0) {
        shares_.noise = learned.noise;
        for (double& share : *shares_.noise) share /= learned.measurement_noise;
      }
    }
    ratio = learned.process_noise / (learned.measurement_noise * rate_hz);
    // With other corrections the walk may differ, so it is only a start value.
    samples = learned.is_of(identity_) ? learned.samples : std::min(learned.samples, kLeastStartUp);
  }
  if (filter_.measurement_noise > 0.0) {
    begin(ratio, samples);
    return;
  }
  // Constructed once for its checks: a wrong setting is reported at start, not after learning.
  FilterSettings trial = filter_;
  if (trial.process_noise <= 0.0) trial.process_noise = 1e-10;
  trial.measurement_noise = 1e-10;
  const Estimator check(trial, facts_.axes, period_s_);
  start_up_ = Walk(std::clamp(std::round(settings.start_up_s * rate_hz), kLeastStartUp, kMostStartUp));
}

// To be called when R is known.
void ChainParts::begin(double ratio, double samples) {
  if (learns_process_noise_) filter_.process_noise = ratio * filter_.measurement_noise / period_s_;
  KnownNoise known;
  if (shares_.noise) known.share = *shares_.noise;
  known.of_long_means = of_long_means_;
  known.walk_share = shares_.walk;
  known.learns_walk = learns_process_noise_ && filter_.state == "random-walk";
  known.samples = samples;
  estimator_ = std::make_unique<Estimator>(filter_, facts_.axes, period_s_, known);
  estimator_->owe(owed_);
}

ChainParts::~ChainParts() = default;

std::optional<LearnedNoise> ChainParts::learned() const noexcept {
  if (!learns_process_noise_ || !estimator_ || filter_.state != "random-walk") return std::nullopt;
  LearnedNoise out = estimator_->learned();
  if (!(out.samples > 0.0)) return std::nullopt;
  out.set_model(identity_);
  return out;
}

void ChainParts::use_effects(const ChainSettings& settings) {
  // Each channel has its own age limit, so ages are passed in units of it.
  try {
    effects_.compensator.emplace(*settings.model, settings.axes, 1.0,
                                 settings.powered_ns ? 0.0 : settings.since_power_up_s);
  } catch (const std::invalid_argument& error) {
    throw ModelMisfit(0, error.what());
  }
  effects_.powered_ns = settings.powered_ns;
  for (const std::string& name : effects_.compensator->channels()) {
    const auto found = std::find(settings.channels.begin(), settings.channels.end(), name);
    if (found == settings.channels.end()) {
      std::string known;
      for (const std::string& channel : settings.channels) known += (known.empty() ? "" : ", ") + channel;
      throw ModelMisfit(line_of(*settings.model, name), "the model uses channel \"" + printable(name) +
                                                            "\", which this sensor does not have; it has: " +
                                                            (known.empty() ? "none" : known));
    }
    const auto index = static_cast<std::size_t>(found - settings.channels.begin());
    effects_.wanted.push_back(index);
    const double allowed =
        index < settings.channel_max_age_s.size() ? settings.channel_max_age_s[index] : 0.0;
    effects_.relative_age_max.push_back(allowed > 0.0 ? 1.0 / allowed : 0.0);
  }
  effects_.channel.resize(effects_.wanted.size());
  effects_.relative_age.resize(effects_.wanted.size());
}

std::vector<std::string> ChainParts::left_out() const {
  return effects_.compensator ? effects_.compensator->left_out() : std::vector<std::string>{};
}

void ChainParts::compensate(const Increment& in, ChainOutput& out) noexcept {
  out.compensated_radps = in.rate_radps;
  out.delta_theta_rad = in.delta_theta_rad;
  out.compensator_flags = 0;
  if (!effects_.compensator) return;
  if (effects_.powered_ns) {
    // A sample before power-up is from a recording: no warm-up is corrected.
    effects_.compensator->begin(in.read_ns < *effects_.powered_ns
                                    ? std::numeric_limits<double>::infinity()
                                    : static_cast<double>(in.read_ns - *effects_.powered_ns) * 1e-9);
    effects_.powered_ns.reset();
  }
  for (std::size_t i = 0; i < effects_.wanted.size(); ++i) {
    effects_.channel[i] = in.channel[effects_.wanted[i]];
    effects_.relative_age[i] =
        static_cast<double>(in.channel_age_s[effects_.wanted[i]]) * effects_.relative_age_max[i];
  }
  Axes missed_s{};
  for (std::size_t i = 0; i < kMaxAxes; ++i) missed_s[i] = in.dt_s - in.covered_s[i];
  effects_.compensator->step({.dt_s = in.dt_s,
                              .rate_radps = in.rate_radps,
                              .missed_s = missed_s,
                              .channels = effects_.channel,
                              .age_s = effects_.relative_age},
                             effects_.correction);
  refuse_impossible(in, out);
  out.compensated_radps = effects_.correction.compensated_radps;
  out.compensator_flags = effects_.correction.flags;
  for (std::size_t i = 0; i < kMaxAxes; ++i)
    if (in.covered_s[i] > 0.0)
      out.delta_theta_rad[i] -= effects_.correction.correction_radps[i] * in.covered_s[i];
}

// Rejects an implausibly large correction (a wrong model), so that it does not reach the angle.
void ChainParts::refuse_impossible(const Increment& in, ChainOutput& out) noexcept {
  for (std::size_t i = 0; i < static_cast<std::size_t>(facts_.axes); ++i) {
    const double most = facts_.full_scale_radps[i] > 0.0 ? facts_.full_scale_radps[i] : kMostRate_radps;
    const bool measured = in.covered_s[i] > 0.0;
    // NaN fails these comparisons.
    if (!measured || (std::abs(effects_.correction.correction_radps[i]) < most &&
                      std::isfinite(effects_.correction.variance_rad2ps2[i])))
      continue;
    out.flags |= kNotCompensated;
    effects_.correction.correction_radps[i] = 0.0;
    effects_.correction.compensated_radps[i] = in.rate_radps[i];
    effects_.correction.variance_rad2ps2[i] = std::numeric_limits<double>::quiet_NaN();
  }
}

// Until a stretch of the rate is noise (white over every octave, plus a walk). While the sensor moves, its
// rate is published as measured.
void ChainParts::learn(const Increment& in, const ChainOutput& out) noexcept try {
  if ((in.flags & kGapBefore) != 0 && in.dt_s > kShortGap * period_s_) start_up_.gap();
  // Repeated values do not show noise.
  const std::optional<Walk::Found> found =
      start_up_.take(out.compensated_radps, in.valid_axes & ~in.stuck_axes);
  if (!found) return;
  double sum = 0.0, axes = 0.0;
  for (const double noise : found->noise) {
    sum += noise;
    axes += noise > 0.0 ? 1.0 : 0.0;
  }
  if (!(sum > 0.0)) return;
  filter_.measurement_noise = sum / axes;
  Axes share{1.0, 1.0, 1.0};
  for (std::size_t a = 0; a < kMaxAxes; ++a)
    if (found->noise[a] > 0.0) share[a] = found->noise[a] / filter_.measurement_noise;
  shares_.noise = share;
  begin(found->ratio, start_up_.samples());
} catch (const std::exception&) {
  // Out of memory: the rate stays as measured, with the flag set.
}

void ChainParts::publish_raw(const Increment& in, ChainOutput& out) noexcept {
  out.flags |= kNoiseUnknown;
  out.estimate = EstimatorOutput{};
  if (in.stuck_axes != 0) out.estimate.flags |= kStuck;
  out.estimate.denoised_radps = out.compensated_radps;
  for (std::size_t i = 0; i < static_cast<std::size_t>(facts_.axes); ++i) {
    out.estimate.variance_rad2ps2[i] =
        first_samples_.variance(i, out.compensated_radps[i], (in.valid_axes >> i & 1U) != 0);
    if (effects_.compensator) out.estimate.variance_rad2ps2[i] += effects_.correction.variance_rad2ps2[i];
  }
}

// An axis without a value in this filter keeps its last value and variance; 0 would be misleading.
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
    parts.measured_axes_ = in.valid_axes;  // a raw rate is not an estimate
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
  // Nominal averaging time of merged samples; timing jitter does not lower the noise.
  input.averaged_s = in.samples > 1 ? in.samples * parts.period_s_ : 0.0;
  parts.estimator_->step(input, out.estimate);
  if (parts.effects_.compensator)
    for (std::size_t i = 0; i < static_cast<std::size_t>(parts.facts_.axes); ++i)
      out.estimate.variance_rad2ps2[i] += parts.effects_.correction.variance_rad2ps2[i];
  parts.measured_axes_ |= in.valid_axes & ~in.stuck_axes;
  hold_unmeasured(out);
}

EstimatorHealth SignalChain::health() const noexcept {
  EstimatorHealth out = parts_->estimator_ ? parts_->estimator_->health() : EstimatorHealth{};
  for (std::uint64_t EstimatorHealth::*counter :
       {&EstimatorHealth::gated, &EstimatorHealth::manoeuvres, &EstimatorHealth::floor_hits,
        &EstimatorHealth::divergences})
    out.*counter += before_.*counter;
  return out;
}

std::unique_ptr<ChainParts> SignalChain::swap(std::unique_ptr<ChainParts> parts) noexcept {
  before_ = health();
  if (parts->effects_.compensator && parts_->effects_.compensator)
    parts->effects_.compensator->take_over(*parts_->effects_.compensator);
  parts->owed_ = parts_->estimator_ ? parts_->estimator_->owed() : parts_->owed_;
  if (parts->estimator_) parts->estimator_->owe(parts->owed_);
  std::swap(parts_, parts);
  return parts;
}

}  // namespace ifog
