// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/diagnose/sensor_diagnosis.h"

#include "filters/effects/form.h"
#include "tools/report/coefficients.h"

namespace ifog::tools {
namespace {

using Json = nlohmann::ordered_json;

Json name_json(const Effect& effect) {
  Json json;
  json["form"] = effect.form;
  const ChannelNames names = names_in(effect.channel);
  json["channel"] = names.of.empty() ? Json(nullptr) : Json(names.of);
  if (!names.less.empty()) json["minus_channel"] = names.less;
  if (!effect.with_form.empty()) {
    const ChannelNames with = names_in(effect.with_channel);
    json["with"] = {{"form", effect.with_form}, {"channel", with.of}};
    if (!with.less.empty()) json["with"]["minus_channel"] = with.less;
  }
  return json;
}

Json noise_terms_json(const NoiseTerms& noise) {
  Json json = Json::object();
  const char* const names[] = {"Q_rad", "N_radps_rthz", "B_radps", "K_radps2_rthz", "R_radps2"};
  for (std::size_t i = 0; i < kNoiseTerms.size(); ++i)
    if (const std::optional<double>& value = noise.*kNoiseTerms[i].second) json[names[i]] = *value;
  return json;
}

Json effect_json(const FoundEffect& found) {
  Json json = name_json(found.effect);
  json["meaning"] = found.effect.meaning;
  if (found.effect.shown_only) json["subtracted"] = false;
  Json parameters = Json::object();
  for (const ModelParameter& parameter : found.effect.parameters) {
    parameters[parameter.name] = {
        {"value", parameter.value}, {"std_error", parameter.std_error}, {"unit", parameter.unit}};
  }
  json["parameters"] = parameters;
  if (has_channel(form_named(found.effect.form).value_or(Form::kLine))) {
    json["reference"] = found.effect.reference;
    if (!found.effect.with_form.empty()) json["with"]["reference"] = found.effect.with_reference;
  }
  if (found.effect.table_x.empty() && found.effect.period > 0.0) json["period"] = found.effect.period;
  if (!found.effect.table_x.empty()) {
    json["table"] = {{"x", found.effect.table_x},
                     {"y", found.effect.table_y},
                     {"period", found.effect.period},
                     {"kind", found.effect.angle ? "angle_rad" : "rate_radps"}};
  }
  json["p_value"] = found.p_value;
  json["variance_explained"] = found.variance_explained;
  json["likelihood_ratio"] = found.likelihood_ratio;
  return json;
}

Json alternative_json(const Indistinguishable& each) {
  Json json;
  json["effects"] = Json::array();
  for (const Effect& effect : each.effects) json["effects"].push_back(name_json(effect));
  json["correlation"] = each.correlation;
  json["separate_by"] = each.separate_by;
  return json;
}

Json figures_json(const std::map<std::string, double>& figures) {
  Json json = Json::object();
  for (const auto& [name, value] : figures) json[name] = value;
  return json;
}

Json unexplained_json(const Diagnosis& diagnosis) {
  const Unexplained& unexplained = diagnosis.unexplained;
  Json json = {{"fraction", unexplained.fraction},
               {"means_s", unexplained.means_s},
               {"kind", unexplained.kind},
               {"hint", unexplained.hint}};
  if (unexplained.frequency_hz > 0.0) json["frequency_hz"] = unexplained.frequency_hz;
  if (!unexplained.times_s.empty()) json["times_s"] = unexplained.times_s;
  if (diagnosis.hysteresis) {
    json["channel"] = diagnosis.hysteresis->channel;
    json["half_width"] = diagnosis.hysteresis->half_width;
    json["coefficient"] = diagnosis.hysteresis->coefficient;
  }
  return json;
}

Json heading_json(const HeadingPrediction& heading) {
  return {{"aligned_s", heading.aligned_s}, {"after_s", heading.after_s}, {"sigma_rad", heading.sigma_rad}};
}

Json delays_json(const std::vector<ReferenceDelay>& delays) {
  Json json = Json::array();
  for (const ReferenceDelay& each : delays) {
    json.push_back({{"capture", each.record}, {"delay_s", each.delay_s}, {"std_error_s", each.std_error_s}});
  }
  return json;
}

Json delays_json(const std::vector<ChannelDelay>& delays) {
  Json json = Json::array();
  for (const ChannelDelay& each : delays)
    json.push_back({{"channel", each.channel}, {"delay_s", each.delay_s}, {"std_error_s", each.std_error_s}});
  return json;
}

}  // namespace

Json diagnosis_json(const std::vector<AxisDiagnosis>& axes) {
  const Diagnosis& first = axes.front().diagnosis;
  Json json;
  json["schema"] = "ifog.diagnosis/1";
  json["samples"] = first.samples;
  json["sample_rate_hz"] = first.sample_rate_hz;
  const auto put = [&](const char* key, auto&& make) {
    if (axes.size() == 1) {
      json[key] = make(first);
      return;
    }
    json[key] = Json::object();
    for (const AxisDiagnosis& each : axes) json[key][each.axis] = make(each.diagnosis);
  };
  // All axes in one list; with several axes each entry has its axis.
  const auto list = [&](const char* key, auto items, auto&& make) {
    json[key] = Json::array();
    for (const AxisDiagnosis& each : axes)
      for (const auto& item : each.diagnosis.*items) {
        json[key].push_back(make(item));
        if (!each.axis.empty()) json[key].back()["axis"] = each.axis;
      }
  };
  put("noise", [](const Diagnosis& d) {
    Json noise = noise_terms_json(d.noise);
    noise["std_error"] = noise_terms_json(d.noise_error);
    noise["gauss_markov"] = report::markov_json(d.markov);
    return noise;
  });
  list("noise_changes", &Diagnosis::noise_changes, [](const NoiseChangeIn& found) {
    Json change = report::noise_changes_json({&found.change, 1})[0];
    change["capture"] = found.capture;
    return change;
  });
  list("effects", &Diagnosis::effects, [](const FoundEffect& found) { return effect_json(found); });
  put("bias", [](const Diagnosis& d) {
    return d.bias ? Json{{"value", d.bias->value}, {"std_error", d.bias->std_error}, {"unit", "rad/s"}}
                  : Json(nullptr);
  });
  put("before", [](const Diagnosis& d) { return figures_json(d.before); });
  put("after", [](const Diagnosis& d) { return figures_json(d.after); });
  list("indistinguishable", &Diagnosis::indistinguishable,
       [](const Indistinguishable& pair) { return alternative_json(pair); });
  put("unexplained", [](const Diagnosis& d) { return unexplained_json(d); });
  put("heading_prediction", [](const Diagnosis& d) { return heading_json(d.heading); });
  put("reference_delay", [](const Diagnosis& d) { return delays_json(d.reference_delays); });
  put("channel_delays", [](const Diagnosis& d) { return delays_json(d.channel_delays); });
  json["remarks"] = Json::array();
  for (const AxisDiagnosis& each : axes)
    for (const std::string& remark : each.diagnosis.remarks)
      json["remarks"].push_back(each.axis.empty() ? remark : each.axis + ": " + remark);
  return json;
}

}  // namespace ifog::tools
