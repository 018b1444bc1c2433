// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/noise.h"

#include <algorithm>
#include <utility>

namespace ifog {
namespace {

// Higher noise must be white for this time and for two stretches.
constexpr double kHigherNoise_s = 60.0;

}  // namespace

SensorNoise::SensorNoise(const FilterSettings& settings, const KnownNoise& known, std::size_t axes,
                         double period_s, double colour_variance) noexcept
    : axes_(axes),
      period_s_(period_s),
      process_noise_(settings.process_noise),
      given_(settings.measurement_noise + colour_variance),
      white_(settings.measurement_noise / given_),
      learns_walk_(known.learns_walk),
      walk_share_(known.walk_share),
      in_motion_(std::max(2.0 * Walk::kStretch, kHigherNoise_s / period_s), false) {
  for (std::size_t a = 0; a < axes_; ++a) {
    noise_[a] = Noise(known.share[a] * given_);
    if (known.of_long_means) noise_[a].set_long(noise_[a].known());
  }
  refresh_share();
  if (known.samples > 0.0) walk_.recall(process_noise_ * period_s / given_, known.samples);
}

void SensorNoise::take(const Sample& now, const Lanes& since) noexcept {
  for (std::size_t a = 0; a < axes_; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    if ((now.valid >> a & 1U) != 0) noise_[a].take(now.rate[i], since[i]);
  }
}

void SensorNoise::learn(const Axes& rate, std::uint32_t valid, bool at_rest, RestFilter& filter) noexcept {
  if (std::exchange(at_rest_, at_rest) != at_rest) (at_rest ? in_motion_ : walk_).moved();
  const std::optional<Walk::Found> found = (at_rest ? walk_ : in_motion_).take(rate, valid);
  if (!found) return;
  const double before = mean_;
  bool other = false;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!(found->noise[a] > 0.0)) continue;
    noise_[a].set_long(found->white ? noise_[a].known() : found->noise[a]);
    if (!found->white) continue;
    // With a coarse converter the result depends on the level; less than its rounding variance is not R.
    const double level = std::max(found->noise[a], noise_[a].of_steps()), known = noise_[a].known();
    if (at_rest ? kOtherNoise * level < known : level > kOtherNoise * known) {
      noise_[a].set_known(level);
      other = true;
    }
  }
  if (other) {
    refresh_share();
    filter.rule().restart();
  }
  if (!learns_walk_) return;
  process_noise_ = at_rest ? found->ratio * mean_ / period_s_ : process_noise_ * mean_ / before;
  filter.retune(process_noise_);
}

void SensorNoise::refresh_share() noexcept {
  const Lanes known = each(&Noise::known);
  mean_ = mean(known);
  share_ = known / mean_;
}

LearnedNoise SensorNoise::learned() const noexcept {
  LearnedNoise out;
  out.process_noise = process_noise_;
  for (std::size_t a = 0; a < axes_; ++a) out.noise[a] = white_ * noise_[a].known();
  out.measurement_noise = white_ * mean_;
  out.samples = learns_walk_ ? walk_.samples() : 0.0;
  return out;
}

}  // namespace ifog
