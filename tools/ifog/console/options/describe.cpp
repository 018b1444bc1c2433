// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/options/parser_texts.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

namespace ifog::tools {
namespace {

using Json = nlohmann::ordered_json;

// The choices in "auto|candump|bytes"; value names are in capitals.
std::vector<std::string> choices_of(std::string_view value) {
  std::vector<std::string> words;
  const auto capital = [](char c) { return c >= 'A' && c <= 'Z'; };
  if (value.find('|') == std::string_view::npos || std::any_of(value.begin(), value.end(), capital))
    return words;
  while (!value.empty()) {
    const std::size_t end = value.find('|');
    words.emplace_back(value.substr(0, end));
    value = end == std::string_view::npos ? std::string_view{} : value.substr(end + 1);
  }
  return words;
}

Json option_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  // A flag takes no value and has no type.
  const std::string value = option.get_items_expected_max() > 0 ? option.get_type_name() : "";
  return {{"names", names},
          {"positional", option.get_positional() ? option.get_name(true) : ""},
          {"value", value},
          {"choices", choices_of(value)},
          {"default", option.get_default_str()},
          {"required", option.get_required()},
          {"repeats", option.get_items_expected_max() > 1},
          {"group", option.get_group()},
          {"help", option.get_description()}};
}

Json options_of(const CLI::App& app) {
  Json options = Json::array();
  for (const CLI::Option* const option : app.get_options())
    if (!option->get_group().empty())
      options.push_back(option_of(*option));  // no group: hidden in --help too
  return options;
}

}  // namespace

std::string describe(const CLI::App& app) {
  Json commands = Json::array();
  for (const CLI::App* const command : app.get_subcommands({}))
    commands.push_back({{"name", command->get_name()},
                        {"help", command->get_description()},
                        {"examples", command->get_footer()},
                        {"options", options_of(*command)}});
  const Json all = {{"schema", "ifog.command_line/1"},
                    {"name", app.get_name()},
                    {"version", app.version().substr(0, app.version().find('\n'))},
                    {"help", app.get_description()},
                    {"options", options_of(app)},
                    {"commands", commands}};
  return all.dump(2) + "\n";
}

}  // namespace ifog::tools
