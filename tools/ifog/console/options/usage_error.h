// SPDX-License-Identifier: Apache-2.0
// Messages for a wrong command line.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace ifog::tools {

// One line with the wrong word and what may have been meant, and one with the way to the help. `said`: the
// message of the parser or command.
std::string usage_error(const CLI::App& app, int argc, const char* const* argv, const std::string& said);

}  // namespace ifog::tools
