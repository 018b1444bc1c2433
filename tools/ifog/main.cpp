// SPDX-License-Identifier: Apache-2.0
// ifog: the command line. Exit codes: 0 success, 1 failure, 2 usage.
#include <array>

#include "tools/ifog/commands.h"
#include "tools/ifog/console/command_line.h"

int main(int argc, char** argv) {
  using namespace ifog::tools;
  // In the order of the help.
  constexpr std::array<AddCommand, 18> kCommands{
      add_allan,    add_compare, add_convert,   add_denoise, add_drivers,  add_monitor,
      add_picture,  add_record,  add_replay,    add_tune,    add_diagnose, add_fleet,
      add_simulate, add_status,  add_proposals, add_adopt,   add_revert,   add_night};
  return run_command_line(argc, argv, kCommands);
}
