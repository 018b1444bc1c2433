// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/table_reader.h"

#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"
#include "filters/model_file/toml_file.h"
#include "filters/rules/names.h"

namespace ifog {
namespace {

std::string in_digits(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

std::string describe(Range range) {
  if (range.without_least)
    return "a number > " + in_digits(range.least) +
           (std::isinf(range.most) ? "" : " and <= " + in_digits(range.most));
  if (std::isinf(range.most)) {
    if (std::isinf(range.least)) return "a number";
    return "a number >= " + in_digits(range.least);
  }
  return "a number " + in_digits(range.least) + " ... " + in_digits(range.most);
}

std::string in_words(std::int64_t least, std::int64_t most) {
  return "a whole number " + std::to_string(least) + " ... " + std::to_string(most);
}

std::string in_words(std::initializer_list<const char*> allowed) {
  std::string out;
  for (const char* const one : allowed) out += (out.empty() ? "\"" : " | \"") + std::string(one) + "\"";
  return out;
}

}  // namespace

std::string as_written(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (const auto* number = node.as_floating_point()) {
    // Shortest exact text: toml++ prints 0.1 with 17 digits.
    std::array<char, 32> digits{};
    return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number->get()).ptr};
  }
  std::ostringstream out;
  if (const auto* array = node.as_array())
    out << *array;
  else
    node.visit([&out](const auto& value) {
      if constexpr (toml::is_value<decltype(value)>) out << value;
    });
  return out.str();
}

std::string TableReader::path(std::string_view key) const {
  if (where_.empty()) return std::string(key);
  return key.empty() ? where_ : where_ + "." + std::string(key);
}

std::uint32_t TableReader::line(std::string_view key) const {
  const toml::node* const node = table_.get(key);
  return node != nullptr ? node->source().begin.line : table_.source().begin.line;
}

void TableReader::complain(std::string_view key, const std::string& what) {
  errors_.push_back(file_ + ":" + std::to_string(line(key)) + ": " +
                    printable(path(key) + what, kLongestMessage));
}

const toml::node* TableReader::find(std::string_view key) {
  asked_.emplace(key);
  return table_.get(key);
}

void TableReader::wrong(std::string_view key, const toml::node& node, const std::string& expected) {
  std::string value = as_written(node);
  // 50.0 is not an integer in TOML, but looks like one.
  if (expected.starts_with("a whole number") && node.is_floating_point() &&
      value.find_first_not_of("-0123456789") == std::string::npos)
    value += ".0";
  complain(key, " = " + printable(value) + ": expected " + expected);
}

void TableReader::missing(std::string_view key, const std::string& expected) {
  complain(key, ": missing; expected " + expected);
}

std::optional<std::string> TableReader::text(std::string_view key) {
  const toml::node* const node = find(key);
  if (node == nullptr) return std::nullopt;
  if (const auto* value = node->as_string(); value != nullptr && !value->get().empty()) return value->get();
  wrong(key, *node, node->is_string() ? "a text that is not empty" : "a text in quotes");
  return std::nullopt;
}

std::string TableReader::required_text(std::string_view key, const char* expected) {
  if (!has(key)) missing(key, expected);
  return text(key).value_or("");
}

std::optional<std::string> TableReader::choice(std::string_view key,
                                               std::initializer_list<const char*> allowed) {
  const toml::node* const node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto* const value = node->as_string();
  for (const char* const one : allowed)
    if (value != nullptr && value->get() == one) return one;
  wrong(key, *node, in_words(allowed) + (value == nullptr ? "" : did_you_mean(value->get(), allowed)));
  return std::nullopt;
}

std::optional<std::string> TableReader::required_choice(std::string_view key,
                                                        std::initializer_list<const char*> allowed) {
  if (!has(key)) missing(key, in_words(allowed));
  return choice(key, allowed);
}

std::optional<double> TableReader::number(std::string_view key, Range range) {
  const toml::node* const node = find(key);
  if (node == nullptr) return std::nullopt;
  if (node->is_number()) {
    const double value = node->value<double>().value_or(std::nan(""));
    const bool enough = range.without_least ? value > range.least : value >= range.least;
    if (enough && value <= range.most) return value;
  }
  wrong(key, *node, describe(range));
  return std::nullopt;
}

std::optional<std::int64_t> TableReader::integer(std::string_view key, std::int64_t least,
                                                 std::int64_t most) {
  const toml::node* const node = find(key);
  if (node == nullptr) return std::nullopt;
  if (const auto* value = node->as_integer();
      value != nullptr && value->get() >= least && value->get() <= most)
    return value->get();
  wrong(key, *node, in_words(least, most));
  return std::nullopt;
}

std::optional<std::int64_t> TableReader::required_integer(std::string_view key, std::int64_t least,
                                                          std::int64_t most) {
  if (!has(key)) missing(key, in_words(least, most));
  return integer(key, least, most);
}

std::optional<bool> TableReader::boolean(std::string_view key) {
  const toml::node* const node = find(key);
  if (node == nullptr) return std::nullopt;
  if (const auto* value = node->as_boolean()) return value->get();
  wrong(key, *node, "true or false");
  return std::nullopt;
}

void TableReader::filter_setting(const FilterSetting& setting, FilterChoice& choice) {
  const toml::node* const node = find(setting.key);
  if (node == nullptr) return;
  const std::optional<SettingValue> value = setting_value(*node);
  const std::string text = node->value<std::string>().value_or("");
  if (!value || !choose(setting, *value, choice)) return wrong(setting.key, *node, expected(setting, text));
  // Names that are defined elsewhere.
  if (const std::string name = expected_name(setting, text); !name.empty()) wrong(setting.key, *node, name);
}

// All elements, or none if `read` rejects one.
template <typename Element, typename Read>
std::optional<std::vector<Element>> TableReader::list(std::string_view key, const std::string& expected,
                                                      Read&& read) {
  const toml::node* const node = find(key);
  if (node == nullptr) return std::nullopt;
  std::vector<Element> out;
  bool good = node->is_array();
  if (good)
    for (const toml::node& element : *node->as_array()) {
      const std::optional<Element> value = read(element);
      good = good && value;
      if (good) out.push_back(*value);
    }
  if (good) return out;
  wrong(key, *node, "a list of " + expected);
  return std::nullopt;
}

std::optional<std::vector<int>> TableReader::integers(std::string_view key, int least, int most) {
  return list<int>(key, "whole numbers " + std::to_string(least) + " ... " + std::to_string(most),
                   [&](const toml::node& element) {
                     const std::optional<std::int64_t> value = element.value_exact<std::int64_t>();
                     return value && *value >= least && *value <= most
                                ? std::optional(static_cast<int>(*value))
                                : std::nullopt;
                   });
}

std::optional<std::vector<std::string>> TableReader::texts(std::string_view key) {
  return list<std::string>(key, "texts",
                           [](const toml::node& element) { return element.value_exact<std::string>(); });
}

const toml::table* TableReader::table(std::string_view key) {
  const toml::node* const node = find(key);
  if (node == nullptr) return nullptr;
  if (node->is_table()) return node->as_table();
  wrong(key, *node, "a table [" + path(key) + "]");
  return nullptr;
}

std::vector<const toml::table*> TableReader::tables(std::string_view key) {
  std::vector<const toml::table*> out;
  const toml::node* const node = find(key);
  if (node == nullptr) return out;
  if (const auto* const array = node->as_array(); array != nullptr && node->is_array_of_tables()) {
    for (const toml::node& element : *array) out.push_back(element.as_table());
    return out;
  }
  complain(key, ": expected [[" + path(key) + "]]");
  return out;
}

void TableReader::refuse_the_rest() {
  std::string known;
  for (const std::string& name : asked_) known += (known.empty() ? "" : ", ") + name;
  std::size_t unknown = 0;
  for (const auto& [key, node] : table_) {
    if (asked_.contains(key.str()) || unknown++ >= kInputLimits.unknown_keys) continue;
    const std::string meant = did_you_mean(key.str(), asked_);
    errors_.push_back(file_ + ":" + std::to_string(key.source().begin.line) + ": " +
                      printable(path(key.str())) + ": unknown key" + meant +
                      (meant.empty() ? "; known here: " : " Known here: ") + known);
  }
  if (unknown > kInputLimits.unknown_keys)
    errors_.push_back(file_ + ": " + std::to_string(unknown) + " unknown keys in " +
                      (where_.empty() ? "it" : where_) + ", of which the first are named");
}

}  // namespace ifog
