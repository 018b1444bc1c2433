#include "drivers/dbc/scanner.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace ifog::dbc {
namespace {

// Not std::isalpha: its answer depends on the locale, and DBC files carry Latin-1 in strings.
bool begins_word(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }
bool space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

}  // namespace

void Scanner::step() {
  if (text_[at_] == '\n') ++line_;
  ++at_;
}

void Scanner::skip_space() {
  while (at_ < text_.size() && space(text_[at_])) step();
}

bool Scanner::at_end() {
  skip_space();
  return at_ == text_.size();
}

void Scanner::fail(const std::string& expected) {
  constexpr std::size_t kShown = 24;
  skip_space();
  std::string here;
  for (std::size_t i = at_; i < text_.size() && here.size() < kShown && text_[i] != '\n' && text_[i] != '\r';
       ++i)
    here += text_[i] >= ' ' && text_[i] <= '~' ? text_[i] : '?';
  throw std::runtime_error(file_ + ":" + std::to_string(line_) + ": " +
                           (here.empty() ? "the file ends" : "'" + here + "'") + ", expected " + expected);
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
  if (at_ < text_.size() && text_[at_] == '+') ++at_;  // from_chars takes no plus sign
  double value = 0.0;
  const char* begin = text_.data() + at_;
  const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
  if (error != std::errc() || !std::isfinite(value)) fail(expected);
  at_ += static_cast<std::size_t>(end - begin);
  return value;
}

std::string_view Scanner::string(const char* expected) {
  skip_space();
  if (at_ == text_.size() || text_[at_] != '"') fail(expected);
  const std::size_t first_line = line_;
  const std::size_t begin = ++at_;
  while (at_ < text_.size() && text_[at_] != '"') {
    // A quote inside a string is written \".
    if (text_[at_] == '\\' && at_ + 1 < text_.size()) step();
    step();
  }
  if (at_ == text_.size())
    throw std::runtime_error(file_ + ":" + std::to_string(first_line) +
                             ": a string without its closing quote");
  return text_.substr(begin, at_++ - begin);
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

void Scanner::skip_statement() {
  const std::size_t first_line = line_;
  for (;;) {
    skip_space();
    if (at_ == text_.size())
      throw std::runtime_error(file_ + ":" + std::to_string(first_line) +
                               ": a statement without its closing ';'");
    if (text_[at_] == '"') {
      (void)string("a string");
      continue;
    }
    const char c = text_[at_];
    step();
    if (c == ';') return;
  }
}

void Scanner::skip_line() {
  while (at_ < text_.size() && text_[at_] != '\n') ++at_;
}

}  // namespace ifog::dbc
