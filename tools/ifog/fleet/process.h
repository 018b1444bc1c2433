// SPDX-License-Identifier: Apache-2.0
// Runs other programs without a shell.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace ifog::tools {

// Path of this program.
std::string own_path();

// Starts a program with empty standard input; its output is appended to a file. It gets SIGTERM when the
// thread that started it ends, for any reason. words: the first one is the program's path. Throws
// std::runtime_error with one line.
pid_t start(const std::vector<std::string>& words, const std::string& said_path);

// "" for success, otherwise "exit 1" or "killed by signal 9". status: of waitpid().
std::string ending(int status);

// Runs a program from PATH to its end with `input` on its standard input; kills it after `patience`.
struct Ran {
  std::string ended;  // as ending(), or "no answer within 120 s"
  std::string said;   // standard output and error
};
Ran run_to_end(const std::vector<std::string>& words, const std::string& input,
               std::chrono::milliseconds patience);

// True if PATH has a program of this name.
bool is_there(const std::string& program);

}  // namespace ifog::tools
