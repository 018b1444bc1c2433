// SPDX-License-Identifier: Apache-2.0
// Words, numbers, strings and signs of a DBC file, with the line each stands on. `//` to the end of the line
// is skipped like blanks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace ifog::dbc {

// What stands on a line and what was expected there.
struct ScanError : std::runtime_error {
  ScanError(std::size_t at_line, const std::string& what) : std::runtime_error(what), line(at_line) {}
  std::size_t line;
};

// Cheap to copy: a copy looks ahead.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  [[nodiscard]] bool at_end();                  // nothing but space left
  [[nodiscard]] std::string_view peek_word();   // "" where no word stands
  std::string_view word(const char* expected);  // letters, digits, '_', not beginning with a digit
  std::uint64_t integer(const char* expected, std::uint64_t highest);
  double number(const char* expected);            // finite
  std::string_view string(const char* expected);  // "…", may hold line ends
  std::string_view one_line_string(const char* expected);
  void sign(char character);                         // exactly this one
  [[nodiscard]] bool accept(char character);         // takes it if it is next
  [[nodiscard]] bool next_is(char character) const;  // behind blanks
  [[nodiscard]] bool next_is_digit() const;
  char one_of(const char* characters);

  // Whether a statement begins here. A keyword does not always do so: "CM_ BO_ 12 …" speaks of a message.
  [[nodiscard]] bool begins_statement() const;
  // To behind the ';', or to the end of the file. False: the next statement begins without one.
  bool skip_statement();
  void skip_line();  // to the end of the line
  // Behind something that cannot be read: to the next signal on the line, else to the end of the line.
  void resume();
  [[nodiscard]] std::string_view rest_of_line() const;

  [[nodiscard]] std::size_t line() const { return line_; }
  [[noreturn]] void fail(const std::string& expected);  // what stands here, what was expected

 private:
  void skip_space();
  void skip_digits();
  void step();
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

}  // namespace ifog::dbc
