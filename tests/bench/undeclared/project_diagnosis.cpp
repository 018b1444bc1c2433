// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/undeclared/project_diagnosis.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "filters/diagnosis/report/prediction.h"
#include "filters/effects/compensate_series.h"
#include "filters/effects/form.h"
#include "tests/bench/undeclared/contradictions.h"

namespace ifog::undeclared {
namespace {

using Series = std::vector<double>;

Series correction(const Model& model, const Capture& capture) {
  // Every capture of this generator begins at power-up.
  Compensator compensator(model, {""}, std::numeric_limits<double>::infinity(), 0.0);
  SeriesToCompensate series{capture.time_s, {capture.rate_radps[0]}, {}};
  for (const std::string& name : compensator.channels())
    for (const CaptureColumn& c : capture.channels)
      if (c.name == name) series.channels.emplace_back(c.values);
  Series subtracted(capture.size());
  compensate_series(compensator, series, [&](std::size_t k, const CompensatorOutput& out) {
    subtracted[k] = out.correction_radps[0];
  });
  return subtracted;
}

// A line's phase and the time of a step belong to the diagnosed captures; the daemon does not use them.
Series event(const Effect& effect, const Capture& capture) {
  Series out(capture.size(), 0.0);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double t = capture.time_s[k];
    if (effect.form == "line") {
      const double turn = 2.0 * std::numbers::pi * parameter(effect, "frequency_hz") * t;
      out[k] = parameter(effect, "cosine") * std::cos(turn) + parameter(effect, "sine") * std::sin(turn);
    } else if (effect.form == "step") {
      out[k] = t >= parameter(effect, "time_s") ? parameter(effect, "coefficient") : 0.0;
    } else if (effect.form == "rate_ramp") {
      out[k] = t * parameter(effect, "coefficient");
    } else if (effect.form == "warm_up") {
      out[k] = parameter(effect, "coefficient") * std::exp(-t / parameter(effect, "time_constant_s"));
    }
  }
  return out;
}

// The prediction does not see the rate: zero if there is no reference.
HeadingPrediction predicted(const Diagnosis& diagnosis, const Capture& next) {
  ifog::Record record = record_of(next, "next", 0);
  const Series none(next.size(), 0.0);
  record.rate_radps = record.reference_radps.empty() ? std::span<const double>(none) : record.reference_radps;
  return predict_heading(diagnosis, record, diagnosis.heading.aligned_s, diagnosis.heading.after_s);
}

}  // namespace

ifog::Record record_of(const Capture& capture, const std::string& name, std::size_t axis) {
  ifog::Record record;
  record.name = name;
  record.time_s = capture.time_s;
  record.rate_radps = capture.rate_radps[axis];
  record.reference_radps = capture.reference_rate_radps[axis];
  for (const CaptureColumn& c : capture.channels) record.channels.push_back({c.name, c.values});
  return record;
}

Claim claim_of(const Effect& effect, const std::vector<ChannelRange>& ranges,
               const std::vector<Capture>& diagnosed) {
  Model model;
  model.effects = {effect};
  model.ranges = ranges;
  const bool once = !carries_over(form_named(effect.form).value());
  std::vector<double> first_rates;
  for (const Capture& c : diagnosed) first_rates.push_back(c.rate_radps[0].front());
  return {effect, [=](const Capture& capture) {
            if (!once) return correction(model, capture);
            for (const double rate : first_rates)
              if (rate == capture.rate_radps[0].front()) return event(effect, capture);
            return Series(capture.size(), 0.0);
          }};
}

Diagnose project_diagnosis() {
  return [](const std::vector<Capture>& captures) {
    std::vector<ifog::Record> records;
    for (std::size_t c = 0; c < captures.size(); ++c)
      records.push_back(record_of(captures[c], "capture " + std::to_string(c + 1)));
    const Diagnosis diagnosis = diagnose(records, {});
    Finding finding;
    finding.unexplained = diagnosis.unexplained.kind != "nothing" && !diagnosis.unexplained.kind.empty();
    finding.contradictions = contradictions(diagnosis, captures);
    finding.heading = [diagnosis](const Capture& next) { return predicted(diagnosis, next); };
    for (const FoundEffect& found : diagnosis.effects) {
      if (found.effect.form == "bias") continue;  // the sensors have one; the scores are about the mean
      const std::optional<Form> form = form_named(found.effect.form);
      if (form && describes_noise(*form)) continue;  // describes the noise, not an effect
      finding.effects.push_back(claim_of(found.effect, diagnosis.ranges, captures));
    }
    return finding;
  };
}

}  // namespace ifog::undeclared
