// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/options/plain_words.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/ifog/nearest.h"
#include "tools/ifog/console/options/checked_values.h"

namespace ifog::tools {
namespace {

// Texts that are no file. The same name is the same in every command.
constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kTexts = {{{"--axis", "NAME"},
                                                                                  {"--channel", "NAME"},
                                                                                  {"--filter", "NAME"},
                                                                                  {"--sensor", "NAME"},
                                                                                  {"--state", "NAME"},
                                                                                  {"--weights", "NAME"},
                                                                                  {"--to", "WHERE"},
                                                                                  {"NAME", "NAME"},
                                                                                  {"sensor", "NAME"}}};

std::string text_word(const std::string& option) {
  const auto found =
      std::find_if(kTexts.begin(), kTexts.end(), [&](const auto& each) { return each.first == option; });
  return found == kTexts.end() ? "FILE" : std::string(found->second);
}

// The word for a type as the parser names it, or the name that the command has given.
std::string word(const std::string& type, const std::string& option) {
  if (type == "TEXT") return text_word(option);
  if (type == "FLOAT") return "NUMBER";
  return type == "INT" || type == "UINT" ? "N" : type;
}

std::string shortened(std::string number) {
  for (const auto& [from, to] : {std::pair{"e+0", "e"}, {"e-0", "e-"}, {"e+", "e"}})
    if (const std::size_t at = number.find(from); at != std::string::npos)
      number.replace(at, std::string_view(from).size(), to);
  return number;
}

// What a check of the parser is called, as the end of a sentence; "" for one that says it elsewhere.
std::string range_of(const std::string& check) {
  if (check == "POSITIVE") return "more than 0";
  if (check == "NONNEGATIVE") return "0 or more";
  const std::size_t open = check.find('['), dash = check.find(" - "), close = check.find(']');
  if (open == std::string::npos || dash == std::string::npos || close == std::string::npos) return "";
  return shortened(check.substr(open + 1, dash - open - 1)) + " to " +
         shortened(check.substr(dash + 3, close - dash - 3));
}

std::string choice_of(const std::string& check) {
  if (!check.starts_with('{') || !check.ends_with('}')) return "";
  std::string words = check.substr(1, check.size() - 2);
  std::replace(words.begin(), words.end(), ',', '|');
  return words;
}

std::vector<std::string> words_of(const std::string& choice) {
  std::vector<std::string> words;
  for (std::size_t from = 0; from <= choice.size();) {
    const std::size_t to = std::min(choice.find('|', from), choice.size());
    words.push_back(choice.substr(from, to - from));
    from = to + 1;
  }
  return words;
}

void in_plain_words(CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return;  // a flag
  std::string choice, ranges;
  std::vector<CLI::Validator*> said_here;  // what they want, is in the help
  for (int i = 0;; ++i) {
    CLI::Validator* check = nullptr;
    try {
      check = option.get_validator(i);
    } catch (const CLI::OptionNotFound&) {
      break;
    }
    const std::string said = check->get_description();
    const std::string words_here = choice_of(said), range = range_of(said);
    if (!words_here.empty()) choice = words_here;
    if (!range.empty()) ranges += (ranges.empty() ? "" : "; ") + range;
    if (!words_here.empty() || !range.empty()) said_here.push_back(check);
    check->description("");
  }
  const std::string type = option.get_type_name();
  const ValueKind kind = choice.empty() ? value_kind(type) : ValueKind::text;
  const std::string expected = choice.empty() ? number_in_words(kind, ranges) : "";
  const std::vector<std::string> words = words_of(choice);
  for (CLI::Validator* const check : said_here)
    say_expected(*check, [expected, words](const std::string& written) {
      return expected.empty() ? one_of(written, words) : expected;
    });
  if (kind != ValueKind::text) hold_to_number(option, kind, expected);
  const std::string shown = choice.empty() ? word(type, option.get_name(option.get_positional())) : choice;
  // A variable of a script that was never set: --model "$MODEL" must not run without the model.
  if (kind == ValueKind::text && choice.empty()) hold_to_something(option, shown);
  option.type_name(shown);
  option.description(option.get_description() + (ranges.empty() ? "" : "; ") + ranges);
}

}  // namespace

void in_plain_words(CLI::App& app) {
  for (CLI::Option* const option : app.get_options([](CLI::Option*) { return true; }))
    in_plain_words(*option);
  for (CLI::App* const command : app.get_subcommands([](CLI::App*) { return true; }))
    in_plain_words(*command);
}

}  // namespace ifog::tools
