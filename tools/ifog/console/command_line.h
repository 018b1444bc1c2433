// SPDX-License-Identifier: Apache-2.0
// Runs a command: arguments, help, and the exit code of an error.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/ifog/console/command.h"

namespace ifog::tools {

// Adds a command to the command line.
using AddCommand = void (*)(const Command& app);

// The command line in shell syntax, with quotes where necessary and the program's name without a path. Empty
// before run_command_line().
std::string typed_command();

// Its words unchanged, without the program.
std::vector<std::string> typed_words();

// main() of a program with these commands. Exit codes: 0 success, 1 failure, 2 usage.
int run_command_line(int argc, char** argv, std::span<const AddCommand> commands);

}  // namespace ifog::tools
