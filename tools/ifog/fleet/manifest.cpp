// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/manifest.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>

#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"
#include "filters/model_file/toml_file.h"

namespace ifog::tools {
namespace {

constexpr std::size_t kLongestName = 64;

[[noreturn]] void fail(const std::string& path, const toml::source_region& where, const std::string& what) {
  throw std::runtime_error(path + ":" + std::to_string(where.begin.line) + ": " + what);
}

void refuse_unknown(const std::string& path, const toml::table& table,
                    std::initializer_list<std::string_view> known, const char* expected) {
  for (const auto& [key, value] : table)
    if (std::find(known.begin(), known.end(), key.str()) == known.end())
      fail(path, key.source(), "key " + in_quotes(key.str()) + " is unknown, expected " + expected);
}

std::string words(const std::string& path, const toml::table& table, const char* key, const char* expected) {
  const toml::node* const node = table.get(key);
  if (node == nullptr) fail(path, table.source(), std::string(key) + " is missing, expected " + expected);
  const auto value = node->value_exact<std::string>();
  if (!value || value->empty())
    fail(path, node->source(),
         std::string(key) + (value ? " is empty" : " is no text") + ", expected " + expected);
  return *value;
}

std::string serial_of(const std::string& path, const toml::table& table) {
  constexpr const char* kExpected =
      "up to 64 letters, digits, '.', '_' and '-', the first a letter, digit or '_'";
  std::string serial = words(path, table, "serial", kExpected);
  const bool plain = std::all_of(serial.begin(), serial.end(), [](unsigned char c) {
    return (c < 0x80 && std::isalnum(c) != 0) || c == '.' || c == '_' || c == '-';
  });
  if (!plain || serial.front() == '.' || serial.front() == '-' || serial.size() > kLongestName)
    fail(path, table.get("serial")->source(), "serial = " + in_quotes(serial) + ", expected " + kExpected);
  return serial;
}

// As it opens, relative to the manifest. "." goes, ".." does not: behind a link it leads elsewhere.
std::string path_beside(const std::string& manifest, const std::string& name) {
  std::filesystem::path beside;
  for (const std::filesystem::path& part : std::filesystem::path(manifest).parent_path() / name)
    if (part != ".") beside /= part;
  return beside == "-" || beside.empty() ? "./" + beside.string()
                                         : beside.string();  // no standard input here
}

// One name for a file however it is reached.
std::string true_path(const std::string& path) {
  std::error_code error;
  const std::filesystem::path found = std::filesystem::weakly_canonical(path, error);
  return error ? path : found.string();
}

// taken: by true path, the serial that has it.
std::vector<std::string> captures_of(const std::string& path, const toml::table& table,
                                     const std::string& serial, std::map<std::string, std::string>& taken) {
  const toml::node* const node = table.get("captures");
  if (node == nullptr) fail(path, table.source(), "captures is missing, expected a list of paths");
  const toml::array* const list = node->as_array();
  if (list == nullptr || list->empty())
    fail(path, node->source(), "captures is no list with a path in it, expected a list of paths");
  std::vector<std::string> captures;
  for (const toml::node& item : *list) {
    const auto name = item.value_exact<std::string>();
    if (!name || name->empty() || name->find('\0') != std::string::npos)
      fail(path, item.source(), "captures holds what is no path, expected a list of paths");
    captures.push_back(path_beside(path, *name));
    const auto [of, first] = taken.emplace(true_path(captures.back()), serial);
    if (!first)
      fail(path, item.source(),
           "captures holds " + in_quotes(*name) + ", which is a capture of " + in_quotes(of->second) +
               " already, expected each once");
  }
  return captures;
}

}  // namespace

Manifest read_manifest(const std::string& path) { return parse_manifest(read_toml_text(path), path); }

Manifest parse_manifest(std::string_view text, const std::string& path) {
  const toml::table table = parse_toml(text, path);
  refuse_unknown(path, table, {"type", "gyro"}, "type or [[gyro]]");
  Manifest manifest;
  manifest.type = words(path, table, "type", "the name of the type");
  const toml::node* const node = table.get("gyro");
  const toml::array* const gyros = node == nullptr ? nullptr : node->as_array();
  if (gyros == nullptr || gyros->empty())
    throw std::runtime_error(path + ": gyro is missing, expected a [[gyro]] for each");
  std::set<std::string> names;
  std::map<std::string, std::string> taken;
  for (const toml::node& item : *gyros) {
    const toml::table* const gyro = item.as_table();
    if (gyro == nullptr) fail(path, item.source(), "gyro holds what is no table, expected [[gyro]]");
    refuse_unknown(path, *gyro, {"serial", "captures"}, "serial or captures");
    FleetGyro each;
    each.serial = serial_of(path, *gyro);
    std::string name = each.serial;
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    if (!names.insert(name).second)
      fail(path, gyro->source(), "serial = " + in_quotes(each.serial) + " stands twice, expected once");
    each.captures = captures_of(path, *gyro, each.serial, taken);
    if (taken.size() > kInputLimits.captures)
      fail(path, gyro->source(), "more than " + std::to_string(kInputLimits.captures) + " captures");
    manifest.gyros.push_back(std::move(each));
  }
  return manifest;
}

}  // namespace ifog::tools
