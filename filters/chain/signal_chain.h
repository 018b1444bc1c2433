// SPDX-License-Identifier: Apache-2.0
// From an angle increment to everything that is published of it: effects removed, rate estimated, angle
// summed. The daemon and `ifog denoise` run this very code, so the same frames and settings give the same
// bits in both.
//
// What a model file or a setting can change is in ChainParts, built outside the hot path and swapped in
// between two samples; the angle lives in SignalChain and continues exactly.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "filters/chain/first_samples.h"
#include "filters/chain/reading.h"
#include "filters/effects/compensator.h"
#include "filters/estimator/estimator.h"
#include "filters/estimator/learned_noise.h"
#include "filters/estimator/walk.h"
#include "filters/model_file/model.h"
#include "filters/model_file/model_axes.h"
#include "filters/settings/filter_settings.h"

namespace ifog {

// The model and the sensor do not go together.
struct ModelMisfit : std::invalid_argument {
  ModelMisfit(std::uint32_t at, const std::string& what) : std::invalid_argument(what), line(at) {}
  std::uint32_t line;  // of the effect in the model's file; 0: not known
};

struct ChainSettings {
  SensorFacts facts;
  std::vector<std::string> axes;          // "x", … or one ""
  std::vector<std::string> channels;      // by index in Reading::channel, capture column names
  std::vector<double> channel_max_age_s;  // older is stale; one a channel, 0: never
  FilterChoice filter;      // over the model's; process or measurement noise 0 or not said: from start-up
  double start_up_s = 4.0;  // of data for that at least; 4096 samples at least
  // By an earlier run of the same sensor: in place of start-up data where neither settings nor model say.
  std::optional<LearnedNoise> learned;
  std::shared_ptr<const Model> model;      // null: nothing is compensated
  std::optional<double> since_power_up_s;  // of the sensor at the first sample
  // When it was, as Increment::came_ns has time; stands over since_power_up_s. Neither: no warm_up is
  // corrected.
  std::optional<std::int64_t> powered_ns;
};

enum ChainFlags : std::uint32_t {
  kNoiseUnknown = 1,    // start-up: denoised is the compensated rate, with the variance it has shown so far
  kFilterReset = 2,     // first sample of a new estimator
  kNotCompensated = 4,  // the model's correction was no plausible rate: the measured one stands
};

struct ChainOutput {
  Axes compensated_radps{};
  Axes delta_theta_rad{};  // compensated, unfiltered
  Axes angle_rad{};        // running sum of delta_theta
  // Its variance includes the correction's. Of an axis that has never had a value denoised and variance are
  // NaN.
  EstimatorOutput estimate;
  std::uint32_t flags = 0;              // ChainFlags
  std::uint32_t compensator_flags = 0;  // CompensatorFlags
};

// A sum that loses nothing: A. Neumaier, "Rundungsfehleranalyse einiger Verfahren zur Summation endlicher
// Summen", ZAMM 54 (1974). Plain summation of 4·10^8 increments may lose 1e-9 rad; this keeps the error at
// one rounding.
class ExactSum {
 public:
  void add(double term) noexcept;
  [[nodiscard]] double value() const noexcept { return sum_ + lost_; }

 private:
  double sum_ = 0.0, lost_ = 0.0;
};

class ChainParts {
 public:
  // Throws with one line: ModelMisfit, an effect of the model on a channel or an axis that the sensor does
  // not have; std::invalid_argument or std::runtime_error, a setting out of range.
  explicit ChainParts(const ChainSettings& settings);
  ~ChainParts();

  [[nodiscard]] const std::string& model_identity() const { return identity_; }
  // The settings in use, with the noise once it is known.
  [[nodiscard]] const FilterSettings& filter() const { return filter_; }
  // Each axis's own noises over filter()'s; where the driving one is unknown, as its noise.
  [[nodiscard]] const AxisShares& shares() const { return shares_; }
  // The driving noise is not configured: it is learned.
  [[nodiscard]] bool learns_walk() const { return learns_process_noise_; }
  [[nodiscard]] bool noise_known() const { return estimator_ != nullptr; }
  // Effects of the model that cannot be corrected here, in words.
  [[nodiscard]] std::vector<std::string> left_out() const;
  // What is worth keeping for the next start; nothing where the noise is configured, or not known yet.
  [[nodiscard]] std::optional<LearnedNoise> learned() const noexcept;
  // Null during start-up.
  [[nodiscard]] const EstimatorHealth* health() const { return estimator_ ? &estimator_->health() : nullptr; }

 private:
  friend class SignalChain;
  void use_noise(const ChainSettings& settings);
  void begin(double ratio, double samples);
  void use_effects(const ChainSettings& settings);
  void compensate(const Increment& in, ChainOutput& out) noexcept;
  void refuse_impossible(const Increment& in, ChainOutput& out) noexcept;
  void learn(const Increment& in, const ChainOutput& out) noexcept;
  void publish_raw(const Increment& in, ChainOutput& out) noexcept;

  SensorFacts facts_;
  FilterSettings filter_;
  AxisShares shares_;
  std::string identity_;
  double period_s_;
  struct Effects {
    std::optional<Compensator> compensator;
    std::optional<std::int64_t> powered_ns;  // until the first sample
    std::vector<std::size_t> wanted;         // by the compensator: index in Increment::channel
    std::vector<double> relative_age_max;    // 1 / the age allowed, of each
    std::vector<double> channel, relative_age;
    CompensatorOutput correction;
  } effects_;
  Walk start_up_;  // until the noise is known
  std::unique_ptr<Estimator> estimator_;
  FirstSamples first_samples_;
  std::uint32_t measured_axes_ = 0;  // that the estimator has been given
  bool learns_process_noise_ = false, learns_measurement_noise_ = false;
  Axes owed_{};  // by the estimator before, until this one is there
  bool first_ = true;
};

class SignalChain {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  static constexpr Axes kUnknownAxes{kUnknown, kUnknown, kUnknown};

 public:
  explicit SignalChain(std::unique_ptr<ChainParts> parts) : parts_(std::move(parts)) {}

  // Hot path: no allocation, lock, log or exception, except once at the end of a start-up that had to learn
  // the noise.
  void process(const Increment& in, ChainOutput& out) noexcept;
  // Between two samples. Returns the old parts, to be freed elsewhere.
  std::unique_ptr<ChainParts> swap(std::unique_ptr<ChainParts> parts) noexcept;

  [[nodiscard]] const ChainParts& parts() const { return *parts_; }
  // Health of the estimator in use; its counters continue those of the estimators before it. During
  // start-up only the counters say something.
  [[nodiscard]] EstimatorHealth health() const noexcept;

 private:
  void hold_unmeasured(ChainOutput& out) noexcept;

  std::unique_ptr<ChainParts> parts_;
  std::uint32_t known_axes_ = 0;                                  // that have had a value
  Axes held_radps_ = kUnknownAxes, held_rad2ps2_ = kUnknownAxes;  // denoised, of what was measured last
  EstimatorHealth before_;                                        // the counters of estimators that are gone
  std::array<ExactSum, kMaxAxes> angle_{};
};

}  // namespace ifog
