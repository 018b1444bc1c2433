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

}  // namespace

const std::vector<Kind>& channel_kinds() {
  static const std::vector<Kind> kKinds{
      {"constant", {{"level", kMust, -kAny, kAny, "channel's"}}, {}},
      {"ramp", {{"from", kMust, -kAny, kAny, "channel's"}, {"to", kMust, -kAny, kAny, "channel's"}}, {}},
      {"cycle",
       {{"level", 0.0, -kAny, kAny, "channel's"},
        {"amplitude", kMust, -kAny, kAny, "channel's"},
        {"period_s", kMust, kTiny, kAny, "s"},
        {"phase", 0.0, -10.0, 10.0, "rad"}},
       {}},
      {"random_walk",
       {{"level", 0.0, -kAny, kAny, "channel's"}, {"per_root_s", kMust, 0.0, kAny, "channel's/√s"}},
       {}},
      {"gauss_markov",
       {{"level", 0.0, -kAny, kAny, "channel's"},
        {"sigma", kMust, 0.0, kAny, "channel's"},
        {"correlation_s", kMust, kTiny, kAny, "s"}},
       {}},
      {"oven",
       {{"dwell_s", kMust, kTiny, kAny, "s"}, {"time_constant_s", kMust, kTiny, kAny, "s"}},
       {"levels"}},
      {"steps", {{"dwell_s", kMust, kTiny, kAny, "s"}}, {"levels"}},
      {"vibration",
       {{"level", 0.0, -kAny, kAny, "channel's"},
        {"rms", kMust, 0.0, kAny, "channel's"},
        {"frequency_hz", kMust, kTiny, kAny, "Hz"},
        {"damping", 0.05, 1e-4, 1.0, ""},
        {"on_s", 0.0, 0.0, kAny, "s"},  // 0: always on
        {"off_s", 0.0, 0.0, kAny, "s"}},
       {}},
      {"feedback_ramp",
       {{"modulus", 32768.0, 2.0, kAny, "counts"},
        {"counts_per_rad", kMust, -kAny, kAny, "counts/rad"},
        {"start", 0.0, 0.0, kAny, "counts"},
        {"counts_per_s", 0.0, -kAny, kAny, "counts/s"}},
       {}},
      {"angle",
       {{"start", 0.0, -kAny, kAny, "channel's"}, {"turn", kMust, kTiny, kAny, "channel's a turn"}},
       {}},
  };
  return kKinds;
}

const std::vector<Key>& channel_common() {
  static const std::vector<Key> kKeys{{"noise", 0.0, 0.0, kAny, "channel's, each sample"},
                                      {"resolution", 0.0, 0.0, kAny, "channel's"},
                                      {"every_s", 0.0, 0.0, kAny, "s between new values, held between"},
                                      {"missing", 0.0, 0.0, 0.999, "fraction of the rows"}};
  return kKeys;
}

const std::vector<Kind>& motion_kinds() {
  static const std::vector<Kind> kKinds{
      {"rest", {{"rate_radps", 0.0, -kAny, kAny, "rad/s"}}, {}},
      {"turns",
       {{"rate_radps", kMust, -kAny, kAny, "rad/s"},
        {"turn_s", kMust, kTiny, kAny, "s"},
        {"pause_s", kMust, 0.0, kAny, "s"},
        {"start_s", 0.0, 0.0, kAny, "s"},
        {"edge_s", 0.0, 0.0, kAny, "s"}},
       {}},
      {"sine",
       {{"amplitude_radps", kMust, -kAny, kAny, "rad/s"},
        {"period_s", kMust, kTiny, kAny, "s"},
        {"phase", 0.0, -10.0, 10.0, "rad"}},
       {}},
      {"rate_table",
       {{"dwell_s", kMust, kTiny, kAny, "s"}, {"edge_s", 0.0, 0.0, kAny, "s"}},
       {"rates_radps"}},
      {"steps", {{"dwell_s", kMust, kTiny, kAny, "s"}, {"sigma_radps", kMust, 0.0, kAny, "rad/s"}}, {}},
      {"random",
       {{"sigma_radps", kMust, 0.0, kAny, "rad/s"}, {"correlation_s", kMust, kTiny, kAny, "s"}},
       {}},
  };
  return kKinds;
}

const std::vector<Kind>& effect_kinds() {
  static const Key kCoefficient{"coefficient", kMust, -kAny, kAny, "rad/s per unit"};
  static const Key kReference{"reference", 0.0, -kAny, kAny, "channel's"};
  static const Key kTime{"time_constant_s", kMust, 0.0, kAny, "s"};
  static const std::vector<Kind> kKinds{
      {"linear", {kCoefficient, kReference}, {}, 1},
      {"quadratic", {kCoefficient, kReference}, {}, 1},
      {"cubic", {kCoefficient, kReference}, {}, 1},
      {"quintic", {kCoefficient, kReference}, {}, 1},
      {"septic", {kCoefficient, kReference}, {}, 1},
      {"absolute", {kCoefficient, kReference}, {}, 1},
      {"dead_zone", {kCoefficient, {"half_width", kMust, 0.0, kAny, "channel's"}}, {}, 1},
      {"cosine", {kCoefficient, {"period", kMust, kTiny, kAny, "channel's"}}, {}, 1},
      {"sine", {kCoefficient, {"period", kMust, kTiny, kAny, "channel's"}}, {}, 1},
      {"earth_rate",
       {{"latitude_deg", kMust, -90.0, 90.0, "°"}, {"heading_deg", kMust, -360.0, 360.0, "°"}},
       {},
       1},
      {"rate", {kCoefficient, {"time_constant_s", 0.0, 0.0, kAny, "s"}}, {}, 1},
      {"second_rate", {kCoefficient, kTime}, {}, 1},
      {"lagged", {kCoefficient, kReference, kTime, {"second_s", 0.0, 0.0, kAny, "s"}}, {}, 1},
      {"lookup",
       {{"period", 0.0, 0.0, kAny, "channel's"}, {"angle", 0.0, 0.0, 1.0, "1: values in rad"}},
       {"x", "values"},
       1},
      {"product",
       {kCoefficient,
        kReference,
        {"with_reference", 0.0, -kAny, kAny, "channel's"},
        {"power", 1.0, 1.0, 9.0, ""},
        {"with_power", 1.0, 1.0, 9.0, ""}},
       {},
       2},
      {"band_power", {kCoefficient, kTime, {"mean_s", 0.0, 0.0, kAny, "s"}}, {}, 1},
      {"backlash", {kCoefficient, {"width", kMust, 0.0, kAny, "channel's"}}, {}, 1},
      {"line",
       {{"amplitude_radps", kMust, -kAny, kAny, "rad/s"},
        {"frequency_hz", kMust, 0.0, kAny, "Hz"},
        {"phase", 0.0, -10.0, 10.0, "rad"},
        {"hz_per_radps", 0.0, -kAny, kAny, "Hz/(rad/s)"}},
       {}},
      {"step", {{"size_radps", kMust, -kAny, kAny, "rad/s"}, {"at_s", kMust, -kAny, kAny, "s"}}, {}},
      {"rate_ramp", {{"slope_radps2", kMust, -kAny, kAny, "rad/s²"}}, {}},
      {"warm_up",
       {{"size_radps", kMust, -kAny, kAny, "rad/s"}, {"time_constant_s", kMust, kTiny, kAny, "s"}},
       {}},
      {"gauss_markov",
       {{"sigma_radps", kMust, 0.0, kAny, "rad/s"}, {"correlation_s", kMust, kTiny, kAny, "s"}},
       {}},
      {"outliers",
       {{"fraction", kMust, 0.0, 1.0, "of the samples"}, {"size_radps", kMust, 0.0, kAny, "rad/s"}},
       {}},
      {"noise_change",
       {{"N", kMust, 0.0, kAny, "rad/s/√Hz, added"},
        {"from_s", 0.0, -kAny, kAny, "s"},
        {"to_s", kAny, -kAny, kAny, "s"}},
       {}},
      {"quantisation", {{"angle_rad", 0.0, 0.0, kAny, "rad"}, {"rate_radps", 0.0, 0.0, kAny, "rad/s"}}, {}},
  };
  return kKinds;
}

namespace {

// Checks names and ranges of all numbers and fills in defaults.
void complete_numbers(Recipe& recipe, const std::vector<Key>& keys) {
  for (const auto& [name, value] : recipe.number) {
    const auto key = std::ranges::find_if(keys, [&n = name](const Key& k) { return n == k.name; });
    if (key == keys.end()) {
      std::vector<std::string_view> known;
      known.reserve(keys.size());
      for (const Key& k : keys) known.emplace_back(k.name);
      throw std::invalid_argument("key " + in_quotes(name) + " is unknown for " + recipe.kind +
                                  meant_or_known(name, known));
    }
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
  if (kind == kinds.end()) {
    std::vector<std::string_view> known;
    known.reserve(kinds.size());
    for (const Kind& k : kinds) known.emplace_back(k.name);
    throw std::invalid_argument(in_quotes(recipe.kind) + " is unknown" + meant_or_known(recipe.kind, known));
  }
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
