// SPDX-License-Identifier: Apache-2.0
// What to say of a command line that cannot be understood.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace ifog::tools {

// One line on what is wrong with it, naming the word and what may have been meant, and one on where help is.
// `said`: what the parser or the command made of it.
std::string usage_error(const CLI::App& app, int argc, const char* const* argv, const std::string& said);

}  // namespace ifog::tools
