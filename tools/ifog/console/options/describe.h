// SPDX-License-Identifier: Apache-2.0
// The command line as data: the content of --help, from which manual pages and shell completion are made.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace ifog::tools {

// One JSON document, schema "ifog.command_line/1".
std::string describe(const CLI::App& app);

}  // namespace ifog::tools
