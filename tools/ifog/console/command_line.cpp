// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/command_line.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cctype>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <iterator>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/config/version_text.h"
#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"
#include "tools/report/text.h"

namespace ifog::tools {
namespace {

std::string typed;
std::vector<std::string> words;

// Exit code of a shell for a program that SIGPIPE ended.
constexpr int kEndedBySigpipe = 128 + 13;

std::vector<std::string> commands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* const command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

// `ifog help [command]` is `ifog [command] --help`; the parser rejects unknown commands.
std::vector<std::string> with_help_as_option(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string> all(argv, argv + argc);
  if (all.size() < 2 || all[1] != "help") return all;
  all.erase(all.begin() + 1);
  all.resize(std::min<std::size_t>(all.size(), 2));
  if (all.size() == 1 || std::ranges::count(commands_of(app), all[1]) > 0) all.emplace_back("--help");
  return all;
}

std::vector<std::string> option_names(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

// The parser reports a missing option before an unknown one, although they are mostly the same.
std::string unknown_option(const CLI::App& command, int argc, const char* const* argv) {
  std::vector<std::string> known;
  for (const CLI::Option* const option : command.get_options())
    std::ranges::move(option_names(*option), std::back_inserter(known));
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

using Json = nlohmann::ordered_json;

// The choices in "auto|candump|bytes"; value names are in capitals.
std::vector<std::string> choices_of(const std::string& value) {
  std::vector<std::string> words;
  const auto capital = [](char c) { return c >= 'A' && c <= 'Z'; };
  if (value.find('|') != std::string::npos && std::ranges::none_of(value, capital))
    boost::split(words, value, boost::is_any_of("|"));
  return words;
}

Json option_of(const CLI::Option& option) {
  // A flag takes no value and has no type.
  const std::string value = option.get_items_expected_max() > 0 ? option.get_type_name() : "";
  return {{"names", option_names(option)},
          {"positional", option.get_positional() ? option.get_name(true) : ""},
          {"value", value},
          {"choices", choices_of(value)},
          {"default", option.get_default_str()},
          {"required", option.get_required()},
          {"repeats", option.get_items_expected_max() > 1},
          {"group", option.get_group()},
          {"help", option.get_description()}};
}

Json options_of(const CLI::App& app) {
  Json options = Json::array();
  for (const CLI::Option* const option : app.get_options())
    if (!option->get_group().empty())
      options.push_back(option_of(*option));  // no group: hidden in --help too
  return options;
}

// Breaks a text between words.
std::string in_lines(const std::string& text, std::size_t width) {
  std::string out;
  std::size_t at = 0;
  std::istringstream words_in(text);
  for (std::string word; words_in >> word;) {
    const std::size_t size = report::characters_in(word);
    const bool fits = at == 0 || at + 1 + size <= width;
    out += at == 0 ? "" : fits ? " " : "\n";
    at = (fits && at > 0 ? at + 1 : 0) + size;
    out += word;
  }
  return out;
}

// Width of the terminal on standard output, limited to readable lines; 100 for other outputs.
std::size_t help_width() {
  constexpr std::size_t kUsual = 100, kLeast = 60;
  winsize size{};
  if (isatty(STDOUT_FILENO) == 0 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
    return kUsual;
  return std::clamp<std::size_t>(size.ws_col, kLeast, 2 * kLeast);
}

// Layout of --help: the parser's, with descriptions in lines as long as the terminal allows.
class HelpFormat final : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    return boost::replace_all_copy(Formatter::make_help(app, std::move(name), mode), "\n\n\n", "\n\n");
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    return in_lines(option->get_description(), help_width() - column_width_);
  }
  std::string make_subcommand(const CLI::App* command) const override {
    std::ostringstream out;
    CLI::detail::format_help(out, command->get_name(),
                             in_lines(command->get_description(), help_width() - column_width_),
                             column_width_);
    return out.str();
  }
};

// For a wrong command line: one line with the wrong word and what may have been meant, and one with the way to
// the help. `said`: the message of the parser or command.
std::string usage_error(const CLI::App& app, int argc, const char* const* argv, const std::string& said) {
  std::string who = "ifog", what = printable(said, kLongestMessage);
  const std::string_view first = argc > 1 ? argv[1] : "";
  const std::vector<std::string> commands = commands_of(app);
  if (std::ranges::count(commands, first) > 0) {
    who += " " + std::string(first);
    const CLI::App& command = *app.get_subcommand(std::string(first));
    what = plainly(command, what);
    if (const std::string unknown = unknown_option(command, argc, argv); !unknown.empty()) what = unknown;
  } else if (!first.starts_with('-')) {
    what =
        first.empty() ? "no command" : "unknown command " + in_quotes(first) + did_you_mean(first, commands);
    if (what.back() != '?') what += ", expected one of: " + boost::join(commands, ", ");
  }
  return who + ": " + what + "\n" + "`" + who + " --help` lists the options.\n";
}

// The content of --help as one JSON document, schema "ifog.command_line/1", from which manual pages and shell
// completion are made.
std::string describe(const CLI::App& app) {
  Json commands = Json::array();
  for (const CLI::App* const command : app.get_subcommands({}))
    commands.push_back({{"name", command->get_name()},
                        {"help", command->get_description()},
                        {"examples", command->get_footer()},
                        {"options", options_of(*command)}});
  const Json all = {{"schema", "ifog.command_line/1"},
                    {"name", app.get_name()},
                    {"version", app.version().substr(0, app.version().find('\n'))},
                    {"help", app.get_description()},
                    {"options", options_of(app)},
                    {"commands", commands}};
  return all.dump(2) + "\n";
}

// Returns the exit code; throws on errors.
int parse_and_run(int argc, char** argv, std::span<const AddCommand> commands) {
  typed = "ifog";
  words.assign(argv + std::min(argc, 1), argv + argc);
  for (int i = 1; i < argc; ++i) typed += " " + shell_word(argv[i]);
  CLI::App app{"ifog: Allan analysis, denoising, diagnosis, replay and monitoring of fibre-optic gyros",
               "ifog"};
  app.formatter(std::make_shared<HelpFormat>());
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text("ifog"));
  app.add_flag_callback(
      "--describe",
      [&app] {
        say("{}", describe(app));
        throw CLI::Success();
      },
      "Print every command with its options as JSON and exit");
  for (const AddCommand add : commands) add(Command(app));

  const std::vector<std::string> asked = with_help_as_option(app, argc, argv);
  std::vector<const char*> arguments;
  arguments.reserve(asked.size());
  for (const std::string& word : asked) arguments.push_back(word.c_str());
  const auto count = static_cast<int>(arguments.size());
  int status = 0;
  try {
    app.parse(count, arguments.data());
    if (const std::string written = written_in_words(); !written.empty()) say("{}\n", written);
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, complaint;  // the parser treats --help and --version as errors too
    status = app.exit(error, out, complaint) == 0 ? 0 : 2;
    say("{}", out.str());
    if (status != 0) warn("{}", usage_error(app, count, arguments.data(), error.what()));
  } catch (const WrongUsage& error) {
    status = 2;
    warn("{}", usage_error(app, count, arguments.data(), error.what()));
  } catch (const Failed&) {
    status = 1;
  }
  finish_saying();
  return status;
}

}  // namespace

std::string typed_command() { return typed; }

std::vector<std::string> typed_words() { return words; }

// Every exception of a command ends here: one line and exit code 1.
int run_command_line(int argc, char** argv, std::span<const AddCommand> commands) {
  try {
    prepare_standard_streams();
    return parse_and_run(argc, argv, commands);
  } catch (const std::bad_alloc&) {
    std::fputs("ifog: not enough memory\n", stderr);
  } catch (const ReaderGone&) {
    return kEndedBySigpipe;
  } catch (const std::exception& error) {
    warn("ifog: {}\n", printable(error.what(), kLongestMessage));
  } catch (...) {
    warn("ifog: failed for an unknown reason\n");
  }
  return 1;
}

}  // namespace ifog::tools
