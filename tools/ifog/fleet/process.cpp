// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/process.h"

#include <fmt/core.h>

#include <fcntl.h>
#include <glib.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <memory>
#include <system_error>
#include <thread>

#include "drivers/system/fd.h"
#include "tools/ifog/console/errors.h"

namespace ifog::tools {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{5};

[[noreturn]] void refuse(const std::string& what, int error) {
  throw refusal("{}: {}", what, std::generic_category().message(error));
}

Fd opened(int fd, const std::string& name) {
  if (fd < 0) refuse(name + ": cannot be opened", errno);
  return Fd(fd);
}

struct Parent {
  pid_t process;
  bool ignores_hangup;  // as by nohup; glib resets it
};

// Runs in the child after glib's own setup.
void tie_to_parent(void* data) {
  const auto& parent = *static_cast<const Parent*>(data);
  if (parent.ignores_hangup) std::signal(SIGHUP, SIG_IGN);
  // The parent may have ended before this call.
  if (prctl(PR_SET_PDEATHSIG, SIGTERM) != 0 || getppid() != parent.process) _exit(1);
}

pid_t spawn(const std::vector<std::string>& words, int in, int out) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  struct sigaction hangup {};
  sigaction(SIGHUP, nullptr, &hangup);
  Parent parent{getpid(), hangup.sa_handler == SIG_IGN};
  GPid child = 0;
  GError* error = nullptr;
  if (g_spawn_async_with_fds(nullptr, arguments.data(), nullptr,
                             static_cast<GSpawnFlags>(G_SPAWN_DO_NOT_REAP_CHILD | G_SPAWN_SEARCH_PATH),
                             &tie_to_parent, &parent, &child, in, out, out, &error) != 0)
    return child;
  const std::unique_ptr<GError, decltype(&g_error_free)> owned(error, &g_error_free);
  throw refusal("{}: cannot be started: {}", words.front(), owned->message);
}

Fd memory(const char* name) { return opened(memfd_create(name, MFD_CLOEXEC), name); }

}  // namespace

std::string own_path() { return std::filesystem::read_symlink("/proc/self/exe").string(); }

pid_t start(const std::vector<std::string>& words, const std::string& said_path) {
  const Fd said =
      opened(::open(said_path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666), said_path);
  return spawn(words, -1, said);
}

std::string ending(int status) {
  if (WIFSIGNALED(status)) return "killed by signal " + std::to_string(WTERMSIG(status));
  return WEXITSTATUS(status) == 0 ? "" : "exit " + std::to_string(WEXITSTATUS(status));
}

Ran run_to_end(const std::vector<std::string>& words, const std::string& input,
               std::chrono::milliseconds patience) {
  const Fd in = memory("input"), out = memory("output");
  if (::write(in, input.data(), input.size()) != static_cast<ssize_t>(input.size()) ||
      ::lseek(in, 0, SEEK_SET) != 0)
    refuse(words.front() + ": no room for its input", errno);
  const pid_t child = spawn(words, in, out);
  const auto until = std::chrono::steady_clock::now() + patience;
  int status = 0;
  bool answered = false;
  while (!(answered = waitpid(child, &status, WNOHANG) == child) && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(kBetweenLooks);
  if (!answered) {
    kill(child, SIGKILL);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
  }
  Ran ran;
  ran.ended = answered
                  ? ending(status)
                  : fmt::format("no answer within {:g} s", std::chrono::duration<double>(patience).count());
  std::array<char, 4096> part{};
  for (ssize_t got = 0, at = 0; (got = ::pread(out, part.data(), part.size(), at)) > 0; at += got)
    ran.said.append(part.data(), static_cast<std::size_t>(got));
  return ran;
}

bool is_there(const std::string& program) {
  const std::unique_ptr<char, decltype(&g_free)> found(g_find_program_in_path(program.c_str()), &g_free);
  return found != nullptr;
}

}  // namespace ifog::tools
