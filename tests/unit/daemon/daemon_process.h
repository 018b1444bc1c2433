// SPDX-License-Identifier: Apache-2.0
// The daemon as a process, in a folder and a network of its own.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/unit/daemon/private_network.h"
#include "tests/unit/test.h"

namespace ifog {

namespace fs = std::filesystem;

inline constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

class DaemonProcess : public testing::Test, protected test::OwnFolder {
 protected:
  void SetUp() override {
    if (const std::string why = enter_private_network(); !why.empty())
      GTEST_SKIP() << "no private network namespace (" << why << "); runs as root or with user namespaces";
  }
  void TearDown() override {
    if (child_ > 0) kill(child_, SIGKILL);
    if (child_ > 0) waitpid(child_, nullptr, 0);
  }

  // All that the daemon has said to the file `said`.
  std::string said() const { return content("said"); }
  std::vector<std::string> lines_said() const {
    std::istringstream in(said());
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }
  int times_said(const std::string& text) const {
    const std::string all = said();
    int count = 0;
    for (std::size_t at = all.find(text); at != std::string::npos; at = all.find(text, at + 1)) ++count;
    return count;
  }

  // Runs to its end, at most for a minute, and writes `said` anew: its exit status.
  int ifogd(const std::string& arguments = "", const std::string& configuration = "ifogd.toml",
            const std::string& output = "said") const {
    const std::string command = "timeout 60 " IFOG_BINARY_DIR "/daemon/ifogd --config " +
                                path(configuration) + " " + arguments + " >" + path(output) + " 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  }
  // Runs in the background. nullptr: it has no standard error.
  void start(const char* stderr_to = "said") {
    child_ = fork();
    ASSERT_GE(child_, 0);
    if (child_ != 0) return;
    close(STDERR_FILENO);
    if (stderr_to != nullptr) open(path(stderr_to).c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    execl(IFOG_BINARY_DIR "/daemon/ifogd", "ifogd", "--config", path("ifogd.toml").c_str(), nullptr);
    _exit(127);
  }
  // Waits for the one in the background: its exit status, or 1000 and the signal that ended it.
  int wait_for_the_end() {
    int status = 0;
    waitpid(std::exchange(child_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  int end(int signal = SIGTERM) {
    kill(child_, signal);
    return wait_for_the_end();
  }

  pid_t child_ = -1;
};

}  // namespace ifog
