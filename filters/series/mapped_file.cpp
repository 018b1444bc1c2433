// SPDX-License-Identifier: Apache-2.0
#include "filters/series/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <iterator>
#include <map>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace ifog {
namespace {

// A pass over a dozen columns maps 1 to 2 GB/s.
constexpr std::chrono::milliseconds kLook{5};

// Bytes of mapped files in the program's memory; 0 if the kernel does not tell.
std::size_t resident_bytes(int statm) {
  std::array<char, 128> text{};
  const ssize_t n = ::pread(statm, text.data(), text.size() - 1, 0);
  if (n <= 0) return 0;
  char* at = text.data();
  std::strtoull(at, &at, 10);  // total
  std::strtoull(at, &at, 10);  // resident
  return std::strtoull(at, nullptr, 10) * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

// Releases pages of the mapped files.
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

  // bytes: of the file, which are mapped from `at` on.
  void set(void* at, std::size_t bytes) {
    const std::lock_guard lock(guard_);
    if (mapped_.empty()) changed_.notify_one();
    mapped_[at] = bytes;
    if (!thread_.joinable()) begin();
  }

  void remove(void* at) {
    const std::lock_guard lock(guard_);
    mapped_.erase(at);
  }

 private:
  void begin() {
    try {
      thread_ = std::thread([this] { watch(); });
    } catch (const std::system_error&) {
      // Without a thread, pages stay until the kernel evicts them.
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
      // The mapping is shared, so written data stay in the page cache.
      if (resident_bytes(statm) > kMostResident)
        for (const auto& [at, bytes] : mapped_) ::madvise(at, bytes, MADV_DONTNEED);
    }
    if (statm >= 0) ::close(statm);
  }

  std::mutex guard_;
  std::condition_variable changed_;
  std::map<void*, std::size_t> mapped_;
  std::thread thread_;
  bool ends_ = false;
};

Resident& resident() {
  static Resident all;
  return all;
}

// Creating a file costs more than writing it: its pages are allocated, zeroed and discarded. A diagnosis
// mostly needs the size that it has just released.
class Spares {
 public:
  Spares() { all_.reserve(kMostSpare); }

  // The one released last of half to twice this size, whose pages are most likely in memory; else a new file.
  UnnamedFile take(std::size_t bytes) {
    const std::lock_guard lock(guard_);
    const auto found = std::find_if(all_.rbegin(), all_.rend(), [&](const UnnamedFile& each) {
      return each.size() >= bytes / 2 && each.size() / 2 <= bytes;
    });
    if (found == all_.rend()) return {};
    UnnamedFile file = std::move(*found);
    all_.erase(std::next(found).base());
    return file;
  }

  void keep(UnnamedFile file) noexcept {
    const std::lock_guard lock(guard_);
    if (all_.size() == kMostSpare) all_.erase(all_.begin());
    all_.push_back(std::move(file));
  }

  // True if there were any.
  bool clear() noexcept {
    const std::lock_guard lock(guard_);
    const bool any = !all_.empty();
    all_.clear();
    return any;
  }

 private:
  std::mutex guard_;
  std::vector<UnnamedFile> all_;  // in order of release
};

Spares& spares() {
  static Spares all;
  return all;
}

// At this address, or at any for nullptr.
char* mapped(char* at, std::size_t bytes, int protection, int flags, int fd = -1, std::size_t offset = 0) {
  void* const made =
      ::mmap(at, bytes, protection, flags | (at != nullptr ? MAP_FIXED : 0), fd, static_cast<off_t>(offset));
  if (made == MAP_FAILED) UnnamedFile::fail("cannot map");
  return static_cast<char*>(made);
}

char* mapped_memory(char* at, std::size_t bytes) {
  return mapped(at, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS);
}

}  // namespace

MappedFile::MappedFile(std::size_t expected) : file_(spares().take(expected)) {
  reserve((expected / kPiece + 2) * kPiece);
}

MappedFile::~MappedFile() {
  resident().remove(at_);
  ::munmap(at_, reserved_);
  spares().keep(std::move(file_));
}

void MappedFile::reserve(std::size_t bytes) {
  char* const to = mapped(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE);
  if (filed_ > 0) mapped(to, filed_, PROT_READ | PROT_WRITE, MAP_SHARED, file_.descriptor());
  char* const piece = mapped_memory(to + filed_, kPiece);
  if (at_ != nullptr) {
    std::copy_n(at_ + filed_, kPiece, piece);
    resident().remove(at_);
    ::munmap(at_, reserved_);
  }
  at_ = to;
  reserved_ = bytes;
  resident().set(at_, filed_);
}

void MappedFile::extend() {
  if (filed_ + 2 * kPiece > reserved_) reserve(2 * reserved_);
  char* const piece = at_ + filed_;
  try {
    file_.write(filed_, piece, kPiece);
  } catch (const std::runtime_error&) {
    if (!spares().clear()) throw;
    file_.write(filed_, piece, kPiece);
  }
  // The piece keeps its pages, because new ones cost more than the write. Its old addresses stay mapped until the
  // file replaces them: another thread might map something into a hole. Before Linux 5.7 the pages are new.
  if (::mremap(piece, kPiece, kPiece, MREMAP_MAYMOVE | MREMAP_FIXED | MREMAP_DONTUNMAP, piece + kPiece) ==
      MAP_FAILED)
    mapped_memory(piece + kPiece, kPiece);
  mapped(piece, kPiece, PROT_READ | PROT_WRITE, MAP_SHARED, file_.descriptor(), filed_);
  filed_ += kPiece;
  resident().set(at_, filed_);
}

}  // namespace ifog
