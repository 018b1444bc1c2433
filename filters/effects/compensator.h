// SPDX-License-Identifier: Apache-2.0
// The correction that runs before the filter: subtracts a model's effects from the measured rate, for all
// axes of one sensor. step() is the daemon's hot path: no allocation, no lock, no exception; the same code
// serves `ifog denoise`.
//
// With b the effects of the environment, s the scale factor error, itself a function of temperature and rate,
// and m the misalignment to the sensor's other axes, the true rates solve z = w + b + s(T, w) w + m w_other.
// The reference rate of the fit is not there online; w takes its place.
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
  // A channel is missing, older than allowed or no reading of it (plausible_reading.h): held at its last
  // value.
  kStaleChannel = 1,
  kOutOfRange = 2,  // a channel is outside the range the model was fitted on: see reach.h; variance inflated
  kNoChannelYet = 4,  // a channel has never had a value: its effects are not corrected
  kRampUnknown = 8,   // the phase of a rebuilt feedback ramp is not known: its effect is not corrected
};

struct CompensatorInput {
  double dt_s = 0.0;  // time covered by this sample; after a gap, the whole gap
  Axes rate_radps{};  // NaN: not measured
  // The part of dt that rate_radps does not cover: a gap. The angle turned in it is not known.
  Axes missed_s{};
  std::span<const double> channels{};  // in the order of Compensator::channels(); NaN: missing now
  std::span<const double> age_s{};     // of each channel's value; empty: all are as old as the sample
};

struct CompensatorOutput {
  Axes compensated_radps{};
  Axes correction_radps{};  // what was subtracted
  // Variance of the correction: parameter covariance, leaving the range, and what a dead zone may hide.
  Axes variance_rad2ps2{};
  std::uint32_t flags = 0;  // CompensatorFlags
};

class Compensator {
 public:
  // `axes` as in the capture: "x", "y", "z", or one "". An effect without an axis applies to every axis.
  // since_power_up_s: of the sensor at the first sample. A sensor that has long been warm has no warm-up
  // left, and its samples do not tell in time, so without it a warm_up is dropped. Throws
  // std::invalid_argument naming the effect and what is wrong with it.
  Compensator(const Model& model, const std::vector<std::string>& axes,
              double stale_after_s = std::numeric_limits<double>::infinity(),
              std::optional<double> since_power_up_s = {});

  // The environment channels step() wants, in this order. Reference rates are not among them.
  [[nodiscard]] const std::vector<std::string>& channels() const noexcept { return channels_; }
  // Effects of the model that are not corrected online, see carries_over(), warm_up where the time since
  // power-up is not known, and rate_ramp where the model does not say how long it was fitted; in words.
  [[nodiscard]] const std::vector<std::string>& left_out() const noexcept { return left_out_; }

  // Before the first step: the time since power-up at that, in place of the one given to the constructor,
  // which must have had one.
  void begin(double since_power_up_s) noexcept;
  void step(const CompensatorInput& in, CompensatorOutput& out) noexcept;

  // After a reload: channels and the shapes that both models share continue where the previous compensator is,
  // so that a new model makes no transient of its own.
  void take_over(const Compensator& previous) noexcept;

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  // Channels as bits, so that a term is asked about with one comparison. Those that share a bit, beyond 63,
  // only make each other's terms be worked out once more.
  using ChannelSet = std::uint64_t;
  static constexpr ChannelSet kAlways = ChannelSet{1} << 63U;
  [[nodiscard]] static ChannelSet set_of(std::size_t channel) noexcept {
    return ChannelSet{1} << channel % 63;
  }

  struct Factor {
    std::size_t channel = kNone;  // kNone: a rate, or time
    std::size_t less = kNone;     // of a difference of two channels the second; kNone
    std::size_t rate = kNone;     // the axis whose rate it is a function of; kNone
    double turn = 0.0;            // of an angle: what its wraps are
    Shape shape;
    ChannelRange range;                  // of a rate or a difference
    PlausibleReading readings{};         // of a difference
    std::optional<double> difference{};  // the last that was believed; none: there was none
  };
  // A product of shapes, and by how much it may be wrong outside the range, as Shape has it.
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
    std::size_t parameter;  // row of the coefficient in the covariance, kNone without
    std::vector<Factor> factors;
    // Sum of the factors that do not depend on the rate, and their flags: valid until one
    // of these channels changes.
    Value channels{};
    std::uint32_t flags = 0;
    bool usable = false, doubtful = false;  // doubtful: outside the range of a channel
    ChannelSet needs = 0;
  };
  // The terms of one axis stand together, in the order of the model.
  struct AxisTerms {
    std::size_t begin = 0, end = 0;
    ChannelSet needs = 0;     // of any of them
    bool of_rate = false;     // its correction depends on a rate
    bool of_zone = false;     // its variance does
    int doubtful = 0;         // of the terms
    double correction = 0.0;  // at the step before
    double variance = 0.0;
  };
  struct Ramp {
    std::size_t axis;
    RampTracker tracker;
  };
  struct Zone {  // in which the sensor sees nothing
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
  void place(const Term& term, const Effect& effect, const std::vector<std::string>& axes);
  void arrange_terms();
  // Gives the channels whose value is not the one of the step before.
  ChannelSet hold_channels(const CompensatorInput& in, CompensatorOutput& out) noexcept;
  void evaluate(Term& term, double dt_s) noexcept;
  void look_at(Term& term, double dt_s) noexcept;
  void solve(const CompensatorInput& in, ChannelSet moved, CompensatorOutput& out) noexcept;
  void subtract_ramps(const CompensatorInput& in, CompensatorOutput& out) noexcept;
  // Where a factor's channel is, which has had a value.
  [[nodiscard]] std::optional<Reach> reach_of_factor(Factor& factor, double dt_s,
                                                     std::uint32_t& flags) const noexcept;
  // The whole term at these rates of the axes; the channels' part alone for a term that does not depend on
  // them. Zero while another axis it depends on has no value.
  [[nodiscard]] Value at_rates(const Term& term, const Axes& rates) const noexcept;
  [[nodiscard]] double correction(std::size_t axis, const Axes& rates) const noexcept;
  // Sets the axis' variance and flags.
  void judge(std::size_t axis, const Axes& rates, CompensatorOutput& out) noexcept;
  [[nodiscard]] double parameter_variance(std::size_t axis) const noexcept;
  std::size_t channel_index(const std::string& name);

  std::vector<std::string> channels_, left_out_;
  std::vector<ChannelRange> ranges_;  // of channels_, infinite where the model gives none
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
  std::vector<double> values_;  // of terms_, where judge() is
  bool begun_ = false;          // since what is held was last another's: terms hold their values
  double stale_after_s_;
  std::optional<double> since_power_up_s_;
};

}  // namespace ifog
