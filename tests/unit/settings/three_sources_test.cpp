// SPDX-License-Identifier: Apache-2.0
// Every row of the table of filter settings, asked of the configuration, the model file and the command line
// at and next to the ends of its range: what one accepts the others accept, as the same value.
#include "daemon/config/config.h"
#include "filters/model_file/model.h"
#include "filters/model_file/toml_file.h"
#include "filters/model_file/toml_text.h"
#include "filters/settings/filter_table.h"
#include "tests/unit/test.h"
#include "tools/ifog/console/command_line.h"
#include "tools/ifog/console/filter_options.h"

namespace {

using namespace ifog;

// 50 once it is narrowed to 32 bits.
constexpr std::int64_t kWrapsToFifty = (std::int64_t{1} << 32) + 50;

// A value as each source has it written, and what should come of it.
struct Asked {
  std::string toml;                   // behind "KEY = "
  std::vector<std::string> words;     // on the command line
  std::optional<SettingValue> value;  // none: to be refused
};

std::optional<SettingValue> in_configuration(const FilterSetting& setting, const Asked& asked) {
  const std::string text =
      "[[sensor]]\nname = \"n\"\ndriver = \"d\"\n[sensor.transport]\ntype = \"file\"\npath = \"p\"\n"
      "[sensor.filter]\n" +
      std::string(setting.key) + " = " + asked.toml + "\n";
  try {
    return value_of(setting, settings_in_force(parse_config(text, "f").sensors.at(0).filter, {}));
  } catch (const ConfigError&) {
    return std::nullopt;
  }
}

std::optional<SettingValue> in_model_file(const FilterSetting& setting, const Asked& asked) {
  const std::string text = "version = 1\n[filter]\n" + std::string(setting.key) + " = " + asked.toml + "\n";
  try {  // which is also written again
    return value_of(setting, parse_model(model_text(parse_model(text, "f")), "f").filter.value());
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

FilterChoice typed;
void add_take(const tools::Command& program) {
  const tools::Command take = program.add_subcommand("take", "take the settings of a filter");
  tools::add_filter_options(take, typed);
  take.callback([] {});
}

std::optional<SettingValue> on_command_line(const FilterSetting& setting, const Asked& asked) {
  std::vector<std::string> words{"ifog", "take"};
  words.insert(words.end(), asked.words.begin(), asked.words.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  constexpr std::array<tools::AddCommand, 1> kCommands{add_take};
  typed = {};
  const int status = tools::run_command_line(static_cast<int>(arguments.size()), arguments.data(), kCommands);
  if (status != 0) return std::nullopt;
  return value_of(setting, settings_in_force(typed, {}));
}

std::string in_words(const std::optional<SettingValue>& value) {
  if (!value) return "refused";
  if (const auto* const text = std::get_if<std::string>(&*value)) return *text;
  if (const auto* const number = std::get_if<double>(&*value)) return std::to_string(*number);
  if (const auto* const whole = std::get_if<std::int64_t>(&*value)) return std::to_string(*whole);
  return "a flag or a list";
}

void expect_same(const FilterSetting& setting, const Asked& asked) {
  const std::optional<SettingValue> configured = in_configuration(setting, asked);
  const std::optional<SettingValue> modelled = in_model_file(setting, asked);
  const std::optional<SettingValue> given = on_command_line(setting, asked);
  const std::string what = std::string(setting.key) + " = " + asked.toml;
  EXPECT_TRUE(configured == asked.value) << "configuration: " << what << ": " << in_words(configured);
  EXPECT_TRUE(modelled == asked.value) << "model file: " << what << ": " << in_words(modelled);
  EXPECT_TRUE(given == asked.value) << "command line: " << what << ": " << in_words(given);
}

Asked written(const FilterSetting& setting, const std::string& text, std::optional<SettingValue> value) {
  return {text, {std::string(setting.option) + "=" + text}, std::move(value)};
}

std::vector<Asked> flags(const FilterSetting& setting) {
  const bool usual = std::get<bool>(value_of(setting, FilterSettings{}));
  // A flag has no value: to give it is to say what is not so by default.
  return {{usual ? "false" : "true", {setting.option}, SettingValue{!usual}},
          {usual ? "true" : "false", {}, SettingValue{usual}},
          {"\"some\"", {std::string(setting.option) + "=some"}, std::nullopt},
          {"nan", {std::string(setting.option) + "=nan"}, std::nullopt}};
}

template <typename T>
std::vector<Asked> whole_numbers(const FilterSetting& setting) {
  const auto least = static_cast<std::int64_t>(setting.range.least);
  std::vector<Asked> all;
  const auto ask = [&](std::int64_t value, bool good) {
    all.push_back(
        written(setting, std::to_string(value), good ? std::optional<SettingValue>(value) : std::nullopt));
  };
  ask(least, true);
  ask(least + 1, true);
  ask(least - 1, false);
  ask(-kWrapsToFifty, false);
  if (std::isinf(setting.range.most)) {
    EXPECT_GE(sizeof(T), sizeof(std::int64_t)) << setting.key << " would be narrowed";
    ask(kWrapsToFifty, true);
    ask(std::numeric_limits<std::int64_t>::max(), true);
  } else {
    const auto most = static_cast<std::int64_t>(setting.range.most);
    EXPECT_LT(most, std::numeric_limits<std::int32_t>::max()) << setting.key;
    ask(most, true);
    ask(most + 1, false);
    ask(kWrapsToFifty, false);
    ask(std::numeric_limits<std::int64_t>::max(), false);
  }
  for (const char* const text :
       {"9223372036854775808", "18446744073709551666", "nan", "inf", "-inf", "50.5", "5e1", "true"})
    all.push_back(written(setting, text, std::nullopt));
  return all;
}

std::vector<Asked> numbers(const FilterSetting& setting) {
  const SettingRange& range = setting.range;
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<Asked> all;
  const auto ask = [&](double value, bool good) {
    all.push_back(
        written(setting, toml_number(value), good ? std::optional<SettingValue>(value) : std::nullopt));
  };
  ask(range.least, true);
  ask(range.least - 1.0, false);
  ask(-1e-300, false);
  ask(std::nextafter(range.most, 0.0), true);
  ask(range.most, !range.below_most);
  ask(std::nextafter(range.most, infinity), false);
  ask(static_cast<double>(kWrapsToFifty), static_cast<double>(kWrapsToFifty) < range.most);
  if (range.least_but_zero > 0.0) {
    ask(range.least_but_zero, true);
    ask(std::nextafter(range.least_but_zero, 0.0), false);
  } else {
    ask(1e-300, true);
  }
  for (const char* const text : {"nan", "-nan", "inf", "-inf", "1e400", "true"})
    all.push_back(written(setting, text, std::nullopt));
  return all;
}

std::vector<Asked> texts(const FilterSetting& setting) {
  std::vector<Asked> all;
  const auto ask = [&](const std::string& text, bool good) {
    all.push_back({"\"" + text + "\"",
                   {std::string(setting.option) + "=" + text},
                   good ? std::optional<SettingValue>(text) : std::nullopt});
  };
  for (const char* const choice : setting.choices) ask(choice, true);
  // The default of a name that another room knows.
  ask(std::get<std::string>(value_of(setting, FilterSettings{})), true);
  ask("", false);
  ask("no-such-name", false);
  ask(std::get<std::string>(value_of(setting, FilterSettings{})) + "x", false);
  return all;
}

std::vector<Asked> lists(const FilterSetting& setting) {
  const std::string option = setting.option;
  return {
      {"[1, -0.5]", {option + "=1,-0.5"}, SettingValue{std::vector<double>{1.0, -0.5}}},
      {"[4294967346]", {option + "=4294967346"}, SettingValue{std::vector<double>{4294967346.0}}},
      {"[nan]", {option + "=nan"}, std::nullopt},
      {"[1, inf]", {option + "=1,inf"}, std::nullopt},
      {"[\"one\"]", {option + "=one"}, std::nullopt},
  };
}

TEST(FilterTable, ThreeSourcesTakeAndRefuseTheSame) {
  for (const FilterSetting& setting : filter_table()) {
    const std::vector<Asked> all = std::visit(
        [&]<typename T>(const SettingMember<T>&) {
          if constexpr (std::is_same_v<T, bool>)
            return flags(setting);
          else if constexpr (std::is_integral_v<T>)
            return whole_numbers<T>(setting);
          else if constexpr (std::is_same_v<T, double>)
            return numbers(setting);
          else if constexpr (std::is_same_v<T, std::string>)
            return texts(setting);
          else
            return lists(setting);
        },
        setting.member);
    for (const Asked& asked : all) expect_same(setting, asked);
  }
}

// The table of filter settings, and that what reads by it agrees: the configuration, the model file, the
// example.

TEST(FilterTable, WhatOneSourceSaysStandsOverAnother) {
  FilterChoice above, below;
  above.window = 9;
  below.window = 8;
  below.floor = 0.5;
  const FilterChoice both = over(above, below);
  EXPECT_EQ(both.window, 9);
  EXPECT_EQ(both.floor, 0.5);
  EXPECT_FALSE(both.draws.has_value());
  const FilterSettings in_force = settings_in_force(both, FilterSettings{});
  EXPECT_EQ(in_force.window, 9);
  EXPECT_EQ(in_force.floor, 0.5);
  EXPECT_EQ(in_force.draws, FilterSettings{}.draws);
}

// The example shows every key, with its default where it has one.
TEST(FilterTable, TheExampleShowsIt) {
  std::ifstream file(IFOG_SOURCE_DIR "/daemon/examples/reference.toml");
  ASSERT_TRUE(file);
  std::ostringstream text;
  text << file.rdbuf();
  const toml::table root = parse_toml(text.str(), "reference.toml");
  const toml::table* const filter = root["sensor"][0]["filter"].as_table();
  ASSERT_NE(filter, nullptr);
  std::set<std::string> shown;
  for (const auto& [key, node] : *filter) shown.emplace(key.str());
  const FilterSettings standard;
  // Noise has no default: what is shown is an example.
  const std::set<std::string> examples{"process_noise", "measurement_noise"};
  for (const FilterSetting& setting : filter_table()) {
    ASSERT_EQ(shown.erase(setting.key), 1U) << setting.key << " is not shown";
    const std::optional<SettingValue> value = setting_value(*filter->get(setting.key));
    ASSERT_TRUE(value.has_value()) << setting.key;
    FilterChoice choice;
    ASSERT_TRUE(choose(setting, *value, choice)) << setting.key;
    if (!examples.contains(setting.key)) {
      EXPECT_EQ(*value, value_of(setting, standard)) << setting.key;
    }
    // Its range and choices stand next to it.
    if (!setting.choices.empty() || setting.range.most < 1e9) {
      const std::size_t line = text.str().find("\n  " + std::string(setting.key) + " = ");
      ASSERT_NE(line, std::string::npos) << setting.key;
      const std::string row = text.str().substr(line + 1, text.str().find('\n', line + 1) - line - 1);
      EXPECT_TRUE(ifog::test::has(row, expected(setting))) << row << " lacks: " << expected(setting);
    }
  }
  shown.erase("start_up_s");  // of the daemon, not of the filter
  EXPECT_TRUE(shown.empty()) << *shown.begin() << " is in no table";
}

}  // namespace
