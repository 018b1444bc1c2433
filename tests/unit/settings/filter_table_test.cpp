// SPDX-License-Identifier: Apache-2.0
// The table of filter settings, and that what reads by it agrees: the configuration, the model file, the
// example.
#include "filters/settings/filter_table.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "filters/model_file/model.h"
#include "filters/model_file/toml_file.h"

namespace {

using namespace ifog;

TEST(FilterTable, AModelFileKeepsEverySetting) {
  Model model;
  model.filter = FilterSettings{};
  model.filter->rule = "vb";
  model.filter->state = "gauss-markov";
  model.filter->weights = "uniform";
  model.filter->process_noise = 1e-15;
  model.filter->measurement_noise = 2e-9;
  model.filter->state_parameters = {300.0};
  model.filter->window = 77;
  model.filter->draws = 3;
  model.filter->floor = 0.25;
  model.filter->follow_manoeuvres = false;
  model.filter->conserve_angle = false;
  model.filter->wideband = "noise";
  model.filter->steady_gain = false;
  model.filter->guard = false;
  model.filter->plain = true;
  model.filter->seed = 5;
  const Model back = parse_model(model_text(model), "f");
  ASSERT_TRUE(back.filter.has_value());
  const FilterSettings standard;
  for (const FilterSetting& setting : filter_table()) {
    EXPECT_EQ(value_of(setting, *back.filter), value_of(setting, *model.filter)) << setting.key;
    EXPECT_NE(value_of(setting, *back.filter), value_of(setting, standard)) << setting.key;
  }
}

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
      EXPECT_NE(row.find(expected(setting)), std::string::npos) << row << " lacks: " << expected(setting);
    }
  }
  shown.erase("start_up_s");  // of the daemon, not of the filter
  EXPECT_TRUE(shown.empty()) << *shown.begin() << " is in no table";
}

}  // namespace
