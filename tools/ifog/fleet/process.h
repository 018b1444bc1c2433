// SPDX-License-Identifier: Apache-2.0
// Other programs, started without a shell.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace ifog::tools {

// This program, wherever it lies.
std::string own_path();

// Its standard input is empty; what it says goes to the end of a file. It gets SIGTERM when the thread that
// started it is no more, however that ended. words: of which the first is the program's path. Throws
// std::runtime_error with one line.
pid_t start(const std::vector<std::string>& words, const std::string& said_path);

// "" for a good end, else in words: "exit 1", "killed by signal 9". status: of waitpid().
std::string ending(int status);

// Runs a program found by PATH to its end with `input` on its standard input; kills it after `patience`.
struct Ran {
  std::string ended;  // as ending(), or "no answer within 120 s"
  std::string said;   // standard output and error
};
Ran run_to_end(const std::vector<std::string>& words, const std::string& input,
               std::chrono::milliseconds patience);

// Whether PATH has a program of this name.
bool is_there(const std::string& program);

}  // namespace ifog::tools
