// SPDX-License-Identifier: Apache-2.0
// ifog drivers: the protocol plugins with folder and options, and the rejected ones with the reason.
#include <algorithm>
#include <cstring>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/host/plugin.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

std::string transports(const ifog_driver& table) {
  std::string text;
  if ((table.transports & IFOG_TRANSPORT_BYTES) != 0) text += "bytes";
  if ((table.transports & IFOG_TRANSPORT_CAN) != 0) text += text.empty() ? "CAN" : ", CAN";
  if (table.encode_bytes != nullptr || table.encode_can != nullptr) text += ", encodes";
  return text;
}

std::span<const ifog_option> options_of(const ifog_driver& table) {
  const ifog_option* end = table.options;
  while (end->key != nullptr) ++end;
  return {table.options, end};
}

void print_driver(const FoundPlugin& found) {
  const ifog_driver& table = found.plugin->table();
  say("{} {}: {}\n  takes {}; interface version {}\n  {}{}\n", table.name, table.version, table.summary,
      transports(table), table.abi, found.path,
      found.hidden ? "  (not used: a folder before this one has a driver of this name)" : "");
  std::size_t width = 0;
  for (const ifog_option& option : options_of(table)) width = std::max(width, std::strlen(option.key));
  for (const ifog_option& option : options_of(table)) {
    const std::string standard = option.default_value == nullptr ? "must be given"
                                 : *option.default_value == '\0'
                                     ? "default none"
                                     : std::string("default ") + option.default_value;
    say("    {:<{}}  {}\n    {:<{}}  {}; {}\n", option.key, width, option.help, "", width, option.values,
        standard);
  }
  say("\n");
}

nlohmann::ordered_json driver_json(const FoundPlugin& found) {
  const ifog_driver& table = found.plugin->table();
  auto options = nlohmann::ordered_json::array();
  for (const ifog_option& option : options_of(table)) {
    nlohmann::ordered_json standard;  // null: required
    if (option.default_value != nullptr) standard = option.default_value;
    options.push_back(
        {{"key", option.key}, {"help", option.help}, {"values", option.values}, {"default", standard}});
  }
  return {{"name", table.name},
          {"version", table.version},
          {"summary", table.summary},
          {"interface", table.abi},
          {"takes_bytes", (table.transports & IFOG_TRANSPORT_BYTES) != 0},
          {"takes_can", (table.transports & IFOG_TRANSPORT_CAN) != 0},
          {"encodes", table.encode_bytes != nullptr || table.encode_can != nullptr},
          {"path", found.path},
          {"used", !found.hidden},
          {"options", options}};
}

void write_drivers(const std::string& path, const std::vector<FoundPlugin>& all,
                   const std::vector<std::string>& folders) {
  auto drivers = nlohmann::ordered_json::array(), refused = nlohmann::ordered_json::array();
  for (const FoundPlugin& found : all)
    if (found.plugin)
      drivers.push_back(driver_json(found));
    else
      refused.push_back({{"path", found.path}, {"reason", found.refusal}});
  write_json(
      path,
      nlohmann::ordered_json{
          {"schema", "ifog.drivers/1"}, {"drivers", drivers}, {"refused", refused}, {"folders", folders}});
}

void run_drivers(const std::string& name, const std::string& json) {
  const std::vector<std::string> folders = plugin_folders();
  std::vector<FoundPlugin> all;
  if (!name.empty()) {
    all.emplace_back().plugin = find_plugin(name, folders);
    all.back().path = all.back().plugin->path();
  } else {
    all = list_plugins(folders);
  }
  write_drivers(json, all, folders);
  if (!name.empty()) {
    print_driver(all.front());
    return;
  }
  std::size_t usable = 0;
  for (const FoundPlugin& found : all) {
    if (!found.plugin) continue;
    ++usable;
    print_driver(found);
  }
  for (const FoundPlugin& found : all)
    if (!found.plugin) say("refused: {}\n", found.refusal);
  say("looked in{}\n", folders.empty() ? " no folder: none of those in question exists" : ":");
  for (const std::string& folder : folders) say("  {}\n", folder);
  if (usable == 0) throw std::runtime_error("no driver found; IFOG_PLUGIN_PATH may name folders to look in");
}

}  // namespace

void add_drivers(const Command& program) {
  auto name = std::make_shared<std::string>(), json = std::make_shared<std::string>();
  const Command command =
      program.add_subcommand("drivers", "List the protocol drivers found, their options, and refused ones");
  command.add_option("NAME", *name, "Only this driver");
  command.add_option("--json", *json, "Write the list here", kWritesJson);
  command.callback([name, json] { run_drivers(*name, *json); });
}

}  // namespace ifog::tools
