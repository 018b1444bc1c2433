// SPDX-License-Identifier: Apache-2.0
// Correction before the filter: subtracts a model's effects from the measured rates of one sensor. step() is
// the daemon's hot path: no allocation, lock or exception; `ifog denoise` uses the same code.
//
// The true rates solve z = w + b + s(T, w) w + m w_other. b: environmental effects, s: scale factor error (a
// function of temperature and rate), m: misalignment to the sensor's other axes. Online, w replaces the
// reference rate of the fit.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filters/effects/delayed_reading.h"
#include "filters/effects/plausible_reading.h"
#include "filters/effects/ramp_tracker.h"
#include "filters/effects/shape.h"
#include "filters/model_file/model.h"
#include "filters/settings/axes.h"

namespace ifog {

enum CompensatorFlags : std::uint32_t {
  // A channel is missing, too old or implausible (plausible_reading.h): its last value is held.
  kStaleChannel = 1,
  kOutOfRange = 2,    // a channel is outside the fitted range (reach.h); the variance is increased
  kNoChannelYet = 4,  // a channel has never had a value: its effects are not corrected
  kRampUnknown = 8,   // the phase of a rebuilt feedback ramp is unknown: its effect is not corrected
};

struct CompensatorInput {
  double dt_s = 0.0;  // time of this sample; after a gap, the whole gap
  Axes rate_radps{};  // NaN: not measured
  // Part of dt without measurement (a gap); the angle turned in it is unknown.
  Axes missed_s{};
  std::span<const double> channels{};  // in the order of Compensator::channels(); NaN: missing now
  std::span<const double> age_s{};     // of each channel's value; empty: all are current
};

struct CompensatorOutput {
  Axes compensated_radps{};
  Axes correction_radps{};  // what was subtracted
  // Variance of the correction: parameter covariance, extrapolation, and dead zone.
  Axes variance_rad2ps2{};
  std::uint32_t flags = 0;  // CompensatorFlags
};

class Compensator {
 public:
  // axes: as in the capture: "x", "y", "z", or one "". An effect without an axis applies to all.
  // since_power_up_s: of the sensor at the first sample; without it warm_up is not corrected. Throws
  // std::invalid_argument that names the effect and the error.
  Compensator(const Model& model, const std::vector<std::string>& axes,
              double stale_after_s = std::numeric_limits<double>::infinity(),
              std::optional<double> since_power_up_s = {});

  // Environment channels for step(), in this order, without reference rates.
  [[nodiscard]] const std::vector<std::string>& channels() const noexcept { return channels_; }
  // Effects of the model that are not corrected online, as text: see carries_over(); warm_up without the time
  // since power-up; rate_ramp without its fitted duration.
  [[nodiscard]] const std::vector<std::string>& left_out() const noexcept { return left_out_; }

  // Sets the time since power-up, to be called before the first step. It replaces the constructor's, which
  // must have been given.
  void begin(double since_power_up_s) noexcept;
  void step(const CompensatorInput& in, CompensatorOutput& out) noexcept;

  // After a reload: continues the channels and the common shapes of the previous compensator, so that a new
  // model causes no transient.
  void take_over(const Compensator& previous) noexcept;

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  struct Factor {
    std::size_t channel = kNone;  // kNone: a rate, or time
    std::size_t less = kNone;     // second channel of a difference, or kNone
    std::size_t rate = kNone;     // axis whose rate is the argument, or kNone
    double turn = 0.0;            // modulus of an angle
    Shape shape;
    ChannelRange range;                  // of a rate or a difference
    PlausibleReading readings{};         // of a difference
    std::optional<double> difference{};  // last plausible one
  };
  // Product of shapes, and its possible errors outside the range (Shape).
  struct Value {
    double value = 1.0, left_behind = 0.0, unseen_curvature = 0.0;
    [[nodiscard]] bool surely() const noexcept { return left_behind == 0.0 && unseen_curvature == 0.0; }
    void times(double factor, const Shape& shape, const Reach& reach) noexcept {
      if (reach.outside() || !surely()) [[unlikely]]
        doubt(factor, shape, reach);
      value *= factor * reach.weight;
    }
    void doubt(double factor, const Shape& shape, const Reach& reach) noexcept;
  };
  struct Term {
    std::size_t axis;
    double coefficient;
    double coefficient_error;
    bool of_rate;           // of any axis
    std::size_t parameter;  // row of the coefficient in the covariance, or kNone
    std::vector<Factor> factors;
    Value channels{};  // product of the factors that do not depend on the rate, of this step
    bool usable = false;
  };
  // Terms of one axis, in the order of the model.
  struct AxisTerms {
    std::size_t begin = 0, end = 0;
    bool of_rate = false;  // its correction depends on a rate
  };
  struct Ramp {
    std::size_t axis;
    RampTracker tracker;
  };
  struct Zone {  // dead zone
    std::size_t axis;
    double middle, half_width;
  };
  struct Held {
    double value = 0.0;
    Reach reach;
    PlausibleReading readings;
    bool seen = false;
    bool stale = false;
  };

  void add_effect(const Effect& effect, std::size_t first_row, const std::vector<std::string>& axes,
                  const std::vector<ChannelRange>& ranges);
  void add_ramp(const Effect& effect, const std::vector<std::string>& axes);
  void add_zone(const Effect& effect, const std::vector<std::string>& axes);
  void add_factor(Term& term, ShapeSettings settings, const std::string& channel,
                  const std::vector<std::string>& axes, const std::vector<ChannelRange>& ranges);
  void arrange_terms();
  void hold_channels(const CompensatorInput& in, CompensatorOutput& out) noexcept;
  void evaluate(Term& term, double dt_s, std::uint32_t& flags) noexcept;
  void solve(const CompensatorInput& in, CompensatorOutput& out) noexcept;
  void subtract_ramps(const CompensatorInput& in, CompensatorOutput& out) noexcept;
  // Reach of a factor's channel; nullopt if it has had no value.
  [[nodiscard]] std::optional<Reach> reach_of_factor(Factor& factor, double dt_s,
                                                     std::uint32_t& flags) const noexcept;
  // The term at these rates; only its channels' part if it does not depend on rates. Zero while a needed axis
  // has no value.
  [[nodiscard]] Value at_rates(const Term& term, const Axes& rates) const noexcept;
  [[nodiscard]] double correction(std::size_t axis, const Axes& rates) const noexcept;
  [[nodiscard]] double better_rate(std::size_t axis, double measured, double at, Axes rates) const noexcept;
  // Sets the axis's variance and flags.
  void judge(std::size_t axis, const Axes& rates, CompensatorOutput& out) noexcept;
  [[nodiscard]] double parameter_variance(std::size_t axis) const noexcept;
  std::size_t channel_index(const std::string& name);

  std::vector<std::string> channels_, left_out_;
  std::vector<ChannelRange> ranges_;  // of channels_; infinite if the model gives none
  std::vector<Held> held_;
  std::vector<DelayedReading> delayed_;  // of channels_
  std::vector<Term> terms_;
  std::vector<Ramp> ramps_;
  std::vector<Zone> zones_;
  struct Covariance {
    std::vector<double> values;
    std::size_t size = 0;  // parameters
  } covariance_;
  std::size_t axes_;
  std::array<AxisTerms, kMaxAxes> of_axis_{};
  std::vector<double> values_;  // of terms_, for judge()
  double stale_after_s_;
  std::optional<double> since_power_up_s_;
};

}  // namespace ifog
