// SPDX-License-Identifier: Apache-2.0
// Plausibility of values from outside: keeps impossible numbers in well-formed frames out of the angle, the
// filter and the corrections.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "drivers/units/turn.h"
#include "filters/chain/reading.h"

namespace ifog {

// Limits that no sensor exceeds: rad/s, rad, unit of the channel. A spinning projectile turns at 2e3 rad/s;
// beyond 1e9 rad a float32 resolves 64 rad; a 64-bit counter is below 2e19.
inline constexpr double kMostRate_radps = 1e4;
inline constexpr double kMostAngle_rad = 1e9;
inline constexpr double kMostChannel = 1e20;

enum class Verdict : std::uint8_t { plausible, saturated, implausible };

struct Turn {
  double angle_rad = 0.0;
  double covered_s = 0.0;  // 0: turn unknown
};

// A scalar within limits and without jumps. The first value beyond max_step is rejected; a second one close
// to it confirms the change and is accepted.
class PlausibleValue {
 public:
  PlausibleValue() = default;
  PlausibleValue(const Limits& limits, double most) noexcept : limits_(limits), most_(most) {}

  [[nodiscard]] bool take(double value) noexcept {
    // NaN fails this comparison.
    if (!(std::abs(value) <= most_) || !(value >= limits_.minimum && value <= limits_.maximum)) return false;
    const bool near_last = !known_ || std::abs(value - last_) <= limits_.max_step;
    const bool near_suspect = suspected_ && std::abs(value - suspect_) <= limits_.max_step;
    suspected_ = !near_last && !near_suspect;
    if (suspected_) {
      suspect_ = value;
      return false;
    }
    last_ = value;
    known_ = true;
    return true;
  }
  // Samples are missing, so the change since is unknown.
  void forget() noexcept { known_ = suspected_ = false; }

 private:
  Limits limits_;
  double most_ = kMostChannel;
  double last_ = 0.0, suspect_ = 0.0;
  bool known_ = false, suspected_ = false;
};

// A rate, or a delta angle over its sample's time.
class PlausibleRate {
 public:
  PlausibleRate() = default;
  PlausibleRate(const Limits& limits, double full_scale_radps) noexcept
      : value_(limits, kMostRate_radps), full_scale_radps_(full_scale_radps) {}

  [[nodiscard]] Verdict take(double rate_radps) noexcept {
    if (full_scale_radps_ > 0.0 && std::abs(rate_radps) >= full_scale_radps_) return Verdict::saturated;
    return value_.take(rate_radps) ? Verdict::plausible : Verdict::implausible;
  }
  void forget() noexcept { value_.forget(); }

 private:
  PlausibleValue value_;
  double full_scale_radps_ = 0.0;
};

// Converts an angle since power-up to the turn since the last valid one. An implausible angle is dropped. If
// the next one continues it, the device has a new origin; the turn between the origins is unknown and not
// added.
class PlausibleAngle {
 public:
  // To be called before take() for every sample, valid or not.
  void pass(double dt_s) noexcept {
    missed_ = missed_ || since_s_ > 0.0;
    since_s_ += dt_s;
    suspect_since_s_ += dt_s;
  }
  // rate: plausibility of the mean rate since then; wrap_rad: as in SensorFacts.
  [[nodiscard]] Verdict take(double angle_rad, double wrap_rad, PlausibleRate& rate, Turn& out) noexcept {
    out = {};
    if (!(std::abs(angle_rad) <= kMostAngle_rad)) return Verdict::implausible;
    // Over missing or invalid samples the direction of rotation may be ambiguous.
    const bool ambiguous = known_ && missed_ && !turn_is_known(rate_radps_, since_s_, wrap_rad);
    if (ambiguous) rate_radps_ = 0.0;
    if (!known_ || ambiguous) {
      settle(angle_rad);
      return Verdict::plausible;
    }
    Verdict verdict = judge(angle_rad - angle_rad_, since_s_, wrap_rad, rate, out);
    if (verdict != Verdict::plausible && suspected_ &&
        judge(angle_rad - suspect_rad_, suspect_since_s_, wrap_rad, rate, out) == Verdict::plausible)
      verdict = Verdict::plausible;
    if (verdict == Verdict::plausible) {
      rate_radps_ = out.angle_rad / out.covered_s;
      settle(angle_rad);
      return verdict;
    }
    out = {};
    suspected_ = true;
    suspect_rad_ = angle_rad;
    suspect_since_s_ = 0.0;
    return verdict;
  }
  // The device restarted: its angle has another origin.
  void forget() noexcept { known_ = suspected_ = false; }
  // Samples are missing before the next one.
  void miss() noexcept { missed_ = true; }

 private:
  static Verdict judge(double turned, double time_s, double wrap_rad, PlausibleRate& rate,
                       Turn& out) noexcept {
    if (wrap_rad > 0.0) turned = std::remainder(turned, wrap_rad);
    out = {turned, time_s};
    return time_s > 0.0 ? rate.take(turned / time_s) : Verdict::implausible;
  }
  void settle(double angle_rad) noexcept {
    angle_rad_ = angle_rad;
    since_s_ = 0.0;
    known_ = true;
    suspected_ = missed_ = false;
  }

  double angle_rad_ = 0.0, since_s_ = 0.0;
  double rate_radps_ = 0.0;  // between the last two valid angles
  double suspect_rad_ = 0.0, suspect_since_s_ = 0.0;
  bool known_ = false, suspected_ = false, missed_ = false;
};

}  // namespace ifog
