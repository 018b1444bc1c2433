// SPDX-License-Identifier: Apache-2.0
// The command line as data: what --help tells people, for programs. The manual pages and the completion of
// the shell are made from it.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace ifog::tools {

// JSON, one document, schema "ifog.command_line/1".
std::string describe(const CLI::App& app);

}  // namespace ifog::tools
