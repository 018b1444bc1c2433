// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/serial/set_up_dialogue.h"

#include <algorithm>
#include <cctype>

namespace ifog {
namespace {

constexpr std::string_view kArrow = " -> ";
constexpr std::size_t kMostCharacters = 1000;  // characters; a custom filter (=FC20) has some hundred

// Without blanks, upper case: the manual uses both notations.
std::string plain(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (c != ' ') out += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

std::string first_word(const std::string& answer) { return answer.substr(0, answer.find(',')); }

}  // namespace

SetUpDialogue::SetUpDialogue(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    const std::size_t arrow = line.find(kArrow);
    const std::string sent = line.substr(0, arrow);
    const bool answered = arrow != std::string::npos;
    lines_.push_back({sent, plain(answered ? line.substr(arrow + kArrow.size()) : sent.substr(1)),
                      !answered && sent.front() == '?'});
  }
}

std::string SetUpDialogue::complaint(std::string_view line) {
  const bool printable = std::ranges::all_of(line, [](char c) { return c >= ' ' && c <= '~'; });
  const std::size_t arrow = line.find(kArrow);
  const bool answered = arrow != std::string_view::npos && arrow > 0 && arrow + kArrow.size() < line.size();
  const bool known = line.size() > 1 && (line.front() == '=' || line.front() == '?');
  if (printable && line.size() <= kMostCharacters && (answered || (known && arrow == std::string_view::npos)))
    return "";
  return R"(expected "=COMMAND", "?QUERY" or "WORDS -> ANSWER" of at most 1000 characters of ASCII)";
}

bool SetUpDialogue::take(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (byte >= ' ' && byte <= '~') {
      if (text_.size() < kMostCharacters) text_ += static_cast<char>(byte);
      continue;
    }
    const std::string text = plain(text_);
    text_.clear();
    if ((byte == '\r' || byte == '\n') && judge(text)) return true;
  }
  return false;
}

// Evaluates a complete line, which may start with bytes of a frame. Rejected text follows the word "INVALID".
bool SetUpDialogue::judge(const std::string& text) {
  if (const std::size_t invalid = text.find("INVALID"); invalid != std::string::npos) {
    refusal_ = text.substr(invalid);
    return false;
  }
  const Line& line = lines_[at_];
  const std::string word = first_word(line.answer) + (line.answer == first_word(line.answer) ? "" : ",");
  const std::size_t begin = text.rfind(line.any ? line.answer + "," : word);
  if (begin == std::string::npos) return false;
  const std::string answer = text.substr(begin);
  if (!line.any && answer != line.answer) {
    refusal_ = answer;
    return false;
  }
  answers_ += (answers_.empty() ? "" : "; ") + answer;
  ++at_;
  return true;
}

}  // namespace ifog
