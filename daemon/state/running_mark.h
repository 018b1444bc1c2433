// SPDX-License-Identifier: Apache-2.0
// How others find the daemon that works with a state folder, whoever started it, and ask it. It holds a lock on a file there
// for as long as it lives: a lock, unlike a number in a file, ends with its process however that ends. And it answers
// `ifog status`, `adopt` and `revert` at a socket there: LCM knows no sender, here the kernel says at each end who is at the
// other. Who connects sends one letter, and reads to the end.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ifog {

enum class DaemonQuestion : char {
  status = 'S',  // answered by the statuses of all sensors, encoded, each behind its length in four bytes
  reload = 'R'   // answered by its complaints, nothing where it was done
};

class RunningMark {
 public:
  RunningMark() = default;
  ~RunningMark();
  RunningMark(const RunningMark&) = delete;
  RunningMark& operator=(const RunningMark&) = delete;

  [[nodiscard]] bool is_set() const { return fd_ >= 0; }
  // Marks this process as the running one. folder "": does nothing. Gives a complaint, "" for none: no right to the
  // folder, or another daemon works with it, which is_taken() then says.
  [[nodiscard]] std::string set(const std::string& folder);
  [[nodiscard]] bool is_taken() const { return taken_; }

  // The statuses that are answered from now on.
  void tell(const std::vector<std::string>& statuses);
  // Answers what can be answered, and never waits. True: somebody wants a reload.
  [[nodiscard]] bool serve();
  // To those who wanted it: what was refused, "" where all was done.
  void answer(const std::string& complaint);

 private:
  std::string listen_in(const std::string& folder);

  int fd_ = -1, socket_ = -1;
  bool taken_ = false;
  gid_t group_ = 0;                            // of the folder
  std::vector<std::pair<int, char>> clients_;  // and what each asks, 0 so far
  std::string statuses_;
};

// The process that holds the mark; nothing: none does, or no daemon ever did. Throws std::runtime_error with
// one line when that cannot be seen.
[[nodiscard]] std::optional<pid_t> running_daemon(const std::string& folder);

// What the process that holds the mark answers. Throws std::runtime_error with one line: no such socket, no right to it,
// another process at its other end, no answer within `most`.
[[nodiscard]] std::string ask_daemon(const std::string& folder, pid_t daemon, DaemonQuestion question,
                                     std::chrono::milliseconds most);

}  // namespace ifog
