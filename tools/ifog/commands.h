// SPDX-License-Identifier: Apache-2.0
// The commands of `ifog`. Each lives in a file of its own and adds itself to the command line.
#pragma once

#include <stdexcept>

namespace CLI {
class App;
}

namespace ifog::tools {

void add_allan(CLI::App& app);
void add_simulate(CLI::App& app);

// What a command throws after it has told the user why: exit code 1, no further message.
struct Failed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

void add_compare(CLI::App& app);
void add_convert(CLI::App& app);
void add_denoise(CLI::App& app);
void add_drivers(CLI::App& app);
void add_monitor(CLI::App& app);
void add_picture(CLI::App& app);
void add_record(CLI::App& app);
void add_replay(CLI::App& app);
void add_tune(CLI::App& app);
void add_diagnose(CLI::App& app);
void add_status(CLI::App& app);
void add_proposals(CLI::App& app);
void add_adopt(CLI::App& app);
void add_revert(CLI::App& app);
void add_night(CLI::App& app);
void add_fleet(CLI::App& app);

}  // namespace ifog::tools
