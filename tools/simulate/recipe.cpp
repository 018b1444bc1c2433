// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/recipe.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"

namespace ifog::simulate {
namespace {

constexpr double kMust = std::numeric_limits<double>::quiet_NaN();
constexpr double kAny = std::numeric_limits<double>::max();
constexpr double kTiny = std::numeric_limits<double>::min();

// Keys by their range.
Key any(const char* name, const char* unit, double fallback = kMust) {
  return {name, fallback, -kAny, kAny, unit};
}
Key positive(const char* name, const char* unit, double fallback = kMust) {
  return {name, fallback, kTiny, kAny, unit};
}
Key not_negative(const char* name, const char* unit, double fallback = kMust) {
  return {name, fallback, 0.0, kAny, unit};
}

}  // namespace

const std::vector<Kind>& channel_kinds() {
  static const std::vector<Kind> kKinds{
      {"constant", {any("level", "channel's")}},
      {"ramp", {any("from", "channel's"), any("to", "channel's")}},
      {"cycle",
       {any("level", "channel's", 0.0),
        any("amplitude", "channel's"),
        positive("period_s", "s"),
        {"phase", 0.0, -10.0, 10.0, "rad"}}},
      {"random_walk", {any("level", "channel's", 0.0), not_negative("per_root_s", "channel's/√s")}},
      {"gauss_markov",
       {any("level", "channel's", 0.0), not_negative("sigma", "channel's"), positive("correlation_s", "s")}},
      {"oven", {positive("dwell_s", "s"), positive("time_constant_s", "s")}, 0, {"levels"}},
      {"steps", {positive("dwell_s", "s")}, 0, {"levels"}},
      {"vibration",
       {any("level", "channel's", 0.0),
        not_negative("rms", "channel's"),
        positive("frequency_hz", "Hz"),
        {"damping", 0.05, 1e-4, 1.0, ""},
        not_negative("on_s", "s", 0.0),  // 0: always on
        not_negative("off_s", "s", 0.0)}},
      {"feedback_ramp",
       {{"modulus", 32768.0, 2.0, kAny, "counts"},
        any("counts_per_rad", "counts/rad"),
        not_negative("start", "counts", 0.0),
        any("counts_per_s", "counts/s", 0.0)}},
      {"angle", {any("start", "channel's", 0.0), positive("turn", "channel's a turn")}},
  };
  return kKinds;
}

const std::vector<Key>& channel_common() {
  static const std::vector<Key> kKeys{not_negative("noise", "channel's, each sample", 0.0),
                                      not_negative("resolution", "channel's", 0.0),
                                      not_negative("every_s", "s between new values, held between", 0.0),
                                      {"missing", 0.0, 0.0, 0.999, "fraction of the rows"}};
  return kKeys;
}

const std::vector<Kind>& motion_kinds() {
  static const std::vector<Kind> kKinds{
      {"rest", {any("rate_radps", "rad/s", 0.0)}},
      {"turns",
       {any("rate_radps", "rad/s"), positive("turn_s", "s"), not_negative("pause_s", "s"),
        not_negative("start_s", "s", 0.0), not_negative("edge_s", "s", 0.0)}},
      {"sine",
       {any("amplitude_radps", "rad/s"), positive("period_s", "s"), {"phase", 0.0, -10.0, 10.0, "rad"}}},
      {"rate_table", {positive("dwell_s", "s"), not_negative("edge_s", "s", 0.0)}, 0, {"rates_radps"}},
      {"steps", {positive("dwell_s", "s"), not_negative("sigma_radps", "rad/s")}},
      {"random", {not_negative("sigma_radps", "rad/s"), positive("correlation_s", "s")}},
  };
  return kKinds;
}

const std::vector<Kind>& effect_kinds() {
  static const Key kCoefficient = any("coefficient", "rad/s per unit");
  static const Key kReference = any("reference", "channel's", 0.0);
  static const Key kTime = not_negative("time_constant_s", "s");
  static const std::vector<Kind> kKinds{
      {"linear", {kCoefficient, kReference}, 1},
      {"quadratic", {kCoefficient, kReference}, 1},
      {"cubic", {kCoefficient, kReference}, 1},
      {"quintic", {kCoefficient, kReference}, 1},
      {"septic", {kCoefficient, kReference}, 1},
      {"absolute", {kCoefficient, kReference}, 1},
      {"dead_zone", {kCoefficient, not_negative("half_width", "channel's")}, 1},
      {"cosine", {kCoefficient, positive("period", "channel's")}, 1},
      {"sine", {kCoefficient, positive("period", "channel's")}, 1},
      {"earth_rate",
       {{"latitude_deg", kMust, -90.0, 90.0, "°"}, {"heading_deg", kMust, -360.0, 360.0, "°"}},
       1},
      {"rate", {kCoefficient, not_negative("time_constant_s", "s", 0.0)}, 1},
      {"second_rate", {kCoefficient, kTime}, 1},
      {"lagged", {kCoefficient, kReference, kTime, not_negative("second_s", "s", 0.0)}, 1},
      {"lookup",
       {not_negative("period", "channel's", 0.0), {"angle", 0.0, 0.0, 1.0, "1: values in rad"}},
       1,
       {"x", "values"}},
      {"product",
       {kCoefficient,
        kReference,
        any("with_reference", "channel's", 0.0),
        {"power", 1.0, 1.0, 9.0, ""},
        {"with_power", 1.0, 1.0, 9.0, ""}},
       2},
      {"band_power", {kCoefficient, kTime, not_negative("mean_s", "s", 0.0)}, 1},
      {"backlash", {kCoefficient, not_negative("width", "channel's")}, 1},
      {"line",
       {any("amplitude_radps", "rad/s"),
        not_negative("frequency_hz", "Hz"),
        {"phase", 0.0, -10.0, 10.0, "rad"},
        any("hz_per_radps", "Hz/(rad/s)", 0.0)}},
      {"step", {any("size_radps", "rad/s"), any("at_s", "s")}},
      {"rate_ramp", {any("slope_radps2", "rad/s²")}},
      {"warm_up", {any("size_radps", "rad/s"), positive("time_constant_s", "s")}},
      {"gauss_markov", {not_negative("sigma_radps", "rad/s"), positive("correlation_s", "s")}},
      {"outliers", {{"fraction", kMust, 0.0, 1.0, "of the samples"}, not_negative("size_radps", "rad/s")}},
      {"noise_change",
       {not_negative("N", "rad/s/√Hz, added"), any("from_s", "s", 0.0), any("to_s", "s", kAny)}},
      {"quantisation", {not_negative("angle_rad", "rad", 0.0), not_negative("rate_radps", "rad/s", 0.0)}},
  };
  return kKinds;
}

namespace {

template <typename Named>
std::vector<std::string_view> names_of(const std::vector<Named>& all) {
  std::vector<std::string_view> names;
  for (const Named& each : all) names.emplace_back(each.name);
  return names;
}

// Checks names and ranges of all numbers and fills in defaults.
void complete_numbers(Recipe& recipe, const std::vector<Key>& keys) {
  for (const auto& [name, value] : recipe.number) {
    const auto key = std::ranges::find_if(keys, [&n = name](const Key& k) { return n == k.name; });
    if (key == keys.end())
      throw std::invalid_argument("key " + in_quotes(name) + " is unknown for " + recipe.kind +
                                  meant_or_known(name, names_of(keys)));
    if (!(value >= key->low && value <= key->high))
      throw std::invalid_argument(
          name + " is " + std::to_string(value) + ", expected " +
          (key->low > 0.0 && key->low < 1e-300 ? "more than 0" : "at least " + std::to_string(key->low)) +
          (key->high < 1e300 ? " and at most " + std::to_string(key->high) : ""));
  }
  for (const Key& key : keys) {
    if (recipe.number.count(key.name) != 0) continue;
    if (std::isnan(key.fallback))
      throw std::invalid_argument("key " + in_quotes(std::string(key.name)) + " is missing for " +
                                  recipe.kind + ", expected a number" +
                                  (*key.unit != '\0' ? " (" + std::string(key.unit) + ")" : ""));
    recipe.number[key.name] = key.fallback;
  }
}

void check_lists(const Recipe& recipe, const Kind& kind) {
  for (const auto& [name, values] : recipe.list) {
    if (std::ranges::none_of(kind.lists, [&n = name](const char* l) { return n == l; }))
      throw std::invalid_argument("key " + in_quotes(name) + " is unknown for " + recipe.kind);
    if (values.empty()) throw std::invalid_argument(name + " is empty, expected numbers");
  }
  for (const char* list : kind.lists)
    if (recipe.list.count(list) == 0)
      throw std::invalid_argument("key " + in_quotes(std::string(list)) + " is missing for " + recipe.kind +
                                  ", expected a list of numbers");
}

void check_channels(const Recipe& recipe, const Kind& kind) {
  const auto check = [&](const char* key, const std::string& name, bool known, bool required) {
    const std::string what = std::string("key '") + key + "' is ";
    if (required && name.empty())
      throw std::invalid_argument(what + "missing for " + recipe.kind +
                                  ", expected a channel's name, or 'rate'");
    if (!known && !name.empty()) throw std::invalid_argument(what + "unknown for " + recipe.kind);
  };
  check("channel", recipe.channel, kind.channels >= 1, kind.channels >= 1);
  check("minus_channel", recipe.minus_channel, kind.channels >= 1, false);
  check("with_channel", recipe.with_channel, kind.channels >= 2, kind.channels >= 2);
}

}  // namespace

Recipe completed(Recipe recipe, const std::vector<Kind>& kinds, const std::vector<Key>& common) {
  const auto kind = std::ranges::find_if(kinds, [&](const Kind& k) { return recipe.kind == k.name; });
  if (kind == kinds.end())
    throw std::invalid_argument(in_quotes(recipe.kind) + " is unknown" +
                                meant_or_known(recipe.kind, names_of(kinds)));
  std::vector<Key> keys = kind->keys;
  keys.insert(keys.end(), common.begin(), common.end());
  complete_numbers(recipe, keys);
  check_lists(recipe, *kind);
  check_channels(recipe, *kind);
  if (recipe.kind == "lookup") {
    const auto& x = recipe.list.at("x");
    if (x.size() != recipe.list.at("values").size() || x.size() < 2 || !std::ranges::is_sorted(x) ||
        std::ranges::adjacent_find(x) != x.end())
      throw std::invalid_argument(
          "x and values of a lookup must be equally long, two at least, and x increasing");
  }
  return recipe;
}

}  // namespace ifog::simulate
