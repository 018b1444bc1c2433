// SPDX-License-Identifier: Apache-2.0
// Options and result of a diagnosis, as plain data for all rooms of the diagnosis.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "filters/allan/noise/noise_coefficients.h"
#include "filters/diagnosis/record.h"
#include "filters/model_file/model.h"
#include "filters/rest/noise_change.h"

namespace ifog {

struct DiagnoseOptions {
  double significance = 0.01;  // probability of a false effect, corrected for the number of tries
  std::string axis;            // written into the effects found
  // Part of each record that is fitted, as fractions of its time; the rest is for validation. If that is all
  // of it, validation is by cross-validation.
  double fit_from = 0.0, fit_to = 1.0;
  std::size_t most_effects = 8;
  bool subtract_earth_rate = false;  // subtract the effect of the Earth's rate; otherwise it is only reported
  std::optional<double> latitude_rad;  // limits the size of the Earth's rate
  // Without a reference, channels that sense motion explain nothing unless this is set.
  bool allow_motion_channels = false;
  // Coefficients beyond makers' specifications are reported as proxies and not corrected unless this is set.
  bool allow_proxies = false;
  std::function<void(std::size_t done, std::size_t total)> progress;
};

// Noise parameters that the record allows; predictions average over them.
struct NoisePosterior {
  struct Part {
    double weight = 0.0;    // the weights of all parts sum to one
    double white = 0.0;     // variance of 1 s means, (rad/s)^2 s
    double walk = 0.0;      // growth of the random walk's variance, (rad/s)^2/s
    double flicker = 0.0;   // variance of each Gauss-Markov process of the bank, (rad/s)^2
    double markov = 0.0;    // variance of a single further Gauss-Markov process
    double markov_s = 0.0;  // its time constant
  };
  std::vector<Part> parts;
  std::vector<double> flicker_s;  // time constants of the bank
};

// Bias that depends on the channel's direction of motion; not corrected (hysteresis.h).
struct Hysteresis {
  std::string channel;
  double half_width = 0.0;   // of the play, in the channel's unit
  double coefficient = 0.0;  // rad/s per unit of the channel
  double likelihood_ratio = 0.0;
};

struct FoundEffect {
  Effect effect;
  double p_value = 1.0;             // after correction for the number of tries
  double variance_explained = 0.0;  // of the error's 1 s means (or of samples, if longer), as a share
  double likelihood_ratio = 0.0;  // loss of twice the log-likelihood without it, with the noise fitted again
};

struct Indistinguishable {
  std::vector<Effect> effects;  // the first is the one that the model uses, the others have no coefficient
  double correlation = 0.0;     // of the regressors after whitening
  std::string separate_by;      // capture that would distinguish them
};

struct Unexplained {
  double fraction = 0.0;  // variance of the error that is neither noise nor explained, as a fraction
  double means_s = 1.0;   // length of the means to which the fraction refers; a sample's for a fast line
  // "nothing", "slow", "line", "bursts", "changing_variance", "hysteresis", "uncorrelated"
  std::string kind;
  std::string hint;
  double frequency_hz = 0.0;    // "line"
  std::vector<double> times_s;  // "bursts"
};

// Heading error of the next capture after correction by the model. The bias is the mean over the first
// `aligned_s` seconds at rest; the angle is integrated from then on. Promised is the root of the error's
// expected square. It includes the noise with its uncertainty, parameter errors (time constants too), and known
// but uncorrected effects: a line at any phase, hysteresis. Not included: what the diagnosis did not
// detect, steps, and channels outside their fitted range.
struct HeadingPrediction {
  double aligned_s = 0.0;
  std::vector<double> after_s;    // times after the end of the alignment
  std::vector<double> sigma_rad;  // root of the expected square of the heading error at these times
  // True if most of the longest one's variance is of a random walk that the record does not show and cannot exclude.
  bool at_most = false;
};

// Delay of a reference in the log: it shows the rate of time t at t + delay_s. The figures before and after
// use the shifted reference.
struct ReferenceDelay {
  std::string record;
  double delay_s = 0.0;  // negative: reference early or rate late
  double std_error_s = 0.0;
};

// Data for the report's pictures, decimated to a few thousand points.
struct DiagnosisSeries {
  std::vector<double> time_s, before_radps, after_radps;  // block means of the error
  RecordOrigin origin;                                    // origin of time_s
  std::vector<std::string> names;                         // by effect
  std::vector<std::vector<double>> contribution_radps,
      channel;  // by effect, at time_s; channel is empty for effects without one
  std::vector<double> frequency_hz, before_radps_rthz, after_radps_rthz;  // amplitude spectral density
  std::vector<double> tau_s, before_adev_radps, after_adev_radps;
  // 68.3 % interval of the deviation after, under the noise found; NaN if unknown.
  std::vector<double> after_adev_low_radps, after_adev_high_radps;
};

// Change of the error's noise level within a capture.
struct NoiseChangeIn {
  std::string capture;
  NoiseChange change;
};

struct Diagnosis {
  std::size_t samples = 0;
  double sample_rate_hz = 0.0;
  NoiseTerms noise;                          // after the effects are removed, at rest (noise_coefficients)
  NoiseTerms noise_error;                    // standard deviations of `noise`
  std::optional<MarkovNoise> markov;         // Gauss-Markov bias; then K does not hold at long times
  std::vector<NoiseChangeIn> noise_changes;  // then `noise` is an average over unlike parts
  std::vector<FoundEffect> effects;          // those with channels, then ramps, then lines in the samples
  std::optional<ModelParameter> bias;        // relative to a reference; an effect if it is significant
  std::vector<double> covariance;            // of the parameters of all effects in order, row-major
  // Without a reference, in the same order: mean over the captures of the correction for one unit of the
  // parameter, if the effect's channels were never where it is zero; else 0. The model removes this mean: a
  // bias at 12 V is unknown after captures at 5 V. Empty: all 0.
  std::vector<double> means;
  std::vector<ChannelRange> ranges;             // of the channels used by the effects
  std::map<std::string, double> before, after;  // held-out figures, units in their names
  std::vector<Indistinguishable> indistinguishable;
  Unexplained unexplained;
  std::optional<Hysteresis> hysteresis;
  HeadingPrediction heading;  // if the channels behave as in the longest record
  NoisePosterior noise_posterior;
  std::vector<ReferenceDelay> reference_delays;  // of the records with a reference
  std::vector<std::string> remarks;              // further remarks for the user, one sentence each
  DiagnosisSeries series;
};

// Adds the effects, covariance, ranges and noise to the model. The caller sets its source.
void add_to_model(const Diagnosis& diagnosis, const std::string& axis, Model& model);

}  // namespace ifog
