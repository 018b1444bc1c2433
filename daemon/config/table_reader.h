// SPDX-License-Identifier: Apache-2.0
// Reads one table of a TOML file strictly: every key is asked for by name, with its type and range; what was
// never asked for is unknown, and an error. All errors are gathered, each one line: file:line: key = value:
// what was expected.
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
  double least, most;          // both allowed
  bool without_least = false;  // but the least
};

class TableReader {
 public:
  // `where`: the table's key path, "" for the root. `errors` outlives the reader.
  TableReader(const toml::table& table, std::string where, std::string file, std::vector<std::string>& errors)
      : table_(table), where_(std::move(where)), file_(std::move(file)), errors_(errors) {}

  std::optional<std::string> text(std::string_view key);
  std::optional<std::string> choice(std::string_view key, std::initializer_list<const char*> allowed);
  std::optional<double> number(std::string_view key, Range range);
  std::optional<std::int64_t> integer(std::string_view key, std::int64_t least, std::int64_t most);
  std::optional<bool> boolean(std::string_view key);
  // One row of the table of filter settings, into `choice` where the key is there.
  void filter_setting(const FilterSetting& setting, FilterChoice& choice);
  std::optional<std::vector<int>> integers(std::string_view key, int least, int most);
  std::optional<std::vector<std::string>> texts(std::string_view key);
  // As text() and integer(), and an error when it is not there.
  std::string required_text(std::string_view key, const char* expected);
  std::optional<std::int64_t> required_integer(std::string_view key, std::int64_t least, std::int64_t most);

  // A table under `key`; null when there is none or it is something else (an error).
  const toml::table* table(std::string_view key);
  // Tables of [[key]]; empty when there are none.
  std::vector<const toml::table*> tables(std::string_view key);

  // The key exists, whatever it is.
  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }
  // The key's line; the table's own for a key that is not there.
  [[nodiscard]] std::uint32_t line(std::string_view key) const;
  [[nodiscard]] std::string path(std::string_view key) const;
  // An error at a key that was read, or at the table.
  void complain(std::string_view key, const std::string& what);
  // Every key that was not asked for is an error that names the known ones.
  void refuse_the_rest();

 private:
  template <typename Element, typename Read>
  std::optional<std::vector<Element>> list(std::string_view key, const std::string& expected, Read&& read);
  const toml::node* find(std::string_view key);
  void wrong(std::string_view key, const toml::node& node, const std::string& expected);

  const toml::table& table_;
  std::string where_, file_;
  std::vector<std::string>& errors_;
  std::set<std::string, std::less<>> asked_;
};

// A node as the user wrote it, shortened.
std::string as_written(const toml::node& node);

}  // namespace ifog
