// The diagnosis of one axis of one sensor: what in its error is explained by an effect, what that effect is,
// how large the error is before and after, what cannot be told apart, and what stays.
//
// Every test is made in the innovations of the noise model's own Kalman filter, so that slow noise is not
// taken for an effect of something slow; see search.h for the loop and whitening.h for the filter.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filters/diagnosis/belief.h"
#include "filters/model_file/model.h"

namespace ifog {

// One capture of the sensor. The caller keeps the arrays alive; all are as long as time_s.
struct RecordChannel {
  std::string name;                // the capture's column, NAME_UNIT
  std::span<const double> values;  // NaN: missing, held
};

struct Record {
  std::string name;
  std::span<const double> time_s;             // strictly increasing
  std::span<const double> rate_radps;         // NaN: missing
  std::span<const double> reference_radps{};  // empty: none; then the true rate is taken as constant
  std::string reference_name = "reference_rate_radps";
  std::vector<RecordChannel> channels;
};

struct DiagnoseOptions {
  double significance = 0.01;  // of a false effect, after correction for everything tried
  std::string axis;            // written into the effects found
  std::vector<Effect> known;   // of an earlier model: subtracted first
  // The part of each record that is fitted, as fractions of its time; the rest judges. Equal: all of it is
  // fitted, and blocks of it take turns at being held out.
  double fit_from = 0.0, fit_to = 1.0;
  std::size_t most_effects = 8;
  std::function<void(std::size_t done, std::size_t total)> progress;
};

struct FoundEffect {
  Effect effect;
  double p_value = 1.0;  // after correction for the number of tries
  double variance_explained =
      0.0;  // share of the variance of the error's 1 s means (or of single samples if longer)
  double likelihood_ratio = 0.0;  // what the fit loses without it, noise fitted anew
};

struct Indistinguishable {
  std::vector<Effect> effects;  // the first is the one the model uses
  double correlation = 0.0;     // of the regressors after whitening
  std::string separate_by;      // the capture that would tell
};

struct Unexplained {
  double fraction = 0.0;  // of the variance of the error that is neither white noise nor explained
  // "nothing", "slow", "line", "moving_line", "bursts", "changing_variance", "hysteresis", "uncorrelated"
  std::string kind;
  std::string hint;
  double frequency_hz = 0.0;    // "line", "moving_line"
  std::vector<double> times_s;  // "bursts"
};

// Heading error of the next capture, corrected by the model: the bias is taken over the first `aligned_s`
// seconds at rest and held, and the angle is integrated from then on. Promised is the root of the error's
// expected square: the noise, as uncertain as the record leaves it; the errors of the effects' parameters,
// time constants included; the other explanations that the record does not rule out; effects outside the
// range they were fitted on; and effects that are known but not corrected online, a line at any phase and a
// ramp going on. Not in it: what the diagnosis did not see, and steps, which nothing announces.
struct HeadingPrediction {
  double aligned_s = 0.0;
  std::vector<double> after_s;    // times since the end of the alignment
  std::vector<double> sigma_rad;  // root of the expected square of the heading error then
};

// What a report draws. Decimated to a few thousand points.
struct DiagnosisSeries {
  std::vector<double> time_s, before_radps, after_radps;  // block means of the error
  std::vector<std::string> names;                         // one entry an effect
  std::vector<std::vector<double>> contribution_radps,
      channel;  // by effect, at time_s; channel empty without one
  std::vector<double> frequency_hz, before_radps_rthz, after_radps_rthz;  // amplitude spectral density
  std::vector<double> tau_s, before_adev_radps, after_adev_radps;
};

struct Diagnosis {
  std::size_t samples = 0;
  double sample_rate_hz = 0.0;
  NoiseTerms noise;                             // after the effects
  std::vector<FoundEffect> effects;             // traced to channels, then ramps, then lines of the samples
  std::vector<double> covariance;               // of all parameters of all effects in order, row-major
  std::vector<ChannelRange> ranges;             // of the channels the effects use
  std::map<std::string, double> before, after;  // held-out figures, units in their names
  std::vector<Indistinguishable> indistinguishable;
  Unexplained unexplained;
  std::optional<Hysteresis> hysteresis;
  HeadingPrediction heading;  // if the channels run as they did in the longest record
  NoiseBelief belief;
  std::vector<OtherExplanation> others;
  std::vector<std::string> remarks;  // anything else a person should know, one sentence each
  DiagnosisSeries series;
};

// Throws std::invalid_argument, one line: no record, a part to fit that ends before it begins, spans of
// unequal length, a reference in some records only, fewer than 32 usable samples.
Diagnosis diagnose(const std::vector<Record>& records, const DiagnoseOptions& options);

// The model these findings make: effects, covariance, ranges, noise. Source is for the caller to fill.
void add_to_model(const Diagnosis& diagnosis, const std::string& axis, Model& model);

}  // namespace ifog
