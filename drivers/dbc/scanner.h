// Words, numbers, strings and signs of a DBC file, with the line each stands on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace ifog::dbc {

class Scanner {
 public:
  Scanner(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  [[nodiscard]] bool at_end();                  // nothing but space left
  [[nodiscard]] std::string_view peek_word();   // "" where no word stands
  std::string_view word(const char* expected);  // letters, digits, '_', not beginning with a digit
  std::uint64_t integer(const char* expected, std::uint64_t highest);
  double number(const char* expected);            // finite
  std::string_view string(const char* expected);  // "…", may hold line ends
  void sign(char character);                      // exactly this one
  [[nodiscard]] bool accept(char character);      // takes it if it is next
  char one_of(const char* characters);
  void skip_statement();  // to behind the ';', which inside a string does not count
  void skip_line();       // to the end of the line

  [[nodiscard]] std::size_t line() const { return line_; }
  [[noreturn]] void fail(const std::string& expected);  // file:line, what stands here, what was expected

 private:
  void skip_space();
  void step();
  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

}  // namespace ifog::dbc
