// SPDX-License-Identifier: Apache-2.0
#include "filters/series/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>

namespace ifog {
namespace {

// A pass over a dozen columns maps in a gigabyte or two a second.
constexpr std::chrono::milliseconds kLook{5};

// Bytes of files that are mapped into the program's memory; 0 where the kernel does not say.
std::size_t resident_bytes(int statm) {
  std::array<char, 128> text{};
  const ssize_t n = ::pread(statm, text.data(), text.size() - 1, 0);
  if (n <= 0) return 0;
  char* at = text.data();
  std::strtoull(at, &at, 10);  // all
  std::strtoull(at, &at, 10);  // resident
  return std::strtoull(at, nullptr, 10) * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

class Resident {
 public:
  ~Resident() {
    {
      const std::lock_guard lock(guard_);
      ends_ = true;
    }
    changed_.notify_one();
    if (thread_.joinable()) thread_.join();
  }

  void add(const void* at, std::size_t bytes) {
    {
      const std::lock_guard lock(guard_);
      mapped_.emplace(at, bytes);
      if (!thread_.joinable()) begin();
    }
    changed_.notify_one();
  }

  void remove(const void* at) {
    const std::lock_guard lock(guard_);
    mapped_.erase(at);
  }

 private:
  void begin() {
    try {
      thread_ = std::thread([this] { watch(); });
    } catch (const std::system_error&) {
      // No thread to be had: what is mapped stays in memory until the kernel wants it.
    }
  }

  void watch() {
    const int statm = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    std::unique_lock lock(guard_);
    while (!ends_) {
      if (mapped_.empty())
        changed_.wait(lock, [this] { return ends_ || !mapped_.empty(); });
      else
        changed_.wait_for(lock, kLook, [this] { return ends_; });
      // Of a file that is shared, not private, this loses nothing: what was written is in the kernel's cache.
      if (resident_bytes(statm) > kMostResident)
        for (const auto& [at, bytes] : mapped_) ::madvise(const_cast<void*>(at), bytes, MADV_DONTNEED);
    }
    if (statm >= 0) ::close(statm);
  }

  std::mutex guard_;
  std::condition_variable changed_;
  std::map<const void*, std::size_t> mapped_;
  std::thread thread_;
  bool ends_ = false;
};

Resident& resident() {
  static Resident all;
  return all;
}

void* mapped(int fd, std::size_t bytes, int protection) {
  void* const at = ::mmap(nullptr, bytes, protection, MAP_SHARED, fd, 0);
  if (at == MAP_FAILED) UnnamedFile::fail("cannot map");
  try {
    resident().add(at, bytes);
  } catch (...) {
    ::munmap(at, bytes);
    throw;
  }
  return at;
}

}  // namespace

void* map_new_file(std::size_t bytes) {
  UnnamedFile file;
  file.reserve(bytes);
  return mapped(file.descriptor(), bytes, PROT_READ | PROT_WRITE);
}

const void* map_file(const UnnamedFile& file, std::size_t bytes) {
  return mapped(file.descriptor(), bytes, PROT_READ);
}

void unmap_file(const void* at, std::size_t bytes) noexcept {
  resident().remove(at);
  ::munmap(const_cast<void*>(at), bytes);
}

}  // namespace ifog
