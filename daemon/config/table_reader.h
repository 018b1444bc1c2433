// SPDX-License-Identifier: Apache-2.0
// Strict reader of one TOML table: keys are read by name, type and range; keys that were not read are errors.
// Collects all errors, one line each: file:line: key = value: what was expected.
#pragma once

#include <toml++/toml.h>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "filters/settings/filter_table.h"

namespace ifog {

struct Range {
  double least, most;          // inclusive
  bool without_least = false;  // excludes the least
};

class TableReader {
 public:
  // where: key path of the table, "" for the root. `errors` must outlive the reader.
  TableReader(const toml::table& table, std::string where, std::string file, std::vector<std::string>& errors)
      : table_(table), where_(std::move(where)), file_(std::move(file)), errors_(errors) {}

  std::optional<std::string> text(std::string_view key);
  std::optional<std::string> choice(std::string_view key, std::initializer_list<const char*> allowed);
  std::optional<double> number(std::string_view key, Range range);
  std::optional<std::int64_t> integer(std::string_view key, std::int64_t least, std::int64_t most);
  std::optional<bool> boolean(std::string_view key);
  // Reads one filter setting into `choice`, if the key is there.
  void filter_setting(const FilterSetting& setting, FilterChoice& choice);
  std::optional<std::vector<int>> integers(std::string_view key, int least, int most);
  std::optional<std::vector<std::string>> texts(std::string_view key);
  // As text(), choice() and integer(), but an error if absent.
  std::string required_text(std::string_view key, const char* expected);
  std::optional<std::string> required_choice(std::string_view key,
                                             std::initializer_list<const char*> allowed);
  std::optional<std::int64_t> required_integer(std::string_view key, std::int64_t least, std::int64_t most);

  // Table of this key; null if there is none, or another type (an error).
  const toml::table* table(std::string_view key);
  // Tables of [[key]]; empty if there are none.
  std::vector<const toml::table*> tables(std::string_view key);

  // True if the key exists, with any type.
  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }
  // Line of the key, or of the table if it is absent.
  [[nodiscard]] std::uint32_t line(std::string_view key) const;
  [[nodiscard]] std::string path(std::string_view key) const;
  // Adds an error at a key or at the table.
  void complain(std::string_view key, const std::string& what);
  // Adds an error for every key that was not read, with the known ones.
  void refuse_the_rest();

 private:
  template <typename Element, typename Read>
  std::optional<std::vector<Element>> list(std::string_view key, const std::string& expected, Read&& read);
  const toml::node* find(std::string_view key);
  void missing(std::string_view key, const std::string& expected);
  void wrong(std::string_view key, const toml::node& node, const std::string& expected);

  const toml::table& table_;
  std::string where_, file_;
  std::vector<std::string>& errors_;
  std::set<std::string, std::less<>> asked_;
};

// Text of a node, shortened.
std::string as_written(const toml::node& node);

}  // namespace ifog
