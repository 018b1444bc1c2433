// SPDX-License-Identifier: Apache-2.0
// Reads scenario files: strict TOML; errors are one line with file, line, key and expected value.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>

#include "drivers/capture/files/input_file.h"
#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"
#include "filters/model_file/toml_file.h"
#include "tools/simulate/simulator.h"

namespace ifog::simulate {
namespace {

constexpr std::uint32_t kDrawnStream = 900;  // one below the streams of the parts
constexpr std::uint32_t kDrawnLast = 999;

const char* type_name(const toml::node& node) {
  if (node.is_string()) return "a string";
  if (node.is_boolean()) return "true or false";
  if (node.is_table()) return "a table";
  if (node.is_array()) return "a list";
  if (node.is_number()) return "a number";
  return "a date";
}

constexpr std::array<std::string_view, 15> kKeys{
    "name",          "seed",         "sample_rate_hz", "duration_s",
    "axes",          "bias_radps",   "reference",      "reference_noise_radps",
    "time_jitter_s", "missing_rows", "gaps",           "noise",
    "channel",       "motion",       "effect"};

class Reader {
 public:
  explicit Reader(std::string path) : path_(std::move(path)) {}

  Scenario read(const std::uint64_t* other_seed) {
    const toml::table file = parse_toml(read_whole_file(path_), path_);
    // First, because all drawn numbers depend on it.
    if (const toml::node* node = file.get("seed")) {
      const auto seed = value<std::int64_t>(*node, "seed", "a whole number");
      if (seed < 0) fail(*node, "seed", "is " + std::to_string(seed) + ", expected at least 0");
      s_.seed = static_cast<std::uint64_t>(seed);
    }
    if (other_seed != nullptr) s_.seed = *other_seed;
    for (auto&& [key, node] : file) top(std::string(key.str()), node);
    if (file.get("duration_s") == nullptr) fail(file, "duration_s", "is missing, expected seconds");
    return std::move(s_);
  }

 private:
  [[noreturn]] void fail(const toml::node& node, const std::string& key, const std::string& what) const {
    const auto line = node.source().begin.line;
    throw std::runtime_error(path_ + (line > 0 ? ":" + std::to_string(line) : "") + ": " +
                             printable(key + " " + what, kLongestMessage));
  }

  template <typename T>
  T value(const toml::node& node, const std::string& key, const char* expected) const {
    const std::optional<T> found = node.value_exact<T>();
    if (!found) fail(node, key, std::string("is ") + type_name(node) + ", expected " + expected);
    return *found;
  }

  std::string string(const toml::node& node, const std::string& key) const {
    return value<std::string>(node, key, "a string");
  }

  bool flag(const toml::node& node, const std::string& key) const {
    return value<bool>(node, key, "true or false");
  }

  double plain(const toml::node& node, const std::string& key) const {
    const auto value = node.value<double>();
    if (!node.is_number() || !value)
      fail(node, key, std::string("is ") + type_name(node) + ", expected a number");
    if (!std::isfinite(*value)) fail(node, key, "is not finite, expected a number");
    return *value;
  }

  // A number as given, or drawn from a range.
  double number(const toml::node& node, const std::string& key) {
    const toml::table* range = node.as_table();
    if (range == nullptr) return plain(node, key);
    bool logarithmic = false, either = false;
    std::vector<double> ends;
    for (auto&& [name, value] : *range) {
      const std::string sub = key + "." + std::string(name.str());
      if (name.str() == "between")
        ends = list(value, sub);
      else if (name.str() == "log")
        logarithmic = flag(value, sub);
      else if (name.str() == "either_sign")
        either = flag(value, sub);
      else
        fail(value, sub, "is unknown, expected between, log or either_sign");
    }
    if (ends.size() != 2 || !(ends[0] <= ends[1]))
      fail(node, key, "is drawn, expected between = [low, high]");
    if (logarithmic && !(ends[0] > 0.0))
      fail(node, key, "is drawn with log = true, expected a range above 0");
    if (drawn_ > kDrawnLast - kDrawnStream)
      fail(node, key, "is one drawn number too many, expected at most 100");
    Draw draw(s_.seed, kDrawnStream + drawn_++);
    const double value = logarithmic ? draw.log_uniform(ends[0], ends[1]) : draw.uniform(ends[0], ends[1]);
    return either && draw.chance(0.5) ? -value : value;
  }

  std::vector<double> list(const toml::node& node, const std::string& key) const {
    const toml::array* array = node.as_array();
    if (array == nullptr)
      fail(node, key, std::string("is ") + type_name(node) + ", expected a list of numbers");
    std::vector<double> out;
    for (const toml::node& element : *array) out.push_back(plain(element, key));
    return out;
  }

  void top(const std::string& key, const toml::node& node) {
    if (key == "seed") return;
    if (key == "name")
      s_.name = string(node, key);
    else if (key == "sample_rate_hz")
      s_.sample_rate_hz = positive(node, key);
    else if (key == "duration_s")
      s_.duration_s = positive(node, key);
    else if (key == "axes")
      axes(node);
    else if (key == "bias_radps")
      s_.bias_radps = number(node, key);
    else if (key == "reference")
      s_.reference = flag(node, key);
    else if (key == "reference_noise_radps")
      s_.reference_noise_radps = not_negative(node, key);
    else if (key == "time_jitter_s")
      s_.time_jitter_s = not_negative(node, key);
    else if (key == "missing_rows")
      s_.missing_rows = fraction(node, key);
    else if (key == "gaps")
      gaps(node);
    else if (key == "noise")
      noise(node);
    else if (key == "channel")
      recipes(node, key, "shape", channel_kinds(), channel_common(), s_.channels);
    else if (key == "motion")
      recipes(node, key, "kind", motion_kinds(), {}, s_.motions);
    else if (key == "effect")
      recipes(node, key, "form", effect_kinds(), {}, s_.effects);
    else
      fail(node, key, "is unknown" + meant_or_known(key, kKeys));
  }

  double positive(const toml::node& node, const std::string& key) {
    const double value = number(node, key);
    if (!(value > 0.0)) fail(node, key, "is " + std::to_string(value) + ", expected more than 0");
    return value;
  }
  double not_negative(const toml::node& node, const std::string& key) {
    const double value = number(node, key);
    if (!(value >= 0.0)) fail(node, key, "is " + std::to_string(value) + ", expected at least 0");
    return value;
  }
  double fraction(const toml::node& node, const std::string& key) {
    const double value = not_negative(node, key);
    if (value >= 1.0) fail(node, key, "is " + std::to_string(value) + ", expected less than 1");
    return value;
  }

  void axes(const toml::node& node) {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->empty() || array->size() > 3)
      fail(node, "axes", "must be a list of one to three names");
    s_.axes.clear();
    std::set<std::string> seen;
    for (const toml::node& element : *array) {
      const std::string name = string(element, "axes");
      if (name.find_first_of("_, ") != std::string::npos || !seen.insert(name).second ||
          (name.empty() && array->size() > 1))
        fail(element, "axes",
             "has " + in_quotes(name) + ", expected different names without '_', ',' or blanks");
      s_.axes.push_back(name);
    }
  }

  void gaps(const toml::node& node) {
    const toml::array* array = node.as_array();
    if (array == nullptr)
      fail(node, "gaps", std::string("is ") + type_name(node) + ", expected [[from, to], …]");
    for (const toml::node& element : *array) {
      const std::vector<double> ends = list(element, "gaps");
      if (ends.size() != 2 || !(ends[0] < ends[1]))
        fail(element, "gaps", "expected pairs [from, to] in s, from before to");
      s_.gaps.emplace_back(ends[0], ends[1]);
    }
  }

  void noise(const toml::node& node) {
    const toml::table* table = node.as_table();
    if (table == nullptr) fail(node, "noise", std::string("is ") + type_name(node) + ", expected a table");
    static const std::map<std::string_view, double NoiseLevels::*> kLevels{{"Q", &NoiseLevels::Q},
                                                                           {"N", &NoiseLevels::N},
                                                                           {"B", &NoiseLevels::B},
                                                                           {"K", &NoiseLevels::K},
                                                                           {"R", &NoiseLevels::R}};
    for (auto&& [name, value] : *table) {
      const std::string key = "noise." + std::string(name.str());
      const auto level = kLevels.find(name.str());
      if (level == kLevels.end()) fail(value, key, "is unknown, expected Q, N, B, K or R");
      s_.noise.*level->second = name.str() == "R" ? number(value, key) : not_negative(value, key);
    }
  }

  void recipes(const toml::node& node, const std::string& what, const std::string& kind_key,
               const std::vector<Kind>& kinds, const std::vector<Key>& common, std::vector<Recipe>& out) {
    const toml::array* array = node.as_array();
    if (array == nullptr) fail(node, what, "is no list of tables, expected [[" + what + "]]");
    for (const toml::node& element : *array) {
      const toml::table* table = element.as_table();
      if (table == nullptr) fail(element, what, "is no list of tables, expected [[" + what + "]]");
      Recipe recipe;
      for (auto&& [name, value] : *table) {
        const std::string local(name.str());
        const std::string key = what + "." + local;
        if (local == kind_key)
          recipe.kind = string(value, key);
        else if (local == "name" && what == "channel")
          recipe.name = string(value, key);
        else if (local == "axis")
          recipe.axis = string(value, key);
        else if (local == "channel" && what == "effect")
          recipe.channel = string(value, key);
        else if (local == "minus_channel" && what == "effect")
          recipe.minus_channel = string(value, key);
        else if (local == "with_channel" && what == "effect")
          recipe.with_channel = string(value, key);
        else if (value.is_array())
          recipe.list[local] = list(value, key);
        else
          recipe.number[local] = number(value, key);
      }
      if (recipe.kind.empty()) fail(element, what, "has no " + kind_key);
      if (what == "channel") channel_name(element, recipe.name);
      try {
        out.push_back(completed(std::move(recipe), kinds, common));
      } catch (const std::invalid_argument& error) {
        fail(element, "[[" + what + "]]:", error.what());
      }
    }
  }

  void channel_name(const toml::node& node, const std::string& name) const {
    const bool in_use = std::ranges::any_of(s_.channels, [&](const Recipe& c) { return c.name == name; });
    if (name.empty() || name == "rate" || name == "time_s" ||
        name.find_first_of(", \"\n") != std::string::npos || name.find('_') == std::string::npos || in_use)
      fail(node, "channel.name", "is " + in_quotes(name) + ", expected NAME_UNIT, used once");
  }

  std::string path_;
  Scenario s_;
  std::uint32_t drawn_ = 0;
};

}  // namespace

Scenario read_scenario(const std::string& path, const std::uint64_t* seed) { return Reader(path).read(seed); }

}  // namespace ifog::simulate
