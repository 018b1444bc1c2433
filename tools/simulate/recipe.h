// SPDX-License-Identifier: Apache-2.0
// The parts of a scenario are recipes: a kind, numbers and lists by name, and a channel. Tables here define
// each kind's keys, defaults and ranges, for reading files, drawing values, the truth file and error
// messages.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace ifog::simulate {

struct Recipe {
  std::string kind;  // a channel's shape, an effect's form, a motion's kind
  std::string name;  // column of a channel
  std::string axis;  // "": all axes
  // "rate": the true rate of the axis, "rate_y" that of axis y; minus_channel is subtracted from `channel`.
  std::string channel, with_channel, minus_channel;
  std::map<std::string, double> number;
  std::map<std::string, std::vector<double>> list;

  [[nodiscard]] double operator[](const std::string& key) const { return number.at(key); }
};

struct Key {
  const char* name;
  double fallback;  // NaN: required
  double low, high;
  const char* unit;
};

struct Kind {
  const char* name;
  std::vector<Key> keys;
  int channels = 0;                     // effects: 0 none, 1 `channel`, 2 also `with_channel`
  std::vector<const char*> lists = {};  // all are required
};

[[nodiscard]] const std::vector<Kind>& channel_kinds();
[[nodiscard]] const std::vector<Key>& channel_common();  // keys of every channel
[[nodiscard]] const std::vector<Kind>& motion_kinds();
[[nodiscard]] const std::vector<Kind>& effect_kinds();

// Fills in all defaults. Throws std::invalid_argument with the name of an unknown, missing or out-of-range
// key.
[[nodiscard]] Recipe completed(Recipe recipe, const std::vector<Kind>& kinds,
                               const std::vector<Key>& common = {});

}  // namespace ifog::simulate
