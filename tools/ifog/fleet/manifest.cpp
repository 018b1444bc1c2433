// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/manifest.h"

#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>

#include "daemon/config/table_reader.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"
#include "filters/model_file/toml_file.h"

namespace ifog::tools {
namespace {

constexpr std::size_t kLongestName = 64;

constexpr const char* kSerial =
    "up to 64 letters, digits, '.', '_' and '-', the first a letter, digit or '_'";

bool is_serial(const std::string& text) {
  return text.size() <= kLongestName && text.front() != '.' && text.front() != '-' &&
         std::ranges::all_of(text, [](unsigned char c) {
           return (c < 0x80 && std::isalnum(c) != 0) || c == '.' || c == '_' || c == '-';
         });
}

// Path relative to the manifest. "." is removed, ".." is not, because after a link it leads elsewhere.
std::string path_next_to(const std::string& manifest, const std::string& name) {
  std::filesystem::path there;
  for (const std::filesystem::path& part : std::filesystem::path(manifest).parent_path() / name)
    if (part != ".") there /= part;
  return there == "-" || there.empty() ? "./" + there.string() : there.string();  // no standard input
}

// Canonical path, equal for all paths to a file.
std::string true_path(const std::string& path) {
  std::error_code error;
  const std::filesystem::path found = std::filesystem::weakly_canonical(path, error);
  return error ? path : found.string();
}

}  // namespace

Manifest read_manifest(const std::string& path) { return parse_manifest(read_toml_text(path), path); }

Manifest parse_manifest(std::string_view text, const std::string& path) {
  const toml::table table = parse_toml(text, path);
  std::vector<std::string> errors;
  TableReader in(table, "", path, errors);
  Manifest manifest;
  manifest.type = in.required_text("type", "the name of the type");
  std::set<std::string> names;
  std::map<std::string, std::string> owners;  // serials, by the canonical paths of their captures
  if (!in.has("gyro")) in.complain("gyro", ": missing; expected a [[gyro]] for each");
  for (const toml::table* const gyro : in.tables("gyro")) {
    TableReader of(*gyro, "gyro", path, errors);
    FleetGyro each;
    each.serial = of.required_text("serial", kSerial);
    const std::string name = boost::to_lower_copy(each.serial);
    if (!name.empty() && !is_serial(name))
      of.complain("serial", " = " + in_quotes(each.serial) + ": expected " + kSerial);
    else if (!names.insert(name).second)
      of.complain("serial", " = " + in_quotes(each.serial) + ": stands twice, expected once");
    const auto captures = of.texts("captures");
    if (!captures || captures->empty()) of.complain("captures", ": expected a list of paths");
    for (const std::string& capture : captures.value_or(std::vector<std::string>())) {
      if (capture.empty() || capture.find('\0') != std::string::npos)
        of.complain("captures", " holds " + in_quotes(capture) + ": expected a list of paths");
      each.captures.push_back(path_next_to(path, capture));
      const auto [owner, first] = owners.emplace(true_path(each.captures.back()), each.serial);
      if (!first)
        of.complain("captures", " holds " + in_quotes(capture) + ", which is a capture of " +
                                    in_quotes(owner->second) + " already: expected each once");
    }
    of.refuse_the_rest();
    if (owners.size() > kInputLimits.captures)
      of.complain("captures", ": more than " + std::to_string(kInputLimits.captures) + " in all");
    manifest.gyros.push_back(std::move(each));
  }
  in.refuse_the_rest();
  if (!errors.empty()) throw std::runtime_error(errors.front());
  return manifest;
}

}  // namespace ifog::tools
