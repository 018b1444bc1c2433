// SPDX-License-Identifier: Apache-2.0
// The commands of `ifog` that do not analyse records.
#include <array>

#include "tools/ifog/commands.h"
#include "tools/ifog/console/command_line.h"

int main(int argc, char** argv) {
  using namespace ifog::tools;
  constexpr std::array<AddCommand, 4> kCommands{add_convert, add_monitor, add_replay, add_simulate};
  return run_command_line(argc, argv, kCommands);
}
