// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <type_traits>

#include "filters/model_file/channel_names.h"
#include "filters/model_file/covariance.h"
#include "filters/model_file/model.h"
#include "filters/model_file/sha256.h"
#include "filters/model_file/toml_text.h"
#include "filters/settings/filter_table.h"

namespace ifog {
namespace {

class Text {
 public:
  void table(const std::string& name) { text_ += "\n[" + name + "]\n"; }
  void element(const std::string& name) { text_ += "\n[[" + name + "]]\n"; }
  void line(const std::string& key, const std::string& value) { text_ += key + " = " + value + "\n"; }
  void words(const std::string& key, const std::string& value) {
    if (!value.empty()) line(key, toml_quoted(value));
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

void write_noise(Text& text, const std::string& axis, const NoiseTerms& noise) {
  text.element("noise");
  text.words("axis", axis);
  for (const auto& [key, term] : kNoiseTerms)
    if (noise.*term) text.line(key, toml_number(*(noise.*term)));
}

std::string as_toml(const SettingValue& value) {
  return std::visit(
      [](const auto& v) -> std::string {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, bool>)
          return v ? "true" : "false";
        else if constexpr (std::is_same_v<T, std::int64_t>)
          return std::to_string(v);
        else if constexpr (std::is_same_v<T, double>)
          return toml_number(v);
        else if constexpr (std::is_same_v<T, std::string>)
          return toml_quoted(v);
        else
          return toml_list(v);
      },
      value);
}

void write_filter(Text& text, const FilterSettings& filter) {
  text.table("filter");
  for (const FilterSetting& setting : filter_table()) {
    const SettingValue value = value_of(setting, filter);
    const auto* const items = std::get_if<std::vector<double>>(&value);
    if (items == nullptr || !items->empty()) text.line(setting.key, as_toml(value));
  }
}

void write_channel(Text& text, const std::string& prefix, const std::string& channel) {
  const ChannelNames names = names_in(channel);
  text.words(prefix + "channel", names.of);
  text.words(prefix + "minus_channel", names.less);
}

void write_effect(Text& text, const Effect& effect) {
  text.element("effect");
  text.words("form", effect.form);
  write_channel(text, "", effect.channel);
  text.words("with_form", effect.with_form);
  write_channel(text, "with_", effect.with_channel);
  text.words("axis", effect.axis);
  text.words("meaning", effect.meaning);
  text.line("reference", toml_number(effect.reference));
  if (effect.with_reference != 0.0) text.line("with_reference", toml_number(effect.with_reference));
  if (!effect.table_x.empty()) {
    text.line("table_x", toml_list(effect.table_x));
    text.line("table_y", toml_list(effect.table_y));
  }
  if (effect.period > 0.0) text.line("period", toml_number(effect.period));
  if (effect.angle) text.line("angle", "true");
  for (const ModelParameter& parameter : effect.parameters) {
    text.element("effect.parameter");
    text.words("name", parameter.name);
    text.line("value", toml_number(parameter.value));
    text.line("std_error", toml_number(parameter.std_error));
    text.words("unit", parameter.unit);
  }
}

void write_source(Text& text, const ModelSource& source) {
  text.table("source");
  text.words("capture", source.capture);
  text.words("sha256", source.sha256);
  text.words("date", source.date);
  if (!source.before.empty()) text.table("source.before");
  for (const auto& [name, value] : source.before) text.line(toml_quoted(name), toml_number(value));
  if (!source.after.empty()) text.table("source.after");
  for (const auto& [name, value] : source.after) text.line(toml_quoted(name), toml_number(value));
}

}  // namespace

std::string model_text(const Model& model) {
  Text text;
  text.line("version", std::to_string(Model::kVersion));
  text.words("sensor", model.sensor);
  if (!model.covariance.empty()) {
    const auto size = static_cast<std::size_t>(std::lround(std::sqrt(double(model.covariance.size()))));
    const std::vector<double> covariance = of_rows(model.covariance, size, rows_in_file(model.effects));
    if (!covariance.empty()) text.line("covariance", toml_list(covariance));
  }
  for (const auto& [axis, noise] : model.noise) write_noise(text, axis, noise);
  if (model.filter) write_filter(text, *model.filter);
  for (const Effect& effect : model.effects) write_effect(text, effect);
  for (const ChannelRange& range : model.ranges) {
    text.element("range");
    write_channel(text, "", range.channel);
    text.line("low", toml_number(range.low));
    text.line("high", toml_number(range.high));
    if (range.early_s > 0.0) text.line("early_s", toml_number(range.early_s));
  }
  write_source(text, model.source);
  return text.take();
}

std::string Model::identity() const { return sha256_hex(model_text(*this)).substr(0, 12); }

}  // namespace ifog
