// SPDX-License-Identifier: Apache-2.0
// Reading a plugin's settings, for plugins written in C++. Header only, so that a plugin needs nothing but
// this folder.
//
// The host passes every option the plugin lists, the default where the user gave no value, so a plugin only
// has to check values. What these throw is the line the user reads; `create_or_explain` carries it over the C
// interface.
#pragma once

#include <cmath>
#include <cstdio>
#include <exception>
#include <initializer_list>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "decimal.h"
#include "driver.h"
#include "nearest.h"
#include "quoted.h"

namespace ifog::plugin {

class Options {
 public:
  explicit Options(std::span<const ifog_setting> settings) : settings_(settings) {}

  // "" where the host passed no such key.
  [[nodiscard]] std::string_view text(std::string_view key) const {
    for (const ifog_setting& setting : settings_)
      if (key == setting.key) return setting.value;
    return {};
  }

  [[nodiscard]] bool given(std::string_view key) const { return !text(key).empty(); }

  // The value that goes with the word the user chose.
  template <typename T>
  [[nodiscard]] T choice(std::string_view key,
                         std::initializer_list<std::pair<std::string_view, T>> words) const {
    const std::string_view value = text(key);
    std::vector<std::string_view> known;
    for (const auto& [word, meaning] : words) {
      if (word == value) return meaning;
      known.push_back(word);
    }
    fail(key, one_of(value, known));
  }

  // A finite number in [low, high]; `expected` says so in words.
  [[nodiscard]] double number(std::string_view key, double low, double high,
                              const std::string& expected) const {
    const std::string_view value = text(key);
    double result = 0.0;
    const auto [end, error] = read_decimal(value.data(), value.data() + value.size(), result);
    if (error != std::errc() || end != value.data() + value.size() || !std::isfinite(result) ||
        result < low || result > high)
      fail(key, expected);
    return result;
  }

  [[noreturn]] void fail(std::string_view key, const std::string& expected) const {
    throw std::invalid_argument(std::string(key) + " is " + in_quotes(text(key)) + ", expected " + expected);
  }

 private:
  std::span<const ifog_setting> settings_;
};

// For `create`: runs `make`, which returns a new instance, and turns an exception into the interface's NULL
// and line.
template <typename Make>
void* create_or_explain(const ifog_setting* settings, std::size_t count, char* error, std::size_t error_size,
                        Make&& make) noexcept {
  try {
    if (error_size != 0) error[0] = '\0';
    return std::forward<Make>(make)(Options({settings, count}));
  } catch (const std::exception& problem) {
    if (error_size != 0) std::snprintf(error, error_size, "%s", problem.what());
  } catch (...) {
    if (error_size != 0) std::snprintf(error, error_size, "unknown failure while creating the driver");
  }
  return nullptr;
}

// Warnings that come with a new instance, one a line, for the host to log. The last line counts those that do
// not fit.
inline void explain_warnings(std::span<const std::string> warnings, char* error, std::size_t error_size) {
  constexpr std::size_t kForCount = 64;
  std::string all;
  for (std::size_t i = 0; i < warnings.size(); ++i) {
    const std::string line = printable(warnings[i], kLongestMessage);
    if (all.size() + line.size() + 1 + kForCount > error_size) {
      all += "and " + std::to_string(warnings.size() - i) + " more warnings\n";
      break;
    }
    all += line + '\n';
  }
  if (error_size != 0) std::snprintf(error, error_size, "%s", all.c_str());
}

// Copies into a name field of ifog_description; a longer text is cut, the end is always marked.
inline void set_name(char (&field)[IFOG_NAME_LENGTH], std::string_view name) {
  std::snprintf(field, IFOG_NAME_LENGTH, "%.*s", static_cast<int>(name.size()), name.data());
}

}  // namespace ifog::plugin
