// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/sensor_watch.h"

#include <algorithm>
#include <cmath>
#include <ifog/status_t.hpp>

#include "filters/units/field_units.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr double kFewestSamples = 100.0;  // per block
constexpr double kMostlyAtRest = 0.9;     // of a block that is used
constexpr double kLoud = 1.5;             // factor of the mean square
constexpr double kOddCorrelation = 0.1, kOddErrors = 5.0;
// Turned by this angle, rad, the Earth's rate along an axis may change by 0.015 °/h.
constexpr double kTurned = 1e-3;
constexpr int kSilence = 10;  // looks without a sample: the device may have been off
constexpr double kRange_s = 600.0, kRangeShare = 0.5;
constexpr double kTellStep = 360.0;  // in blocks
constexpr double kCusums = 3.0;
constexpr double kLatest = 0.2;  // weight of a block in the present noise level

double blocks_between_alarms(std::size_t axes, double block_s, double share) {
  return SensorWatch::kAlarmEvery_s / block_s * static_cast<double>(axes) / share;
}

}  // namespace

SensorWatch::SensorWatch(std::size_t axes, double sample_rate_hz)
    : block_samples_(std::max(kFewestSamples, std::round(kBlock_s * sample_rate_hz))),
      period_s_(1.0 / sample_rate_hz),
      cusum_(std::log(blocks_between_alarms(axes, block_samples_ * period_s_, (1.0 - kForStep) / kCusums))),
      step_(blocks_between_alarms(axes, block_samples_ * period_s_, kForStep)),
      axes_(axes, Axis(cusum_, step_)) {}

void SensorWatch::renew() {
  axes_.assign(axes_.size(), Axis(cusum_, step_));
  for (std::size_t a = 0; a < axes_.size(); ++a) axes_[a].at_block = before_.axis[a];
  range_ = false;
  samples_ = seen_;
  out_of_range_ = seen_out_of_range_;
}

void SensorWatch::take(const RestSums& sums, std::uint64_t samples, std::uint64_t out_of_range) {
  const auto during = static_cast<double>(samples - samples_);
  if (during * period_s_ >= kRange_s) {
    range_ = static_cast<double>(out_of_range - out_of_range_) > kRangeShare * during;
    samples_ = samples;
    out_of_range_ = out_of_range;
  }
  silent_ = samples == seen_ ? silent_ + 1 : 0;
  seen_ = samples;
  seen_out_of_range_ = out_of_range;
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    Axis& axis = axes_[a];
    if (silent_ == kSilence) axis.level.forget_level();
    follow_motion(axis, sums.axis[a], before_.axis[a]);
    take_block(axis, sums.axis[a]);
  }
  before_ = sums;
}

// Angle turned while not at rest. A step of the bias also ends a rest briefly, but makes no angle.
void SensorWatch::follow_motion(Axis& axis, const RestSums::Axis& now, const RestSums::Axis& before) const {
  const double moved = now.moved - before.moved;
  const double level = axis.level.level();
  if (moved <= 0.0 || !std::isfinite(level)) return;
  axis.turned += (now.moved_rate - before.moved_rate - moved * level) * period_s_;
  if (std::abs(axis.turned) <= kTurned) return;
  axis.level.forget_level();
  axis.last_innovation.reset();
  axis.steps.restart();
  axis.turned = 0.0;
}

void SensorWatch::take_block(Axis& axis, const RestSums::Axis& sums) {
  const RestSums::Axis& from = axis.at_block;
  const double resting = sums.samples - from.samples, moved = sums.moved - from.moved;
  if (resting + moved < block_samples_) return;
  const double mean = (sums.rate - from.rate) / resting;
  const double square = (sums.square - from.square) / resting;
  const double pairs = sums.pairs - from.pairs;
  const double correlation = (sums.product - from.product) / pairs / square;
  axis.skipped += std::max(1.0, std::round((resting + moved) / block_samples_));
  axis.at_block = sums;
  if (resting < kMostlyAtRest * (resting + moved) || !(pairs > 0.0) || !(square > 0.0)) return;
  // With higher noise means scatter more, which is no step.
  if (test_noise(axis, square, correlation, pairs)) return;
  test_level(axis, mean);
  axis.skipped = 0.0;
}

bool SensorWatch::test_noise(Axis& axis, double square, double correlation, double pairs) {
  bool loud = false, odd = false;
  if (axis.blocks >= kLearned) {
    const double louder = square / axis.square;
    loud = louder > kLoud;
    if (loud) axis.louder += (louder - axis.louder) * (axis.louder == 0.0 ? 1.0 : kLatest);
    const bool strange =
        std::abs(correlation - axis.correlation) > std::max(kOddCorrelation, kOddErrors / std::sqrt(pairs));
    axis.loud.add(usual_log_ratio(loud));
    axis.odd_neighbours.add(usual_log_ratio(strange));
    odd = loud || strange;
  }
  // Unusual blocks are not learned.
  if (odd) return loud;
  if (!axis.loud.alarmed()) axis.louder = 0.0;
  axis.blocks += 1.0;
  axis.square += (square - axis.square) / axis.blocks;
  axis.correlation += (correlation - axis.correlation) / axis.blocks;
  return false;
}

void SensorWatch::test_level(Axis& axis, double mean) {
  const LevelNoise::Innovation& innovation = axis.level.take(mean, axis.skipped);
  axis.bias_for = std::max(0.0, axis.bias_for - 1.0);
  if (!innovation.known) return;
  // Also while learning, because the variance of sums is learned too.
  const bool stepped = axis.steps.take(innovation);
  if (axis.level.blocks() < kLearned) return;
  if (axis.last_innovation) axis.follows.add(colour_log_ratio(*axis.last_innovation, innovation.value));
  axis.last_innovation = innovation.value;
  if (!stepped) return;
  step_radps_ = axis.steps.step();
  axis.bias_for = kTellStep;
  axis.level.forget_level();
  axis.last_innovation.reset();
}

std::int32_t SensorWatch::noticed() const {
  std::int32_t out = range_ ? status_t::NOTICED_RANGE : 0;
  for (const Axis& axis : axes_) {
    if (axis.loud.alarmed()) out |= status_t::NOTICED_NOISE;
    if (axis.odd_neighbours.alarmed() || axis.follows.alarmed()) out |= status_t::NOTICED_COLOUR;
    if (axis.bias_for > 0.0) out |= status_t::NOTICED_BIAS;
  }
  return out;
}

std::string SensorWatch::words(std::int32_t only) const {
  const std::int32_t now = noticed() & only;
  std::string out;
  const auto add = [&](const std::string& text) { out += (out.empty() ? "" : "; ") + text; };
  if ((now & status_t::NOTICED_NOISE) != 0) {
    double most = 0.0;
    for (const Axis& axis : axes_)
      if (axis.loud.alarmed()) most = std::max(most, axis.louder);
    add(formatted(
        "noise at rest %.1f times what it was (standard deviation): look at mounting, supply and cable, "
        "then compare recordings with `ifog allan`",
        std::sqrt(most)));
  }
  if ((now & status_t::NOTICED_COLOUR) != 0)
    add("innovations are no longer white: something acts on the sensor that its model does not know, run "
        "`ifog night`");
  if ((now & status_t::NOTICED_BIAS) != 0)
    add(formatted(
        "rate at rest has stepped by %+.3g °/h: align again, and run `ifog night` if it was not turned",
        step_radps_ / kDegreePerHour));
  if ((now & status_t::NOTICED_RANGE) != 0)
    add("a channel is outside the range of the model for over ten minutes: run `ifog night`, which fits it "
        "there");
  return out;
}

}  // namespace ifog
