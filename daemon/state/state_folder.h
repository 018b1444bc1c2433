// SPDX-License-Identifier: Apache-2.0
// The folder in which the daemon keeps what outlives a run, and what is called how in it.
#pragma once

#include <string>

namespace ifog {

// The folder as configured, else the first of the service manager's STATE_DIRECTORY, else "".
[[nodiscard]] std::string state_folder(const std::string& configured);

// Makes it, with the rights that it is installed with, where it is not there. Gives a complaint, "" for none;
// folder "": none.
[[nodiscard]] std::string make_state_folder(const std::string& folder);
// What make_state_folder() would complain of, by what is there now; makes nothing.
[[nodiscard]] std::string state_folder_complaint(const std::string& folder);

// The model of a sensor whose configuration names none.
[[nodiscard]] std::string adopted_model_path(const std::string& folder, const std::string& sensor);

}  // namespace ifog
