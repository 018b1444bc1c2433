// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "daemon/config/version_text.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/options/parser_texts.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

std::string typed;
std::vector<std::string> words;

// Exit code of a shell for a program that SIGPIPE ended.
constexpr int kEndedBySigpipe = 128 + 13;

// `ifog help [command]` is `ifog [command] --help`; the parser rejects unknown commands.
std::vector<std::string> with_help_as_option(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string> all(argv, argv + argc);
  if (all.size() < 2 || all[1] != "help") return all;
  all.erase(all.begin() + 1);
  all.resize(std::min<std::size_t>(all.size(), 2));
  const auto commands = app.get_subcommands({});
  if (all.size() == 1 || std::any_of(commands.begin(), commands.end(),
                                     [&](const CLI::App* command) { return command->get_name() == all[1]; }))
    all.emplace_back("--help");
  return all;
}

// Returns the exit code; throws on errors.
int parse_and_run(int argc, char** argv, std::span<const AddCommand> commands) {
  typed = "ifog";
  words.assign(argv + std::min(argc, 1), argv + argc);
  for (int i = 1; i < argc; ++i) typed += " " + shell_word(argv[i]);
  CLI::App app{"ifog: Allan analysis, denoising, diagnosis, replay and monitoring of fibre-optic gyros",
               "ifog"};
  app.formatter(help_format());
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
