// SPDX-License-Identifier: Apache-2.0
#include "drivers/host/object_file.h"

#include <elf.h>
#include <fcntl.h>
#include <link.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "drivers/system/fd.h"

namespace ifog {
namespace {

template <typename Header>
bool read_at(int fd, std::uint64_t offset, Header& out) {
  return pread(fd, &out, sizeof out, static_cast<off_t>(offset)) == static_cast<ssize_t>(sizeof out);
}

std::string who_may_write(const std::string& path, const struct stat& info) {
  if ((info.st_mode & S_IWOTH) != 0)
    return "anybody may write it, expected a file that only its owner may change";
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  struct stat holder {};
  // The sticky bit protects files against replacement.
  if (stat(folder.c_str(), &holder) == 0 && (holder.st_mode & S_IWOTH) != 0 &&
      (holder.st_mode & S_ISVTX) == 0)
    return "anybody may write its folder, expected one that only its owner may change";
  return "";
}

bool whole(int file, std::uint64_t size) {
  ElfW(Ehdr) header{};
  constexpr unsigned char kClass = sizeof(void*) == 8 ? ELFCLASS64 : ELFCLASS32;
  if (!read_at(file, 0, header) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 ||
      header.e_ident[EI_CLASS] != kClass || header.e_phentsize != sizeof(ElfW(Phdr)))
    return true;
  for (unsigned i = 0; i < header.e_phnum; ++i) {
    ElfW(Phdr) segment{};
    if (!read_at(file, header.e_phoff + std::uint64_t{i} * sizeof segment, segment)) return false;
    if (segment.p_type != PT_LOAD) continue;
    if (segment.p_offset > size || segment.p_filesz > size - segment.p_offset) return false;
  }
  return true;
}

}  // namespace

std::string object_flaw(const std::string& path) {
  // Non-blocking: a FIFO is rejected without waiting.
  const Fd file(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
  struct stat info {};
  if (file < 0 || fstat(file, &info) != 0) return "cannot load: " + std::generic_category().message(errno);
  if (!S_ISREG(info.st_mode)) return "is no regular file";
  if (std::string flaw = who_may_write(path, info); !flaw.empty()) return flaw;
  if (!whole(file, static_cast<std::uint64_t>(info.st_size)))
    return "cannot load: shorter than its headers say (is the file cut off?)";
  return "";
}

}  // namespace ifog
