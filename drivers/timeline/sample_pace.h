// SPDX-License-Identifier: Apache-2.0
// When samples follow each other: by the arrivals of their frames, and by a coarse clock of the device.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace ifog {

// Sample period of a device, measured by the arrivals of its frames.
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

// Device clock whose tick is not much shorter than a sample: without losses its steps are none, one or two
// ticks, and only their sum is accurate. Samples are spaced at the nominal period, and the sum stays within
// two ticks of the clock.
class Ticks {
 public:
  struct Step {
    std::uint64_t samples = 1;
    double dt_s = 0.0;
  };

  explicit Ticks(double nominal_s) noexcept : nominal_s_(nominal_s) {}
  // The clock was set or restarted: its sum starts again, its tick is kept.
  void jumped() noexcept { owed_s_ = 0.0; }
  // It has stood still between two samples.
  [[nodiscard]] bool stood() const noexcept { return stood_; }
  [[nodiscard]] bool known() const noexcept { return stood_ || tick_ns_ > 0; }
  // Resolution of one step; at most a second before a tick was seen.
  [[nodiscard]] double grain_s() const noexcept { return !stood_ ? 0.0 : tick_ns_ == 0 ? 1.0 : tick_s(); }
  // True if another sample with the same stamp and values is possible.
  [[nodiscard]] bool has_room() const noexcept { return stood_ && owed_s_ > -2.0 * tick_s(); }

  // passed_ns >= 0: since the previous sample; counted: samples by the counter, 0: none.
  [[nodiscard]] Step take(std::int64_t passed_ns, std::uint64_t counted) noexcept {
    const double passed_s = static_cast<double>(passed_ns) * 1e-9;
    learn(passed_ns, passed_s);
    owed_s_ = coarse() ? owed_s_ + passed_s : passed_s;
    const double samples = (owed_s_ - (stood_ ? 1.0 : 0.25) * tick_s()) / nominal_s_;
    Step step{counted > 0 ? counted : SamplePace::at_least_one(samples), owed_s_};
    if (coarse()) {
      const double slack_s = tick_ns_ > 0 ? 2.0 * tick_s() : HUGE_VAL;
      step.dt_s = std::clamp(static_cast<double>(step.samples) * nominal_s_, owed_s_ - slack_s,
                             std::max(owed_s_ + slack_s, 0.05 * nominal_s_));
    }
    owed_s_ -= step.dt_s;
    return step;
  }

 private:
  static constexpr int kProof = 32;     // number of steps that confirm the tick
  static constexpr double kFine = 4.0;  // ticks per period

  [[nodiscard]] double tick_s() const noexcept { return static_cast<double>(tick_ns_) * 1e-9; }
  [[nodiscard]] bool coarse() const noexcept {
    const double ticks = tick_ns_ > 0 && steps_ >= kProof ? nominal_s_ / tick_s() : 0.0;
    return stood_ || (ticks >= 1.0 && ticks < kFine && std::abs(ticks - std::round(ticks)) > 1e-7);
  }
  // A step over missing samples is a multiple of the tick, too. A longer one may be a clock that was set.
  void learn(std::int64_t passed_ns, double passed_s) noexcept {
    stood_ = stood_ || passed_ns == 0;
    if (passed_ns == 0 || passed_s > kFine * std::max(nominal_s_, tick_ns_ > 0 ? tick_s() : 1.0)) return;
    const std::int64_t tick_ns = std::gcd(tick_ns_, passed_ns);
    steps_ = tick_ns == tick_ns_ ? std::min(steps_ + 1, kProof) : 1;
    tick_ns_ = tick_ns;
  }

  double nominal_s_;
  std::int64_t tick_ns_ = 0;
  int steps_ = 0;
  bool stood_ = false;
  double owed_s_ = 0.0;  // the clock's sum minus the published intervals
};

}  // namespace ifog
