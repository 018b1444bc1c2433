// SPDX-License-Identifier: Apache-2.0
// How others find the daemon that works with a state folder, whoever started it: it holds a lock on a file
// there for as long as it lives. A lock, unlike a number in a file, ends with its process however that ends.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

namespace ifog {

class RunningMark {
 public:
  RunningMark() = default;
  ~RunningMark();
  RunningMark(const RunningMark&) = delete;
  RunningMark& operator=(const RunningMark&) = delete;

  [[nodiscard]] bool is_set() const { return fd_ >= 0; }
  // Of this process, until it has succeeded. folder "": none. Gives a complaint, "" for none: no right to the
  // folder, or another daemon works with it, which is_taken() then says.
  [[nodiscard]] std::string set(const std::string& folder);
  [[nodiscard]] bool is_taken() const { return taken_; }

 private:
  int fd_ = -1;
  bool taken_ = false;
};

// The process that holds the mark; nothing: none does, or no daemon ever did. Throws std::runtime_error with
// one line when that cannot be seen.
[[nodiscard]] std::optional<pid_t> running_daemon(const std::string& folder);

}  // namespace ifog
