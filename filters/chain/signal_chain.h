// SPDX-License-Identifier: Apache-2.0
// Processing of an angle increment to all published values: compensation, rate estimate, angle sum. The
// daemon and `ifog denoise` use this code, so the same frames and settings give the same bits.
//
// Everything that a model file or a setting can change is in ChainParts, which is built outside the hot path
// and swapped between two samples. The angle is in SignalChain and continues exactly.
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
#include "filters/linear/exact_sum.h"
#include "filters/model_file/model.h"
#include "filters/model_file/model_axes.h"
#include "filters/settings/filter_settings.h"

namespace ifog {

// The model does not fit the sensor.
struct ModelMisfit : std::invalid_argument {
  ModelMisfit(std::uint32_t at, const std::string& what) : std::invalid_argument(what), line(at) {}
  std::uint32_t line;  // of the effect in the model file; 0: unknown
};

struct ChainSettings {
  SensorFacts facts;
  std::vector<std::string> axes;          // "x", … or one ""
  std::vector<std::string> channels;      // by index in Reading::channel, capture column names
  std::vector<double> channel_max_age_s;  // older values are stale; one per channel, 0: never
  FilterChoice filter;                    // overrides the model's; a noise that is 0 or missing is learned
  double start_up_s = 4.0;                // shortest learning time; at least 4096 samples
  // From an earlier run of this sensor; used if neither settings nor model give the noise.
  std::optional<LearnedNoise> learned;
  std::shared_ptr<const Model> model;      // null: no compensation
  std::optional<double> since_power_up_s;  // of the sensor at the first sample
  // Time of power-up on the clock of Increment::read_ns; overrides since_power_up_s. Without both, warm_up is
  // not corrected.
  std::optional<std::int64_t> powered_ns;
};

enum ChainFlags : std::uint32_t {
  kNoiseUnknown = 1,    // noise being learned: denoised is the compensated rate, with its present variance
  kFilterReset = 2,     // first sample of a new estimator
  kNotCompensated = 4,  // the model's correction was implausible: the measured rate is used
};

struct ChainOutput {
  Axes compensated_radps{};
  Axes delta_theta_rad{};  // compensated, unfiltered
  Axes angle_rad{};        // running sum of delta_theta
  // Its variance includes the correction's. For an axis that has never had a value denoised and variance are
  // NaN.
  EstimatorOutput estimate;
  std::uint32_t flags = 0;              // ChainFlags
  std::uint32_t compensator_flags = 0;  // CompensatorFlags
};

class ChainParts {
 public:
  // Throws with one line: ModelMisfit for an effect on a channel or axis that the sensor lacks;
  // std::invalid_argument or std::runtime_error for a setting out of range.
  explicit ChainParts(const ChainSettings& settings);
  ~ChainParts();

  [[nodiscard]] const std::string& model_identity() const { return identity_; }
  // The settings in use, including the noise once it is known.
  [[nodiscard]] const FilterSettings& filter() const { return filter_; }
  // Ratio of each axis's noises to filter()'s; unknown driving noise in proportion to the noise.
  [[nodiscard]] const AxisShares& shares() const { return shares_; }
  // The driving noise is not configured: it is learned.
  [[nodiscard]] bool learns_walk() const { return learns_process_noise_; }
  [[nodiscard]] bool noise_known() const { return estimator_ != nullptr; }
  // Effects of the model that cannot be corrected here, as text.
  [[nodiscard]] std::vector<std::string> left_out() const;
  // Noise to be stored for the next start; nullopt if it is configured or still unknown.
  [[nodiscard]] std::optional<LearnedNoise> learned() const noexcept;
  // Null while the noise is learned.
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
    std::vector<std::size_t> wanted;         // channels of the compensator: index in Increment::channel
    std::vector<double> relative_age_max;    // 1 / largest age of each
    std::vector<double> channel, relative_age;
    CompensatorOutput correction;
  } effects_;
  Walk start_up_;  // until the noise is known
  std::unique_ptr<Estimator> estimator_;
  FirstSamples first_samples_;
  std::uint32_t measured_axes_ = 0;  // axes that the estimator has received
  bool learns_process_noise_ = false, of_long_means_ = false;
  Axes owed_{};  // of the previous estimator, until the new one exists
  bool first_ = true;
};

class SignalChain {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  static constexpr Axes kUnknownAxes{kUnknown, kUnknown, kUnknown};

 public:
  explicit SignalChain(std::unique_ptr<ChainParts> parts) : parts_(std::move(parts)) {}

  // Hot path: no allocation, lock, log or exception, except once when the noise has been learned.
  void process(const Increment& in, ChainOutput& out) noexcept;
  // To be called between two samples. Returns the old parts for destruction elsewhere.
  std::unique_ptr<ChainParts> swap(std::unique_ptr<ChainParts> parts) noexcept;

  [[nodiscard]] const ChainParts& parts() const { return *parts_; }
  // Health of the present estimator; counters continue those of earlier ones. While the noise is learned only
  // the counters are valid.
  [[nodiscard]] EstimatorHealth health() const noexcept;

 private:
  void hold_unmeasured(ChainOutput& out) noexcept;

  std::unique_ptr<ChainParts> parts_;
  std::uint32_t known_axes_ = 0;                                  // axes that have had a value
  Axes held_radps_ = kUnknownAxes, held_rad2ps2_ = kUnknownAxes;  // denoised value of the last measurement
  EstimatorHealth before_;                                        // counters of earlier estimators
  std::array<ExactSum, kMaxAxes> angle_{};
};

}  // namespace ifog
