// SPDX-License-Identifier: Apache-2.0
// A progress bar for anything that lasts over a second, on a terminal only; silent elsewhere.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace ifog::tools {

class Progress {
 public:
  Progress(const std::string& what, std::size_t total);
  ~Progress();  // clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void at(std::size_t done);  // cheap: redraws at most ten times a second

 private:
  std::string what_;
  std::size_t total_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace ifog::tools
