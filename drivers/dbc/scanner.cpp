// SPDX-License-Identifier: Apache-2.0
#include "drivers/dbc/scanner.h"

#include <charconv>
#include <cmath>
#include <cstring>

#include "drivers/ifog/decimal.h"
#include "drivers/ifog/quoted.h"

namespace ifog::dbc {
namespace {

// std::isalpha depends on the locale, and DBC files contain Latin-1 in strings.
bool begins_word(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }
bool space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

// Longer strings count as unclosed, so the search is bounded.
constexpr std::size_t kLongestString = 65536;

// keywords: with a blank around each.
bool is_among(std::string_view keyword, std::string_view keywords) {
  return keywords.find(" " + std::string(keyword) + " ") != std::string_view::npos;
}

// True for keywords that occur only at the start of a statement.
bool stands_first_only(std::string_view keyword) {
  return is_among(
      keyword,
      " CM_ BA_ BA_DEF_ BA_DEF_DEF_ BA_DEF_REL_ BA_REL_ BA_DEF_DEF_REL_ BA_DEF_SGTYPE_ BA_SGTYPE_ "
      "BA_DEF_SGTYPE_REL_ VAL_ VAL_TABLE_ SG_MUL_VAL_ SIG_GROUP_ SIG_VALTYPE_ SIG_TYPE_REF_ "
      "SIGTYPE_VALTYPE_ SGTYPE_ SGTYPE_VAL_ BO_TX_BU_ EV_DATA_ ENVVAR_DATA_ CAT_DEF_ ");
}

}  // namespace

bool carries_no_layout(std::string_view keyword) {
  return (stands_first_only(keyword) && !is_among(keyword, " BA_ SG_MUL_VAL_ SIG_VALTYPE_ ")) ||
         is_among(keyword, " EV_ CAT_ FILTER BU_SG_REL_ BU_EV_REL_ BU_BO_REL_ NS_DESC_ ");
}

void Scanner::step() {
  if (text_[at_] == '\n') ++line_;
  ++at_;
}

void Scanner::skip_space() {
  while (at_ < text_.size()) {
    if (space(text_[at_]))
      step();
    else if (text_.substr(at_, 2) == "//")
      skip_line();
    else
      return;
  }
}

void Scanner::skip_line() {
  while (at_ < text_.size() && text_[at_] != '\n') ++at_;
}

bool Scanner::at_end() {
  skip_space();
  return at_ == text_.size();
}

std::string_view Scanner::rest_of_line() const {
  const std::string_view rest = text_.substr(at_);
  return rest.substr(0, rest.find_first_of("\r\n"));
}

void Scanner::fail(const std::string& expected) {
  constexpr std::size_t kShown = 24;
  skip_space();
  const std::string_view here = rest_of_line();
  throw ScanError(line_,
                  (here.empty() ? "the file ends" : in_quotes(here, kShown)) + ", expected " + expected);
}

std::string_view Scanner::peek_word() {
  skip_space();
  if (at_ == text_.size() || !begins_word(text_[at_])) return {};
  std::size_t end = at_;
  while (end < text_.size() && (begins_word(text_[end]) || digit(text_[end]))) ++end;
  return text_.substr(at_, end - at_);
}

std::string_view Scanner::word(const char* expected) {
  const std::string_view found = peek_word();
  if (found.empty()) fail(expected);
  at_ += found.size();
  return found;
}

std::uint64_t Scanner::integer(const char* expected, std::uint64_t highest) {
  skip_space();
  std::uint64_t value = 0;
  const char* begin = text_.data() + at_;
  const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
  if (error != std::errc() || value > highest) fail(expected);
  at_ += static_cast<std::size_t>(end - begin);
  return value;
}

double Scanner::number(const char* expected) {
  skip_space();
  double value = 0.0;
  const char* begin = text_.data() + at_;
  const auto [end, error] = read_decimal(begin, text_.data() + text_.size(), value);
  if (error != std::errc() || !std::isfinite(value)) fail(expected);
  at_ += static_cast<std::size_t>(end - begin);
  return value;
}

// An unclosed quote would extend to the next string. It is detected by a line that starts a statement within
// the string, without ';' after the string. Then parsing continues after the line.
std::string_view Scanner::string(const char* expected) {
  skip_space();
  if (at_ == text_.size() || text_[at_] != '"') fail(expected);
  const Scanner open = *this;
  bool holds_statement = false;
  ++at_;
  while (at_ < text_.size() && text_[at_] != '"' && at_ - open.at_ < kLongestString) {
    const bool line_end = text_[at_] == '\n' && !holds_statement;
    // A quote inside a string is written \".
    if (text_[at_] == '\\' && at_ + 1 < text_.size()) step();
    step();
    if (line_end && rest_of_line().find_first_not_of(" \t") != std::string_view::npos)
      holds_statement = begins_statement();
  }
  if (at_ < text_.size() && text_[at_] == '"') {
    const std::string_view content = text_.substr(open.at_ + 1, at_ - open.at_ - 1);
    ++at_;
    if (!holds_statement || next_is(';')) return content;
  }
  *this = open;
  throw ScanError(line_, "a string without its closing quote");
}

std::string_view Scanner::one_line_string(const char* expected) {
  skip_space();
  const Scanner open = *this;
  const std::string_view content = string(expected);
  if (content.find('\n') == std::string_view::npos) return content;
  *this = open;
  throw ScanError(line_, "a string without its closing quote");
}

bool Scanner::next_is(char character) const {
  Scanner ahead = *this;
  return ahead.accept(character);
}

bool Scanner::accept(char character) {
  skip_space();
  if (at_ == text_.size() || text_[at_] != character) return false;
  ++at_;
  return true;
}

void Scanner::sign(char character) {
  if (!accept(character)) fail(std::string("'") + character + "'");
}

char Scanner::one_of(const char* characters) {
  skip_space();
  if (at_ == text_.size() || text_[at_] == '\0' || std::strchr(characters, text_[at_]) == nullptr)
    fail(std::string("one of ") + characters);
  return text_[at_++];
}

bool Scanner::begins_statement() const {
  Scanner ahead = *this;
  const std::string_view keyword = ahead.peek_word();
  if (keyword.empty()) return false;
  if (stands_first_only(keyword)) return true;
  ahead.at_ += keyword.size();
  ahead.skip_space();
  const std::size_t number = ahead.at_;
  while (ahead.at_ < text_.size() && digit(text_[ahead.at_])) ++ahead.at_;
  const bool numbered = ahead.at_ > number;
  if (keyword == "VERSION") return ahead.next_is('"');
  if (keyword == "NS_" || keyword == "BS_" || keyword == "BU_") return ahead.next_is(':');
  // Otherwise it is BO_ 12 "text", BO_ 12 34 or, in declarations of attributes, BO_ "name".
  if (keyword == "BO_") return numbered ? !ahead.peek_word().empty() : !ahead.next_is('"');
  // Otherwise it is SG_ 12 name "text", SG_ 12 name 34 or SG_ "name".
  if (keyword == "SG_" && !numbered) return !ahead.next_is('"');
  if (keyword != "SG_" && keyword != "EV_") return false;
  const std::string_view name = ahead.peek_word();
  ahead.at_ += name.size();
  return !name.empty() && ahead.next_is(':');
}

bool Scanner::skip_statement() {
  (void)word("a keyword");
  while (!at_end()) {
    if (text_[at_] == '"') {
      (void)string("a string");
    } else if (begins_statement()) {
      return false;
    } else if (const std::string_view found = peek_word(); !found.empty()) {
      at_ += found.size();
    } else {
      const char c = text_[at_];
      step();
      if (c == ';') return true;
    }
  }
  return true;
}

void Scanner::resume() {
  for (; at_ < text_.size() && text_[at_] != '\n'; ++at_) {
    const bool word_begins = at_ == 0 || !(begins_word(text_[at_ - 1]) || digit(text_[at_ - 1]));
    if (word_begins && text_[at_] == 'S' && peek_word() == "SG_" && begins_statement()) return;
  }
}

}  // namespace ifog::dbc
