// SPDX-License-Identifier: Apache-2.0
// Reads a plugin's settings in C++. Header only.
//
// The host passes every option that the plugin lists, with defaults, so a plugin only checks values.
// Exceptions contain the user's error message; `create_or_explain` passes it through the C interface.
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

  // "" if the host passed no such key.
  [[nodiscard]] std::string_view text(std::string_view key) const {
    for (const ifog_setting& setting : settings_)
      if (key == setting.key) return setting.value;
    return {};
  }

  [[nodiscard]] bool given(std::string_view key) const { return !text(key).empty(); }

  // The value that belongs to the chosen word.
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

  // A finite number in [low, high]; `expected` is the text of that range.
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

// For `create`: calls `make`, which returns a new instance, and converts an exception to NULL and the
// message.
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

// Warnings of a new instance, one per line, for the host's log. The last line counts those that do not fit.
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

// Copies into a name field of ifog_description; longer texts are cut, always zero-terminated.
inline void set_name(char (&field)[IFOG_NAME_LENGTH], std::string_view name) {
  std::snprintf(field, IFOG_NAME_LENGTH, "%.*s", static_cast<int>(name.size()), name.data());
}

}  // namespace ifog::plugin
