// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"
#include "filters/model_file/channel_names.h"
#include "filters/model_file/covariance.h"
#include "filters/model_file/form.h"
#include "filters/model_file/model.h"
#include "filters/model_file/toml_file.h"
#include "filters/rules/names.h"
#include "filters/settings/filter_table.h"

namespace ifog {
namespace {

// Largest number in a model, in any unit (rad/s per seventh power of counts included); products of two do not
// overflow. Variances: its square.
constexpr double kMost = 1e30;
constexpr double kMostVariance = kMost * kMost;

// One table of the file. Keys that are never read are reported as unknown.
class Table {
 public:
  Table(const toml::table& table, std::string file, std::string where)
      : table_(table), file_(std::move(file)), where_(std::move(where)) {}

  [[nodiscard]] std::uint32_t line() const { return table_.source().begin.line; }

  [[noreturn]] void fail(const std::string& key, const toml::node* node, const std::string& complaint) const {
    std::ostringstream text;
    text << file_;
    const auto line = (node ? node->source() : table_.source()).begin.line;
    if (line) text << ':' << line;
    text << ": " << printable(where_ + key);
    if (node) {
      std::ostringstream value;
      node->visit([&](const auto& n) {
        if constexpr (toml::is_value<decltype(n)>) value << n;
      });
      text << (value.str().empty() ? "" : " = " + printable(value.str()));
    }
    text << ": " << complaint;
    throw std::runtime_error(text.str());
  }

  const toml::node* find(const std::string& key) {
    known_.push_back(key);
    return table_.get(key);
  }

  // Finite and at most kMost.
  double plausible(const std::string& key, const toml::node& node, double most = kMost) const {
    const auto value = node.value<double>();
    // NaN fails this comparison.
    if (!value || !(std::abs(*value) <= most))
      fail(key, &node, "expected a finite number within " + text(most));
    return *value;
  }

  double number(const std::string& key, double otherwise) {
    const toml::node* node = find(key);
    return node ? plausible(key, *node) : otherwise;
  }

  double required(const std::string& key) {
    const toml::node* node = find(key);
    if (!node) fail(key, nullptr, "expected a number, found nothing");
    return plausible(key, *node);
  }

  double not_negative(const std::string& key, double otherwise) {
    const double value = number(key, otherwise);
    if (value < 0.0) fail(key, find(key), "expected at least 0");
    return value;
  }

  // "nan" means unknown, e.g. the record was too short.
  double number_or_unknown(const std::string& key, double otherwise) {
    const toml::node* node = find(key);
    if (!node) return otherwise;
    const auto value = node->value<double>();
    return value && std::isnan(*value) ? *value : plausible(key, *node);
  }

  std::string words(const std::string& key) {
    const toml::node* node = find(key);
    if (!node) return "";
    const auto value = node->value_exact<std::string>();
    if (!value) fail(key, node, "expected a string");
    return *value;
  }

  bool yes(const std::string& key, bool otherwise) {
    const toml::node* node = find(key);
    if (!node) return otherwise;
    const auto value = node->value_exact<bool>();
    if (!value) fail(key, node, "expected true or false");
    return *value;
  }

  std::vector<double> numbers(const std::string& key, double most = kMost) {
    const toml::node* node = find(key);
    std::vector<double> values;
    if (!node) return values;
    const toml::array* array = node->as_array();
    if (!array) fail(key, node, "expected a list of numbers");
    for (const toml::node& item : *array) values.push_back(plausible(key, item, most));
    return values;
  }

  // Tables of [[key]], or of [key] if `single`.
  std::vector<Table> tables(const std::string& key, bool single = false) {
    std::vector<Table> found;
    const toml::node* node = find(key);
    if (!node) return found;
    if (single) {
      if (!node->is_table()) fail(key, node, "expected a table [" + key + "]");
      found.emplace_back(*node->as_table(), file_, where_ + key + ".");
      return found;
    }
    const toml::array* array = node->as_array();
    if (!array) fail(key, node, "expected tables [[" + key + "]]");
    for (const toml::node& item : *array) {
      if (!item.is_table()) fail(key, &item, "expected tables [[" + key + "]]");
      found.emplace_back(*item.as_table(), file_,
                         where_ + key + "[" + std::to_string(found.size() + 1) + "].");
    }
    return found;
  }

  std::map<std::string, double> figures() {
    std::map<std::string, double> values;
    for (const auto& [key, node] : table_)
      values[std::string(key.str())] = number_or_unknown(std::string(key.str()), 0.0);
    return values;
  }

  void done() const {
    for (const auto& [key, node] : table_) {
      const std::string name(key.str());
      bool known = false;
      for (const std::string& k : known_) known = known || k == name;
      if (!known) fail(name, &node, "unknown key" + did_you_mean(name, known_));
    }
  }

 private:
  static std::string text(double value) {
    std::ostringstream out;
    out << value;
    return out.str();
  }

  const toml::table& table_;
  std::string file_, where_;
  std::vector<std::string> known_;
};

void read_noise(Table table, Model& model) {
  const std::string axis = table.words("axis");
  if (model.noise.contains(axis))
    table.fail("axis", table.find("axis"), "expected one table [[noise]] for each axis, this is its second");
  NoiseTerms& noise = model.noise[axis];
  for (const auto& [key, term] : kNoiseTerms)
    if (table.find(key)) noise.*term = table.not_negative(key, 0.0);
  table.done();
}

FilterSettings read_filter(Table table) {
  FilterChoice choice;
  for (const FilterSetting& setting : filter_table()) {
    const toml::node* const node = table.find(setting.key);
    if (node == nullptr) continue;
    const std::optional<SettingValue> value = setting_value(*node);
    if (!value || !choose(setting, *value, choice))
      table.fail(setting.key, node, "expected " + expected(setting, node->value<std::string>().value_or("")));
    // Names that are defined elsewhere are checked there.
    const std::string wrong = setting.choices.empty() && std::holds_alternative<std::string>(*value)
                                  ? expected_name(setting, std::get<std::string>(*value))
                                  : "";
    if (!wrong.empty()) table.fail(setting.key, node, "expected " + wrong);
  }
  table.done();
  return settings_in_force(choice, FilterSettings{});
}

std::string channel_of(Table& table, const std::string& key, const std::string& minus_key) {
  std::string channel = table.words(key);
  const std::string less = table.words(minus_key);
  if (less.empty()) return channel;
  if (channel.empty())
    table.fail(key, nullptr, "expected the channel that " + minus_key + " is subtracted from");
  return difference_of(channel, less);
}

// Parameter names must belong to the form and be unique.
void check_name(Table& item, const std::string& name, const std::vector<ParameterRule>& rules, Form form,
                const Effect& effect) {
  for (const ModelParameter& other : effect.parameters)
    if (other.name == name) item.fail("name", item.find("name"), "this is the effect's second of that name");
  if (describes_noise(form)) return;
  std::vector<std::string_view> known;
  std::string list;
  for (const ParameterRule& rule : rules) {
    if (rule.name == name) return;
    known.push_back(rule.name);
    list += (list.empty() ? "" : ", ") + std::string(rule.name);
  }
  item.fail("name", item.find("name"),
            "form " + effect.form + " has no such parameter" + did_you_mean(name, known) +
                (known.empty() ? "" : "; it has: " + list));
}

void read_parameters(Table& table, Form form, Effect& effect) {
  const std::vector<ParameterRule> rules = parameters_of(form, form_named(effect.with_form));
  for (Table& item : table.tables("parameter")) {
    ModelParameter parameter;
    parameter.name = item.words("name");
    if (parameter.name.empty()) item.fail("name", nullptr, "expected the name of a parameter");
    check_name(item, parameter.name, rules, form, effect);
    parameter.value = item.required("value");
    for (const ParameterRule& rule : rules)
      if (rule.name == parameter.name && !allows(rule, parameter.value))
        item.fail("value", item.find("value"), "expected " + expected(rule));
    parameter.std_error = item.number_or_unknown("std_error", 0.0);
    if (parameter.std_error < 0.0) item.fail("std_error", item.find("std_error"), "expected at least 0");
    parameter.unit = item.words("unit");
    item.done();
    effect.parameters.push_back(std::move(parameter));
  }
}

void require_parameters(Table& table, Form form, const Effect& effect) {
  for (const ParameterRule& rule : parameters_of(form, form_named(effect.with_form))) {
    bool there = !rule.needed;
    for (const ModelParameter& parameter : effect.parameters) there = there || parameter.name == rule.name;
    if (!there)
      table.fail("parameter", nullptr,
                 "form " + effect.form + " needs [[effect.parameter]] name = \"" + std::string(rule.name) +
                     "\", " + expected(rule));
  }
}

std::vector<std::string_view> names_of_forms(bool (*are)(Form)) {
  std::vector<std::string_view> names;
  for (const FormRules& rules : form_rules())
    if (are(rules.form)) names.push_back(rules.name);
  return names;
}

// Checks the inputs that the form needs; the sensor is checked elsewhere.
void require_source(Table& table, Form form, const Effect& effect) {
  if (!has_channel(form) || form == Form::kDeadZone || form == Form::kEarthRate) return;
  if (effect.channel.empty())
    table.fail("channel", table.find("channel"),
               "form " + effect.form + " is of a channel, expected its name");
  if (form == Form::kLookup && effect.table_x.size() < 2)
    table.fail("table_x", table.find("table_x"), "form lookup needs a table, expected at least two knots");
  if (is_of_angle(form) && !(effect.period > 0.0))
    table.fail("period", table.find("period"),
               "form " + effect.form + " needs its period, expected more than 0");
  if (form != Form::kProduct) return;
  const std::vector<std::string_view> forms = names_of_forms(may_be_factor);
  if (std::ranges::find(forms, effect.with_form) == forms.end())
    table.fail("with_form", table.find("with_form"),
               "no form that a product can be with, expected " + one_of(effect.with_form, forms));
  if (effect.with_channel.empty())
    table.fail("with_channel", table.find("with_channel"),
               "a product is of two channels, expected the second");
}

Effect read_effect(Table table) {
  Effect effect;
  effect.line = table.line();
  effect.form = table.words("form");
  if (effect.form.empty()) table.fail("form", nullptr, "expected the name of a form");
  const std::optional<Form> form = form_named(effect.form);
  if (!form) {
    const auto known = names_of_forms([](Form) { return true; });
    table.fail("form", table.find("form"), "unknown form" + did_you_mean(effect.form, known));
  }
  effect.channel = channel_of(table, "channel", "minus_channel");
  effect.with_form = table.words("with_form");
  effect.with_channel = channel_of(table, "with_channel", "with_minus_channel");
  effect.axis = table.words("axis");
  effect.meaning = table.words("meaning");
  effect.reference = table.number("reference", 0.0);
  effect.with_reference = table.number("with_reference", 0.0);
  effect.table_x = table.numbers("table_x");
  effect.table_y = table.numbers("table_y");
  effect.period = table.not_negative("period", 0.0);
  effect.angle = table.yes("angle", false);
  if (effect.table_x.size() != effect.table_y.size()) {
    table.fail("table_y", table.find("table_y"), "expected as many values as table_x has knots");
  }
  for (std::size_t i = 1; i < effect.table_x.size(); ++i) {
    if (!(effect.table_x[i] > effect.table_x[i - 1])) {
      table.fail("table_x", table.find("table_x"), "expected knots that increase");
    }
  }
  read_parameters(table, *form, effect);
  table.done();
  require_source(table, *form, effect);
  require_parameters(table, *form, effect);
  return effect;
}

// Covariance of the parameters of effects corrected online, or of all parameters.
void read_covariance(Table& table, std::size_t parameters, Model& model) {
  const std::size_t numbers = model.covariance.size();
  if (numbers == 0) return;
  const std::size_t corrected = rows_in_file(model.effects).size();
  const bool of_all = numbers == parameters * parameters;
  if (!of_all && numbers != corrected * corrected) {
    table.fail(
        "covariance", nullptr,
        "expected " + std::to_string(corrected * corrected) +
            " numbers, the square of the number of parameters of the effects that are corrected, found " +
            std::to_string(numbers));
  }
  if (const std::string flaw = covariance_flaw(model.covariance, of_all ? parameters : corrected);
      !flaw.empty())
    table.fail("covariance", nullptr, "expected a covariance matrix, symmetric and positive: " + flaw);
  if (!of_all) model.covariance = of_all_parameters(model.covariance, model.effects);
}

}  // namespace

Model parse_model(std::string_view text, const std::string& name) {
  const toml::table root = parse_toml(text, name);
  Table table(root, name, "");
  const toml::node* version = table.find("version");
  if (!version || version->value_exact<std::int64_t>() != Model::kVersion) {
    table.fail("version", version,
               "expected version = " + std::to_string(Model::kVersion) + ", the only one this program knows");
  }
  Model model;
  model.sensor = table.words("sensor");
  model.covariance = table.numbers("covariance", kMostVariance);
  for (Table& noise : table.tables("noise")) read_noise(std::move(noise), model);
  for (Table& filter : table.tables("filter", true)) model.filter = read_filter(std::move(filter));
  std::size_t parameters = 0;
  for (Table& effect : table.tables("effect")) {
    model.effects.push_back(read_effect(std::move(effect)));
    parameters += model.effects.back().parameters.size();
  }
  read_covariance(table, parameters, model);
  for (Table& item : table.tables("range")) {
    ChannelRange range;
    range.channel = channel_of(item, "channel", "minus_channel");
    range.low = item.required("low");
    range.high = item.required("high");
    if (range.high < range.low) item.fail("high", item.find("high"), "expected at least low");
    range.early_s = item.not_negative("early_s", 0.0);
    if (range.early_s > kMostEarly_s)
      item.fail("early_s", item.find("early_s"),
                "expected at most " + std::to_string(static_cast<int>(kMostEarly_s)));
    item.done();
    model.ranges.push_back(std::move(range));
  }
  for (Table& source : table.tables("source", true)) {
    model.source.capture = source.words("capture");
    model.source.sha256 = source.words("sha256");
    model.source.date = source.words("date");
    for (Table& before : source.tables("before", true)) model.source.before = before.figures();
    for (Table& after : source.tables("after", true)) model.source.after = after.figures();
    source.done();
  }
  table.done();
  return model;
}

Model read_model(const std::string& path) { return parse_model(read_toml_text(path), path); }

}  // namespace ifog
