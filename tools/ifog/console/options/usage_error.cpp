// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/options/parser_texts.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"

namespace ifog::tools {
namespace {

std::vector<std::string> commands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* const command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

// With their dashes.
std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

// The parser reports a missing option before an unknown one, although they are mostly the same.
std::string unknown_option(const CLI::App& command, int argc, const char* const* argv) {
  const std::vector<std::string> known = option_names(command);
  for (int i = 2; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--") break;
    if (word.size() > 1 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1])) != 0 &&
        command.get_option_no_throw(std::string(word.substr(0, 2))) == nullptr)
      return "unknown option " + in_quotes(word) + "; put a name or file that begins with - after --";
    if (!word.starts_with("--") || word.size() < 4) continue;
    const std::string name(word.substr(0, word.find('=')));
    if (command.get_option_no_throw(name) != nullptr) continue;
    return "unknown option " + in_quotes(name) + did_you_mean(name, known);
  }
  return "";
}

// "--option: At Most 1 required but received 2", "--option: 1 required FILE missing".
std::string plainly_counted(const std::string& said) {
  constexpr std::string_view kMost = ": At Most 1 required but received ", kLeast = ": 1 required ",
                             kMissing = " missing";
  if (const std::size_t at = said.find(kMost); at != std::string::npos)
    return said.substr(0, at) + ": has " + said.substr(at + kMost.size()) + " values, expected one";
  if (const std::size_t at = said.find(kLeast); at != std::string::npos && said.ends_with(kMissing))
    return said.substr(0, at) + ": has no value, expected " +
           said.substr(at + kLeast.size(), said.size() - at - kLeast.size() - kMissing.size());
  return said;
}

// The parser's "Could not convert: --option = value" lacks the expected value.
std::string plainly(const CLI::App& command, const std::string& said) {
  constexpr std::string_view kSays = "Could not convert: ", kIs = " = ";
  const std::size_t at = said.find(kIs);
  if (!said.starts_with(kSays) || at == std::string::npos) return plainly_counted(said);
  const std::string name = said.substr(kSays.size(), at - kSays.size());
  const CLI::Option* const option = command.get_option_no_throw(name);
  std::string expected = "another value";
  if (option != nullptr)
    expected = option->get_type_name().empty() ? "nothing behind it, true or false"
                                               : option->get_type_name() + " in the range that it can hold";
  return name + ": is " + in_quotes(said.substr(at + kIs.size())) + ", expected " + expected;
}

}  // namespace

std::string usage_error(const CLI::App& app, int argc, const char* const* argv, const std::string& said) {
  std::string who = "ifog", what = printable(said, kLongestMessage);
  const std::string_view first = argc > 1 ? argv[1] : "";
  const std::vector<std::string> commands = commands_of(app);
  const bool is_command = std::find(commands.begin(), commands.end(), first) != commands.end();
  if (is_command) {
    who += " " + std::string(first);
    const CLI::App& command = *app.get_subcommand(std::string(first));
    what = plainly(command, what);
    if (const std::string unknown = unknown_option(command, argc, argv); !unknown.empty()) what = unknown;
  } else if (!first.starts_with('-')) {
    what =
        first.empty() ? "no command" : "unknown command " + in_quotes(first) + did_you_mean(first, commands);
    if (what.back() != '?')
      for (std::size_t i = 0; i < commands.size(); ++i)
        what += (i == 0 ? ", expected one of: " : ", ") + commands[i];
  }
  return who + ": " + what + "\n" + "`" + who + " --help` lists the options.\n";
}

}  // namespace ifog::tools
