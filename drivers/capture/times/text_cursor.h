// SPDX-License-Identifier: Apache-2.0
// Parses a text from the left, token by token. A function that fails does not advance, unless it says so.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <system_error>

namespace ifog {

class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : rest_(text) {}

  bool literal(char c) { return text({&c, 1}); }
  bool text(std::string_view what) {
    if (!rest_.starts_with(what)) return false;
    rest_.remove_prefix(what.size());
    return true;
  }
  bool one_of(std::string_view characters) {
    return !rest_.empty() && characters.find(rest_.front()) != std::string_view::npos &&
           literal(rest_.front());
  }
  // At least one blank.
  bool blanks() { return !up_to(rest_.find_first_not_of(" \t")).empty(); }
  // Text before the next blank.
  std::string_view word() { return up_to(rest_.find_first_of(" \t")); }
  // Text before the character; empty if it does not occur.
  std::string_view until(char c) {
    const std::size_t end = rest_.find(c);
    return end == std::string_view::npos ? std::string_view() : up_to(end);
  }
  std::string_view digits(std::size_t most = std::string_view::npos) {
    return up_to(std::min(rest_.find_first_not_of("0123456789"), most));
  }
  // A decimal number of `fewest` to `most` digits; false for fewer digits or overflow.
  template <typename Number>
  bool number(std::size_t fewest, std::size_t most, Number& value) {
    const std::string_view found = digits(most);
    value = 0;
    return found.size() >= fewest &&
           (found.empty() || std::from_chars(found.begin(), found.end(), value).ec == std::errc());
  }
  bool hex(std::uint32_t& digit) {
    constexpr std::string_view kDigits = "0123456789ABCDEFabcdef";
    const std::size_t at = rest_.empty() ? std::string_view::npos : kDigits.find(rest_.front());
    if (at == std::string_view::npos) return false;
    digit = static_cast<std::uint32_t>(at < 16 ? at : at - 6);
    rest_.remove_prefix(1);
    return true;
  }
  [[nodiscard]] bool has(std::size_t at, char c) const { return rest_.size() > at && rest_[at] == c; }
  [[nodiscard]] bool at(char c) const { return has(0, c); }
  [[nodiscard]] bool done() const { return rest_.empty(); }

 private:
  std::string_view up_to(std::size_t end) {
    const std::string_view found = rest_.substr(0, end);
    rest_.remove_prefix(found.size());
    return found;
  }

  std::string_view rest_;
};

}  // namespace ifog
