// The frame around the commands: arguments, help, what an error becomes on the way out.
#pragma once

#include <span>

namespace CLI {
class App;
}

namespace ifog::tools {

// Adds a command to the command line.
using AddCommand = void (*)(CLI::App& app);

// main() of a program with these commands. Exit 0 good, 1 failed, 2 usage.
int run_command_line(int argc, char** argv, std::span<const AddCommand> commands);

}  // namespace ifog::tools
