// SPDX-License-Identifier: Apache-2.0
// Tokens of a DBC file (words, numbers, strings, characters) with their lines. `//` comments are skipped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace ifog::dbc {

// True for keywords of statements that contain neither layout nor names of signals.
[[nodiscard]] bool carries_no_layout(std::string_view keyword);

// The text found at a line, and what was expected.
struct ScanError : std::runtime_error {
  ScanError(std::size_t at_line, const std::string& what) : std::runtime_error(what), line(at_line) {}
  std::size_t line;
};

// Cheap to copy, for look-ahead.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  [[nodiscard]] bool at_end();                  // only space left
  [[nodiscard]] std::string_view peek_word();   // "" if there is no word
  std::string_view word(const char* expected);  // letters, digits, '_'; does not start with a digit
  std::uint64_t integer(const char* expected, std::uint64_t highest);
  double number(const char* expected);            // finite
  std::string_view string(const char* expected);  // "…", may contain line ends
  std::string_view one_line_string(const char* expected);
  void sign(char character);                         // exactly this character
  [[nodiscard]] bool accept(char character);         // consumes it if it is next
  [[nodiscard]] bool next_is(char character) const;  // after blanks
  char one_of(const char* characters);

  // True if a statement starts here. Keywords occur elsewhere too: "CM_ BO_ 12 …" is about a message.
  [[nodiscard]] bool begins_statement() const;
  // Skips to after the ';' or to the end of the file. False: the next statement starts without one.
  bool skip_statement();
  void skip_line();  // to the end of the line
  // After an error: skips to the next signal on the line, or to its end.
  void resume();
  [[nodiscard]] std::string_view rest_of_line() const;

  [[nodiscard]] std::size_t line() const { return line_; }
  [[noreturn]] void fail(const std::string& expected);  // throws: what is here, what was expected

 private:
  void skip_space();
  void step();
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

}  // namespace ifog::dbc
