// SPDX-License-Identifier: Apache-2.0
// What a diagnosis says: the effects it found, how large the error is before and after, what cannot be
// distinguished, what stays, and what the record leaves open. Data, which every room of the diagnosis may know.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "filters/allan/noise/noise_coefficients.h"
#include "filters/diagnosis/record.h"
#include "filters/model_file/model.h"
#include "filters/rest/noise_change.h"

namespace ifog {

// The noise parameters that the record allows. Predictions average over them.
struct NoisePosterior {
  struct Part {
    double weight = 0.0;    // of all parts: sum to one
    double white = 0.0;     // variance of a mean of one second, (rad/s)^2 s
    double walk = 0.0;      // growth of the random walk's variance, (rad/s)^2/s
    double flicker = 0.0;   // variance of each Gauss-Markov process of the bank, (rad/s)^2
    double markov = 0.0;    // of one process of its own
    double markov_s = 0.0;  // its time constant
  };
  std::vector<Part> parts;
  std::vector<double> flicker_s;  // time constants of the bank
};

// A bias that depends on which way a channel came, and that no form corrects; see hysteresis.h.
struct Hysteresis {
  std::string channel;
  double half_width = 0.0;   // of the play, in the channel's unit
  double coefficient = 0.0;  // rad/s per unit of the channel
  double likelihood_ratio = 0.0;
};

struct FoundEffect {
  Effect effect;
  double p_value = 1.0;  // after correction for the number of tries
  double variance_explained =
      0.0;  // share of the variance of the error's 1 s means (or of single samples if longer)
  double likelihood_ratio = 0.0;  // what the fit loses without it, with the noise fitted again
};

struct Indistinguishable {
  std::vector<Effect> effects;  // the first is the one the model uses
  double correlation = 0.0;     // of the regressors after whitening
  std::string separate_by;      // the capture that would tell
};

struct Unexplained {
  double fraction =
      0.0;  // of the variance of the error that is neither white noise nor harmonic nor explained
  double means_s = 1.0;  // length of the means whose variance that is
  // "nothing", "slow", "line", "bursts", "changing_variance", "hysteresis", "uncorrelated"
  std::string kind;
  std::string hint;
  double frequency_hz = 0.0;    // "line"
  std::vector<double> times_s;  // "bursts"
};

// Heading error of the next capture, corrected by the model: the bias is taken over the first `aligned_s` seconds
// at rest and held, and the angle is integrated from then on. Promised is the root of the error's expected square:
// the noise, as uncertain as the record leaves it; the errors of the effects' parameters, time constants included;
// effects outside the range they were fitted on; and effects that are known but not corrected online, a line at any
// phase and a ramp going on. Not in it: what the diagnosis did not see, and steps, which nothing announces.
struct HeadingPrediction {
  double aligned_s = 0.0;
  std::vector<double> after_s;    // times since the end of the alignment
  std::vector<double> sigma_rad;  // root of the expected square of the heading error then
};

// Delay of a reference that was logged late: the true rate at a time is found delay_s later. The figures before
// and after are those of the shifted reference.
struct ReferenceDelay {
  std::string record;
  double delay_s = 0.0;  // below zero: early, or the rate late
  double std_error_s = 0.0;
};

// Delay of a channel that was logged late: a value holds for the time delay_s before its stamp.
struct ChannelDelay {
  std::string channel;
  double delay_s = 0.0;  // below zero: early
  double std_error_s = 0.0;
};

// What a report draws. Decimated to a few thousand points.
struct DiagnosisSeries {
  std::vector<double> time_s, before_radps, after_radps;  // block means of the error
  RecordOrigin origin;                                    // that time_s is counted from
  std::vector<std::string> names;                         // one entry an effect
  std::vector<std::vector<double>> contribution_radps,
      channel;  // by effect, at time_s; channel empty without one
  std::vector<double> frequency_hz, before_radps_rthz, after_radps_rthz;  // amplitude spectral density
  std::vector<double> tau_s, before_adev_radps, after_adev_radps;
  // 68.3 % interval of the deviation after, under the noise found; NaN where none can be said.
  std::vector<double> after_adev_low_radps, after_adev_high_radps;
};

// The error's noise is another in a part of a capture.
struct NoiseChangeIn {
  std::string capture;
  NoiseChange change;
};

struct Diagnosis {
  std::size_t samples = 0;
  double sample_rate_hz = 0.0;
  NoiseTerms noise;                          // after the effects, as noise_coefficients finds it at rest
  NoiseTerms noise_error;                    // standard deviations of those
  std::optional<MarkovNoise> markov;         // a bias that comes back; K is then no law of long times
  std::vector<NoiseChangeIn> noise_changes;  // which make noise an average of unlike parts
  std::vector<FoundEffect> effects;          // traced to channels, then ramps, then lines of the samples
  std::optional<ModelParameter> bias;  // relative to a reference: corrected; an effect where it is clear
  std::vector<double> covariance;      // of all parameters of all effects in order, row-major
  std::vector<ChannelRange> ranges;    // of the channels the effects use
  std::map<std::string, double> before, after;  // held-out figures, units in their names
  std::vector<Indistinguishable> indistinguishable;
  Unexplained unexplained;
  std::optional<Hysteresis> hysteresis;
  HeadingPrediction heading;  // if the channels run as they did in the longest record
  NoisePosterior noise_posterior;
  std::vector<ReferenceDelay> reference_delays;  // of the records that have one
  std::vector<ChannelDelay> channel_delays;
  std::vector<std::string> remarks;  // anything else a person should know, one sentence each
  DiagnosisSeries series;
};

// The model these findings make: effects, covariance, ranges, noise. Source is for the caller to fill.
void add_to_model(const Diagnosis& diagnosis, const std::string& axis, Model& model);

}  // namespace ifog
