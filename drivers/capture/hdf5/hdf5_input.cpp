// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/hdf5/hdf5_input.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace ifog {
namespace {

constexpr rlim_t kMostMemory = 2ULL << 30U;  // bytes, beside what the program had and a copy of the file
// Processor time from one block to the next, and how slowly a chunk may be unpacked besides.
constexpr std::size_t kMostSeconds = 5, kLeastUnpacked = 32U << 20U;  // s, bytes/s

std::string reason() { return std::generic_category().message(errno); }

void send_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw std::runtime_error("nobody listens");
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

bool receive_all(int fd, std::span<char> to) {
  while (!to.empty()) {
    const ssize_t n = ::read(fd, to.data(), to.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    to = to.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

// Bytes that this process may change by itself, as RLIMIT_DATA counts them.
rlim_t memory_in_use() {
  unsigned long pages = 0;
  if (std::FILE* const file = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(file, "%*u %*u %*u %*u %*u %lu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

// From here on this process can do no more than read the file: it dies with its parent, leaves no image of
// itself, and says nothing but by its pipe.
void shut_in(std::size_t image) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  prctl(PR_SET_DUMPABLE, 0);
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPROF, SIGINT, SIGTERM})
    ::signal(signal, SIG_DFL);
  ::signal(SIGPIPE, SIG_IGN);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const rlim_t most = memory_in_use() + image + kMostMemory;
  const rlimit nothing{0, 0}, memory{most, most};
  setrlimit(RLIMIT_CORE, &nothing);
  setrlimit(RLIMIT_FSIZE, &nothing);
  setrlimit(RLIMIT_DATA, &memory);
  // A library that finds its heap damaged says so on standard error.
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nowhere >= 0)
    for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, fd);
}

void allow_seconds(std::size_t chunk = 0) {
  const itimerval timer{{0, 0}, {static_cast<time_t>(kMostSeconds + chunk / kLeastUnpacked), 0}};
  setitimer(ITIMER_PROF, &timer, nullptr);
}

void send_columns(const Hdf5Source& source, const Hdf5Wanted& wanted, const SendBytes& send) {
  Hdf5Columns columns(source, wanted);
  allow_seconds(columns.chunk_bytes());
  columns.count_times_from_first();
  const Hdf5Header& header = columns.header();
  send_header(send, header);
  const std::uint64_t rows = std::min<std::uint64_t>(columns.block_rows(), header.rows);
  std::vector<double> values;
  for (std::uint64_t first = 0; first < header.rows; first += rows)
    for (std::size_t column = 0; column < header.names.size(); ++column) {
      values.resize(std::min(rows, header.rows - first));
      allow_seconds(columns.chunk_bytes());
      columns.read(column, first, values);
      send_values(send, values);
    }
}

// Never returns: nothing of the parent is ended here, no buffer of it written a second time.
[[noreturn]] void read_for(const Hdf5Source& source, const Hdf5Wanted& wanted, int to) {
  shut_in(source.image.size());
  allow_seconds();
  const SendBytes send = [to](std::string_view bytes) { send_all(to, bytes); };
  try {
    try {
      send_columns(source, wanted, send);
    } catch (const std::exception& error) {
      send_refusal(send, error.what());
    }
  } catch (...) {
    _exit(1);
  }
  _exit(0);
}

}  // namespace

Hdf5File::Hdf5File(InputFile& file) : path(file.path()) {
  struct stat info {};
  if (file.reopens() && stat(path.c_str(), &info) == 0) {
    bytes = static_cast<std::uint64_t>(info.st_size);
    return;
  }
  image = file.bytes();
  bytes = image.size();
}

Hdf5Input::Hdf5Input(const Hdf5File& file, const std::string& group, const std::vector<std::string>& names,
                     const std::string& time)
    : path_(file.path) {
  try {
    start({path_, file.image}, {group, names, time, file.bytes});
  } catch (...) {
    end();
    throw;
  }
}

void Hdf5Input::start(const Hdf5Source& source, const Hdf5Wanted& wanted) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(path_ + ": no pipe: " + reason());
  pipe_ = ends[0];
  reader_ = fork();
  if (reader_ == 0) read_for(source, wanted, ends[1]);
  ::close(ends[1]);
  if (reader_ < 0) throw std::runtime_error(path_ + ": no process to read it: " + reason());
  try {
    stream_ = std::make_unique<ColumnStream>([this](std::span<char> to) { return receive_all(pipe_, to); });
    const std::size_t wanted_count = wanted.names.size();
    if (wanted_count != 0 && header().names.size() != wanted_count) throw std::length_error("other columns");
  } catch (const std::exception& error) {
    refuse(error);
  }
}

bool Hdf5Input::next(std::vector<std::vector<double>>& block) {
  try {
    return stream_->next(block);
  } catch (const std::exception& error) {
    refuse(error);
  }
}

// What the reader said, or how it ended.
void Hdf5Input::refuse(const std::exception& why) {
  if (dynamic_cast<const std::length_error*>(&why) == nullptr)
    throw std::runtime_error(path_ + ": " + why.what());
  int status = 0;
  const pid_t reader = std::exchange(reader_, -1);
  ::kill(reader, SIGKILL);
  while (waitpid(reader, &status, 0) < 0 && errno == EINTR) continue;
  const bool slow = WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF;
  throw std::runtime_error(path_ + ": is damaged: the HDF5 library " +
                           (slow ? "comes to no end with it" : "breaks down over it"));
}

void Hdf5Input::end() {
  if (pipe_ >= 0) ::close(pipe_);
  pipe_ = -1;
  if (reader_ <= 0) return;
  ::kill(reader_, SIGKILL);
  while (waitpid(reader_, nullptr, 0) < 0 && errno == EINTR) continue;
  reader_ = -1;
}

Hdf5Input::~Hdf5Input() { end(); }

}  // namespace ifog
