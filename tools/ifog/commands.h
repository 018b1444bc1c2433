// SPDX-License-Identifier: Apache-2.0
// The commands of `ifog`. Each has its own file and adds itself to the command line.
#pragma once

#include "tools/ifog/console/command.h"

namespace ifog::tools {

void add_allan(const Command& program);
void add_simulate(const Command& program);
void add_compare(const Command& program);
void add_convert(const Command& program);
void add_denoise(const Command& program);
void add_drivers(const Command& program);
void add_monitor(const Command& program);
void add_picture(const Command& program);
void add_record(const Command& program);
void add_replay(const Command& program);
void add_tune(const Command& program);
void add_diagnose(const Command& program);
void add_status(const Command& program);
void add_proposals(const Command& program);
void add_adopt(const Command& program);
void add_revert(const Command& program);
void add_night(const Command& program);
void add_fleet(const Command& program);

}  // namespace ifog::tools
