// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>

namespace ifog::tools {
namespace {

class FileActions {
 public:
  FileActions() { posix_spawn_file_actions_init(&actions_); }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;
  void copy(int from, int to) { posix_spawn_file_actions_adddup2(&actions_, from, to); }
  [[nodiscard]] const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

std::vector<char*> arguments_of(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  return arguments;
}

[[noreturn]] void refuse(const std::vector<std::string>& words, int error) {
  throw std::runtime_error(words.front() + ": cannot be started: " + std::strerror(error));
}

pid_t spawn(const std::vector<std::string>& words, const FileActions& actions) {
  const std::vector<char*> arguments = arguments_of(words);
  pid_t child = 0;
  const int error =
      posix_spawnp(&child, words.front().c_str(), actions.get(), nullptr, arguments.data(), environ);
  if (error != 0) refuse(words, error);
  return child;
}

struct Pipe {
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
      throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_end(std::size_t end) {
    if (ends[end] >= 0) close(ends[end]);
    ends[end] = -1;
  }
  std::array<int, 2> ends{-1, -1};
};

std::string read_all(int from) {
  std::string text;
  std::array<char, 4096> part{};
  for (;;) {
    const ssize_t got = read(from, part.data(), part.size());
    if (got > 0)
      text.append(part.data(), static_cast<std::size_t>(got));
    else if (got == 0 || errno != EINTR)
      return text;
  }
}

// All that comes; false where its end has not come by then.
bool read_until(int from, std::chrono::steady_clock::time_point until, std::string& text) {
  std::array<char, 4096> part{};
  for (;;) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now()).count();
    if (left <= 0) return false;
    pollfd ready{from, POLLIN, 0};
    const int came = poll(&ready, 1, static_cast<int>(std::min<std::int64_t>(left, INT_MAX)));
    if (came <= 0) continue;
    const ssize_t got = read(from, part.data(), part.size());
    if (got > 0)
      text.append(part.data(), static_cast<std::size_t>(got));
    else if (got == 0 || errno != EINTR)
      return true;
  }
}

bool open_as(int descriptor, const char* path, int flags) {
  const int opened = open(path, flags, 0666);
  if (opened < 0 || opened == descriptor) return opened >= 0;
  const bool copied = dup2(opened, descriptor) >= 0;
  close(opened);
  return copied;
}

// In the child, where only what is safe in a signal's handler is. posix_spawn() cannot ask for the signal.
[[noreturn]] void become(const std::vector<char*>& arguments, const char* said_path, pid_t parent,
                         int error) {
  std::signal(SIGTERM, SIG_DFL);  // until then the parent's handler would swallow it
  const bool tied = prctl(PR_SET_PDEATHSIG, SIGTERM) == 0;
  if (getppid() != parent) _exit(1);  // it died before it could be asked for
  if (tied && open_as(STDIN_FILENO, "/dev/null", O_RDONLY) &&
      open_as(STDOUT_FILENO, said_path, O_WRONLY | O_CREAT | O_APPEND) &&
      dup2(STDOUT_FILENO, STDERR_FILENO) >= 0)
    execve(arguments.front(), arguments.data(), environ);
  const int number = errno;
  if (write(error, &number, sizeof(number)) < 0) _exit(2);
  _exit(1);
}

}  // namespace

std::string own_path() { return std::filesystem::read_symlink("/proc/self/exe").string(); }

pid_t start(const std::vector<std::string>& words, const std::string& said_path) {
  const std::vector<char*> arguments = arguments_of(words);
  Pipe error;  // closed by the program that takes over, or told why none does
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) refuse(words, errno);
  if (child == 0) become(arguments, said_path.c_str(), parent, error.ends[1]);
  error.close_end(1);
  const std::string why = read_all(error.ends[0]);
  if (why.empty()) return child;
  while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
  int number = 0;
  std::memcpy(&number, why.data(), std::min(why.size(), sizeof(number)));
  refuse(words, number);
}

std::string ending(int status) {
  if (WIFSIGNALED(status)) return "killed by signal " + std::to_string(WTERMSIG(status));
  return WEXITSTATUS(status) == 0 ? "" : "exit " + std::to_string(WEXITSTATUS(status));
}

Ran run_to_end(const std::vector<std::string>& words, const std::string& input,
               std::chrono::milliseconds patience) {
  Pipe in, out;
  FileActions actions;
  actions.copy(in.ends[0], STDIN_FILENO);
  actions.copy(out.ends[1], STDOUT_FILENO);
  actions.copy(out.ends[1], STDERR_FILENO);
  const pid_t child = spawn(words, actions);
  in.close_end(0);
  out.close_end(1);
  // All of it fits into the pipe, so that nobody waits for anybody; SIGPIPE is ignored from the start.
  for (std::size_t at = 0; at < input.size();) {
    const ssize_t sent = write(in.ends[1], input.data() + at, input.size() - at);
    if (sent < 0 && errno != EINTR) break;  // it did not want it; its end says why
    if (sent > 0) at += static_cast<std::size_t>(sent);
  }
  in.close_end(1);
  Ran ran;
  const bool answered = read_until(out.ends[0], std::chrono::steady_clock::now() + patience, ran.said);
  if (!answered) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  ran.ended = ending(status);
  if (!answered) {
    std::ostringstream words_for_it;
    words_for_it << "no answer within " << std::chrono::duration<double>(patience).count() << " s";
    ran.ended = words_for_it.str();
  }
  return ran;
}

bool is_there(const std::string& program) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (!folder.empty() && access((folder + "/" + program).c_str(), X_OK) == 0) return true;
  return false;
}

}  // namespace ifog::tools
