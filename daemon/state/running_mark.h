// SPDX-License-Identifier: Apache-2.0
// Mark of a running daemon in its state folder, and a socket for questions. The mark is a lock on a file,
// which ends with the process. The socket answers `ifog status`, `adopt` and `revert`; unlike LCM it
// identifies both ends. A client sends one letter and reads to the end.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/system/fd.h"

namespace ifog {

enum class DaemonQuestion : char {
  status = 'S',  // answer: the encoded statuses of all sensors, each after its length in four bytes
  reload = 'R'   // answer: the errors, empty on success
};

class RunningMark {
 public:
  [[nodiscard]] bool is_set() const { return fd_ >= 0; }
  // Marks this process as the running one. folder "": does nothing. Returns "" or an error: no permission for
  // the folder, or another daemon uses it (then in_use() is true).
  [[nodiscard]] std::string set(const std::string& folder);
  [[nodiscard]] bool in_use() const { return in_use_; }

  // Statuses for later answers.
  void tell(const std::vector<std::string>& statuses);
  // Answers without waiting. True: a reload is requested.
  [[nodiscard]] bool serve();
  // Answers those who requested it: the errors, or "".
  void answer(const std::string& complaint);

 private:
  std::string listen_in(const std::string& folder);

  Fd fd_, socket_;
  bool in_use_ = false;
  gid_t group_ = 0;                           // of the folder
  std::vector<std::pair<Fd, char>> clients_;  // with their question, 0 if not yet received
  std::string statuses_;
};

// Process with the mark; nullopt if none. Throws std::runtime_error with one line if it cannot be determined.
[[nodiscard]] std::optional<pid_t> running_daemon(const std::string& folder);

// Answer of the process with the mark. Throws std::runtime_error with one line: no socket, no permission,
// another process at its end, no answer within `most`.
[[nodiscard]] std::string ask_daemon(const std::string& folder, pid_t daemon, DaemonQuestion question,
                                     std::chrono::milliseconds most);

}  // namespace ifog
