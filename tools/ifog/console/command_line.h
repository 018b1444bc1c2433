// SPDX-License-Identifier: Apache-2.0
// The frame around the commands: arguments, help, what an error becomes on the way out.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/ifog/console/options/command.h"

namespace ifog::tools {

// Adds a command to the command line.
using AddCommand = void (*)(const Command& app);

// What was typed, as a shell takes it again: words that are no plain names in quotes. The program stands
// under its own name, wherever it lies. Empty before run_command_line().
std::string typed_command();

// The same word by word, unchanged, without the program.
std::vector<std::string> typed_words();

// main() of a program with these commands. Exit 0 good, 1 failed, 2 usage.
int run_command_line(int argc, char** argv, std::span<const AddCommand> commands);

}  // namespace ifog::tools
