// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/sample_effects.h"

#include <algorithm>

#include "filters/effects/form.h"
#include "filters/effects/meaning.h"

namespace ifog {
namespace {

// Share of the errors' variance that a part, given by record and sample, explains.
template <class PartOf>
double share_of(const std::vector<EvenError>& errors, const PartOf& part_of) {
  double explained = 0.0, total = 0.0;
  for (std::size_t r = 0; r < errors.size(); ++r) {
    explained += variance_of(part_of(r));
    total += variance_of(*errors[r].before);
  }
  return total > 0.0 ? std::min(1.0, explained / total) : 0.0;
}

FoundEffect zone_effect(const FoundZone& of, const std::vector<EvenError>& errors) {
  const DeadZone& zone = of.zone;
  FoundEffect found;
  Effect& effect = found.effect;
  effect.form = name_of(Form::kDeadZone);
  effect.channel = of.channel;
  effect.parameters = {{"coefficient", zone.coefficient, zone.coefficient_error, coefficient_unit(effect)},
                       {std::string(kHalfWidth), zone.half_width, zone.half_width_error, "rad/s"}};
  effect.meaning = meaning_of(effect);
  found.p_value = zone.p_value;
  found.likelihood_ratio = zone.ratio;
  found.variance_explained = share_of(errors, [&](std::size_t r) { return hidden_by(zone, of.rates[r]); });
  return found;
}

FoundEffect line_effect(const SpectralLine& line, double total_variance) {
  FoundEffect found;
  Effect& effect = found.effect;
  effect.form = "line";
  effect.parameters = {{"cosine", line.cosine, line.std_error, "rad/s"},
                       {"sine", line.sine, line.std_error, "rad/s"},
                       {"frequency_hz", line.frequency_hz, line.frequency_std_hz, "Hz"}};
  effect.meaning = meaning_of(effect);
  found.p_value = line.p_value;
  found.likelihood_ratio = 2.0 * line.ratio;
  const double power = 0.5 * (line.cosine * line.cosine + line.sine * line.sine);
  found.variance_explained = total_variance > 0.0 ? std::min(1.0, power / total_variance) : 0.0;
  return found;
}

}  // namespace

std::vector<FoundEffect> sample_effects(const std::vector<RampFit>& ramps,
                                        const std::optional<FoundZone>& zone,
                                        const std::vector<LineOf>& lines,
                                        const std::vector<EvenError>& errors, const std::string& axis) {
  std::vector<FoundEffect> found;
  found.reserve(ramps.size() + lines.size() + 1);
  for (const RampFit& ramp : ramps) {
    found.push_back(ramp.found);
    found.back().variance_explained =
        share_of(errors, [&](std::size_t r) -> const Samples& { return ramp.correction[r]; });
  }
  if (zone) found.push_back(zone_effect(*zone, errors));
  for (const auto& [record, line] : lines)
    found.push_back(line_effect(line, variance_of(*errors[record].before)));
  for (FoundEffect& each : found) each.effect.axis = axis;
  return found;
}

}  // namespace ifog
