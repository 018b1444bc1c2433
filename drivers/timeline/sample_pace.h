// SPDX-License-Identifier: Apache-2.0
// Sample period of a device, measured by the arrivals of its frames.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace ifog {

class SamplePace {
 public:
  // rate_hz: nominal; 0: unknown.
  explicit SamplePace(double rate_hz) noexcept
      : known_(rate_hz > 0.0), nominal_s_(rate_hz > 0.0 ? 1.0 / rate_hz : 1.0) {}

  [[nodiscard]] bool measured() const noexcept {
    return elapsed_s_ >= kMeasured_s && samples_ >= kMeasuredSamples;
  }
  // The nominal rate is known.
  [[nodiscard]] bool known() const noexcept { return known_; }
  [[nodiscard]] double nominal_s() const noexcept { return nominal_s_; }
  // Measured period, or the nominal one before it is measured.
  [[nodiscard]] double period_s() const noexcept { return measured() ? elapsed_s_ / samples_ : nominal_s_; }
  [[nodiscard]] double time_s(std::uint64_t samples) const noexcept {
    return static_cast<double>(samples) * period_s();
  }
  // Largest relative error of the period, if deliveries are late by up to scatter_s.
  [[nodiscard]] double doubt(double scatter_s) const noexcept {
    return measured() ? std::min(kStatedRate, kCrystals + scatter_s / elapsed_s_) : kStatedRate;
  }
  // Number of samples in that time, at least 1.
  [[nodiscard]] std::uint64_t samples_in(double time_s) const noexcept {
    return known_ ? at_least_one(time_s / period_s()) : 1;
  }
  static std::uint64_t at_least_one(double samples) noexcept {
    return samples >= 1.5 ? static_cast<std::uint64_t>(std::llround(std::min(samples, 1e18))) : 1;
  }
  // False if data are read much faster than they were sampled, e.g. from a file.
  [[nodiscard]] bool arrivals_tell() const noexcept {
    return recent_published_s_ == 0.0 || recent_elapsed_s_ > 0.5 * recent_published_s_;
  }
  // Frames are missing, or their arrivals tell nothing: up to the next one that was sent alone.
  void interrupted() noexcept { bunch_.whole = false; }
  // Adds frames that arrived elapsed_s after the one before; their samples took published_s. steady: the
  // arrivals show the device's period, without a silence.
  void learn(double elapsed_s, double published_s, std::uint64_t samples, bool steady) noexcept {
    recent_elapsed_s_ = kForgets * recent_elapsed_s_ + elapsed_s;
    recent_published_s_ = kForgets * recent_published_s_ + published_s;
    bunch_.elapsed_s += elapsed_s;
    bunch_.samples += static_cast<double>(samples);
    bunch_.whole = bunch_.whole && steady;
    if (elapsed_s < 0.5 * nominal_s_) return;  // sent together with the one before
    if (bunch_.whole) {
      const double keeps = std::max(0.0, 1.0 - bunch_.elapsed_s / kMemory_s);
      elapsed_s_ = keeps * elapsed_s_ + bunch_.elapsed_s;
      samples_ = keeps * samples_ + bunch_.samples;
    }
    bunch_ = {.whole = steady};
  }

 private:
  static constexpr double kMeasured_s = 1.0, kMeasuredSamples = 16.0;  // needed for a measurement
  static constexpr double kMemory_s = 60.0, kForgets = 0.998;
  static constexpr double kCrystals = 1e-4;    // largest relative difference of two crystals
  static constexpr double kStatedRate = 0.02;  // largest relative error of a nominal rate (KVH DSP-3000)

  bool known_;
  double nominal_s_;
  double elapsed_s_ = 0.0, samples_ = 0.0;
  struct Bunch {
    double elapsed_s = 0.0, samples = 0.0;
    bool whole = true;
  } bunch_;  // of samples that were sent together, up to the present one
  double recent_elapsed_s_ = 0.0, recent_published_s_ = 0.0;
};

}  // namespace ifog
