// SPDX-License-Identifier: Apache-2.0
// Doors of the report: effects with their errors, the model as written and the figures before and after, noise, pictures, and
// sentences for users on what was not used and why.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/checks/checks.h"
#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/record/fitted_part.h"
#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/regression/noise_fit.h"
#include "filters/diagnosis/regression/uncertainty.h"
#include "filters/diagnosis/residual/lines.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {

// Sets effects, in the order of `chosen`, and indistinguishable pairs, with coefficients, time constants and errors from
// `joint`. Returns the part of each effect, rad/s by block. data: channels as they were read.
std::vector<Eigen::VectorXd> write_findings(const BlockData& data, const SearchResult& found,
                                            const JointFit& joint, const std::string& axis,
                                            Diagnosis& diagnosis);

Effect effect_with(const BlockData& data, const Candidate& candidate, double coefficient,
                   const std::string& axis);

// Row-major, of all parameters of all effects: first those of `joint`, the others without correlation.
std::vector<double> covariance_of(const std::vector<FoundEffect>& effects, const JointFit& joint,
                                  const BlockGrid& grid, std::size_t jointly);

// Diagnosis::means. of_chosen: means of the regressors of the first effects, zero if not corrected.
std::vector<double> means_of_corrections(const std::vector<FoundEffect>& effects,
                                         const std::vector<ChannelRange>& ranges,
                                         const Eigen::VectorXd& of_chosen);

std::vector<ChannelRange> ranges_of(const BlockData& data, const std::vector<FoundEffect>& effects);

// Joint fit of the chosen effects; updates `found`.
JointFit settle(const BlockData& reconstructed, SearchResult& found);

// Sets the bias relative to a reference, which the model corrects: the mean that the corrected effects leave.
// means: from means_of(), zero for effects that are not corrected. The bias is also added as an effect `bias` if
// it exceeds five standard deviations.
void name_bias(const BlockGrid& grid, const JointFit& joint, const Eigen::VectorXd& means,
               const std::string& axis, Diagnosis& diagnosis);

// Fills `written`, `after` and `held_out` of each error with the daemon's correction by the model from
// add_to_model(). found: effects of the search; those not corrected online are also removed from `after`.
// Throws as Compensator does.
void subtract_effects(const std::vector<Record>& records, const BlockData& data, const SearchResult& found,
                      const Diagnosis& diagnosis, std::vector<EvenError>& errors);

// Among the first `candidates` effects, the online-corrected one without which the error is smallest, in
// means over 1/2000 of the record; nullopt if none is corrected.
std::optional<std::size_t> least_missed_effect(const std::vector<Record>& records, const Diagnosis& diagnosis,
                                               std::size_t candidates, double sample_s);

// Time constant of effect `at`, a rate of change, with which the daemon's correction by the readings themselves leaves the
// smallest error: that of the error may be shorter than their noise allows. Tries up to `most_s` by factors of 1.5.
double smoothing_s(const std::vector<Record>& records, const Diagnosis& diagnosis, std::size_t at,
                   double most_s, double sample_s);

// Fills `before` and `after`. Each figure after is the larger of two: residual of the written model, and
// residual of effects fitted without each sample's own part.
void write_before_and_after(const std::vector<EvenError>& errors, double sample_s, bool with_bias,
                            Diagnosis& diagnosis);

// The shares of effects that oppose each other or slow noise add up to more than is removed. Lowers the
// shares of the first `jointly` effects in proportion to what the unexplained part leaves; the others are
// shares of single samples.
void balance_shares(std::size_t jointly, Diagnosis& diagnosis);

// True if the RMS of samples or of means has increased: by more than 2 % for 100 values or more, else by more
// than chance. The effect that causes it is then dropped. If none can be dropped the report states the
// increase. diagnosis: before and after are filled.
bool grows_over_many(const Diagnosis& diagnosis, const std::vector<EvenError>& errors);

// Sentence on the figures that have increased, or empty. samples: their number.
std::string grown_in_words(const Diagnosis& diagnosis, double samples);
[[nodiscard]] double samples_of(const std::vector<EvenError>& errors);

// Replaces before and after by figures of the part that was not fitted. The model's effects are subtracted by
// the daemon's code over the whole record, so that its lags are settled in that part.
void judge(const std::vector<Record>& records, const TimeShare& fitted, Diagnosis& diagnosis);

// Fills `noise`, `noise_error` and `noise_changes`; adds a remark if the record is too short or its noise
// level changes. Dwells are not evenly sampled: then only the regression's white noise is given.
void write_noise(const std::vector<Record>& records, const std::vector<EvenError>& errors,
                 const BlockGrid& grid, const NoiseFit& regression, Diagnosis& diagnosis);

// parts: rad/s by block, of each chosen effect; effects: the chosen ones, then others; noise: of the
// residual, for the confidence of the deviation after.
DiagnosisSeries series_of(const BlockData& data, const std::vector<EvenError>& errors,
                          const std::vector<Chosen>& chosen, const std::vector<FoundEffect>& effects,
                          const std::vector<Eigen::VectorXd>& parts, const NoiseTerms& noise);

// Effect that increases an error in the daemon's correction.
std::string harmful_in_words(const Effect& effect, bool by_chance);

// Effects of one channel that a capture refutes.
std::string denied_in_words(const std::vector<Effect>& effects, const DeniedEffects& denied,
                            const std::vector<Record>& records);

// Warns that a channel may only be correlated with the cause, if much stays unexplained. Empty if little does
// or no effect uses a channel. captures: number diagnosed together.
std::string unexplained_despite_claims(const Diagnosis& diagnosis, std::size_t captures);

// Names the values of channels for which bias and scale factor are given although the captures are far from them. Empty
// without a reference rate, or if every capture reaches them.
std::string far_zeros_in_words(const Diagnosis& diagnosis);

// Throws std::invalid_argument if the rate is as many times the reference as another sign or unit makes it.
void refuse_other_unit(const Diagnosis& diagnosis);

// Sentence on a record that turns while more than a twentieth of the variance of its 1 s means is not the
// reference's; empty if none does.
std::string unlike_reference_in_words(const std::vector<Record>& records,
                                      const std::vector<EvenError>& errors, double sample_s);

// Sentence on the channels that cannot be used: not in every record, without a value, or constant; empty if
// there is none. ramps: effects that already use channels.
std::string unused_channels(const std::vector<Record>& records, const BlockData& data,
                            const std::vector<FoundEffect>& ramps);

}  // namespace ifog
