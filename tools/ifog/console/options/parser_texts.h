// SPDX-License-Identifier: Apache-2.0
// What the parser knows of the command line, as text.
#pragma once

#include <memory>
#include <string>

namespace CLI {
class App;
class FormatterBase;
}  // namespace CLI

namespace ifog::tools {

// Layout of --help: the parser's, with lines as long as the terminal allows.
std::shared_ptr<CLI::FormatterBase> help_format();

// The content of --help as one JSON document, schema "ifog.command_line/1", from which manual pages and shell
// completion are made.
std::string describe(const CLI::App& app);

// For a wrong command line: one line with the wrong word and what may have been meant, and one with the way to
// the help. `said`: the message of the parser or command.
std::string usage_error(const CLI::App& app, int argc, const char* const* argv, const std::string& said);

}  // namespace ifog::tools
