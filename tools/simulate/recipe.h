// SPDX-License-Identifier: Apache-2.0
// The parts of a scenario are recipes: a kind, numbers by name, lists by name, and the channel it works on.
// Which keys a kind takes, their defaults and ranges are tables here, so that reading a file, drawing values,
// the truth file and the error messages all go by one definition.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace ifog::simulate {

struct Recipe {
  std::string kind;  // a channel's shape, an effect's form, a motion's kind
  std::string name;  // of a channel: its column
  std::string axis;  // "" all axes
  // "rate": the true rate of the axis, "rate_y" that of axis y; minus_channel is subtracted from `channel`.
  std::string channel, with_channel, minus_channel;
  std::map<std::string, double> number;
  std::map<std::string, std::vector<double>> list;

  [[nodiscard]] double operator[](const std::string& key) const { return number.at(key); }
};

struct Key {
  const char* name;
  double fallback;  // NaN: must be given
  double low, high;
  const char* unit;
};

struct Kind {
  const char* name;
  std::vector<Key> keys;
  std::vector<const char*> lists;  // all must be given
  int channels = 0;                // effects: 0 none, 1 `channel`, 2 also `with_channel`
};

[[nodiscard]] const std::vector<Kind>& channel_kinds();
[[nodiscard]] const std::vector<Key>& channel_common();  // keys that every channel takes
[[nodiscard]] const std::vector<Kind>& motion_kinds();
[[nodiscard]] const std::vector<Kind>& effect_kinds();

// A recipe with every default filled in. Throws std::invalid_argument naming what is unknown, missing or out
// of range.
[[nodiscard]] Recipe completed(Recipe recipe, const std::vector<Kind>& kinds,
                               const std::vector<Key>& common = {});

}  // namespace ifog::simulate
