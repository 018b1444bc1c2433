// SPDX-License-Identifier: Apache-2.0
// `ifog replay` alone, the program that its tests run where they are built with sanitizers: all of ifog would
// be compiled for this one command.
#include "tests/unit/test.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command_line.h"

int main(int argc, char** argv) {
  constexpr std::array<ifog::tools::AddCommand, 1> kCommands{ifog::tools::add_replay};
  return ifog::tools::run_command_line(argc, argv, kCommands);
}
