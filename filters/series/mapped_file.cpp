// SPDX-License-Identifier: Apache-2.0
#include "filters/series/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#ifndef MADV_POPULATE_READ
#define MADV_POPULATE_READ 22  // Linux 5.14; no effect before
#endif

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

  // file: of a writable mapping; nullopt: read-only.
  void add(const void* at, std::size_t bytes, std::optional<UnnamedFile> file) {
    {
      const std::lock_guard lock(guard_);
      mapped_.emplace(at, Mapped{bytes, std::move(file)});
      if (!thread_.joinable()) begin();
    }
    changed_.notify_one();
  }

  void remove(const void* at) {
    const std::lock_guard lock(guard_);
    mapped_.erase(at);
  }

  // The same, with its file.
  std::optional<UnnamedFile> take(const void* at) {
    const std::lock_guard lock(guard_);
    const auto mapped = mapped_.find(at);
    std::optional<UnnamedFile> file = std::move(mapped->second.file);
    mapped_.erase(mapped);
    return file;
  }

  struct Place {
    UnnamedFile* file;
    std::size_t offset;  // in bytes
  };
  // File and offset of a mapped address.
  Place place_of(const void* at) {
    const std::lock_guard lock(guard_);
    const auto mapped = std::prev(mapped_.upper_bound(at));
    return {&*mapped->second.file,
            static_cast<std::size_t>(static_cast<const char*>(at) - static_cast<const char*>(mapped->first))};
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
        for (const auto& [at, mapped] : mapped_)
          ::madvise(const_cast<void*>(at), mapped.bytes, MADV_DONTNEED);
    }
    if (statm >= 0) ::close(statm);
  }

  std::mutex guard_;
  std::condition_variable changed_;
  struct Mapped {
    std::size_t bytes;
    std::optional<UnnamedFile> file;
  };
  std::map<const void*, Mapped> mapped_;
  std::thread thread_;
  bool ends_ = false;
};

Resident& resident() {
  static Resident all;
  return all;
}

void* mapped(int fd, std::size_t bytes, int protection, std::optional<UnnamedFile> written = {}) {
  void* const at = ::mmap(nullptr, bytes, protection, MAP_SHARED, fd, 0);
  if (at == MAP_FAILED) UnnamedFile::fail("cannot map");
  try {
    resident().add(at, bytes, std::move(written));
  } catch (...) {
    ::munmap(at, bytes);
    throw;
  }
  return at;
}

// Sizes are rounded to sixteenths of a power of two, so that files of similar length can be reused.
std::size_t room_for(std::size_t bytes) {
  const std::size_t step = std::max<std::size_t>(std::bit_floor(bytes) / 16, 1);
  return (bytes + step - 1) / step * step;
}

struct Spare {
  void* at;
  std::size_t bytes;
};

void give_up(const Spare& spare) noexcept {
  resident().remove(spare.at);
  ::munmap(spare.at, spare.bytes);
}

// Creating a file costs more than writing it: its pages are allocated, zeroed, mapped and discarded. A
// diagnosis mostly allocates the size it has just released.
class Spares {
 public:
  Spares() { all_.reserve(kMostSpare); }

  // The file released last, whose pages are most likely resident; null if none has this size.
  void* take(std::size_t bytes) noexcept {
    const std::lock_guard lock(guard_);
    const auto found =
        std::find_if(all_.rbegin(), all_.rend(), [&](const Spare& each) { return each.bytes == bytes; });
    if (found == all_.rend()) return nullptr;
    void* const at = found->at;
    all_.erase(std::next(found).base());
    return at;
  }

  // The same for about this size.
  std::optional<Spare> take_about(std::size_t bytes) noexcept {
    const std::lock_guard lock(guard_);
    const auto found = std::find_if(all_.rbegin(), all_.rend(), [&](const Spare& each) {
      return each.bytes >= bytes / 2 && each.bytes / 2 <= bytes;
    });
    if (found == all_.rend()) return std::nullopt;
    const Spare spare = *found;
    all_.erase(std::next(found).base());
    return spare;
  }

  void keep(const Spare& spare) noexcept {
    const std::lock_guard lock(guard_);
    if (all_.size() == kMostSpare) {
      give_up(all_.front());
      all_.erase(all_.begin());
    }
    all_.push_back(spare);
  }

  // True if there were any.
  bool clear() noexcept {
    const std::lock_guard lock(guard_);
    const bool any = !all_.empty();
    for (const Spare& each : all_) give_up(each);
    all_.clear();
    return any;
  }

 private:
  std::mutex guard_;
  std::vector<Spare> all_;  // in order of release
};

Spares& spares() {
  static Spares all;
  return all;
}

void* map_new(std::size_t bytes) {
  UnnamedFile file;
  file.reserve(bytes);
  const int fd = file.descriptor();
  return mapped(fd, bytes, PROT_READ | PROT_WRITE, std::move(file));
}

}  // namespace

void* map_new_file(std::size_t bytes) {
  const std::size_t room = room_for(bytes);
  if (void* const spare = spares().take(room)) return spare;
  try {
    return map_new(room);
  } catch (const std::runtime_error&) {
    if (!spares().clear()) throw;
  }
  return map_new(room);
}

void unmap_new_file(void* at, std::size_t bytes) noexcept { spares().keep({at, room_for(bytes)}); }

std::optional<UnnamedFile> take_spare_file(std::size_t bytes) noexcept {
  const std::optional<Spare> spare = spares().take_about(bytes);
  if (!spare) return std::nullopt;
  std::optional<UnnamedFile> file = resident().take(spare->at);
  ::munmap(spare->at, spare->bytes);
  return file;
}

void write_new_file(void* to, const void* from, std::size_t bytes) {
  const Resident::Place place = resident().place_of(to);
  place.file->write(place.offset, from, bytes);
}

void read_new_file(void* to, const void* from, std::size_t bytes) {
  const Resident::Place place = resident().place_of(from);
  place.file->read(place.offset, to, bytes);
}

const void* map_file(const UnnamedFile& file, std::size_t bytes) {
  return mapped(file.descriptor(), bytes, PROT_READ);
}

void unmap_file(const void* at, std::size_t bytes) noexcept {
  resident().remove(at);
  ::munmap(const_cast<void*>(at), bytes);
}

void expect_reading(const void* at, std::size_t bytes) noexcept {
  const std::size_t into =
      reinterpret_cast<std::uintptr_t>(at) % static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  void* const page = static_cast<char*>(const_cast<void*>(at)) - into;
  ::madvise(page, bytes + into, MADV_POPULATE_READ);
}

}  // namespace ifog
