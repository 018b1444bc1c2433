// SPDX-License-Identifier: Apache-2.0
#include "daemon/channels/number_file.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "drivers/ifog/decimal.h"

namespace ifog {

std::variant<double, ChannelFault> number_in(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t from = text.find_first_not_of(kBlank);
  if (from == std::string_view::npos) return ChannelFault{.kind = ChannelFault::Kind::empty};
  text = text.substr(from, text.find_last_not_of(kBlank) - from + 1);
  double number = 0.0;
  const auto [end, error] = read_decimal(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size())
    return ChannelFault{.kind = ChannelFault::Kind::no_number};
  return number;
}

namespace {

FileWriting writing_of(int fd, const struct stat& info) {
  struct statfs system {};
  FileWriting out{info.st_dev, info.st_ino, info.st_mtim.tv_sec * 1'000'000'000LL + info.st_mtim.tv_nsec,
                  true};
  if (fstatfs(fd, &system) != 0) return out;
  const auto type = static_cast<unsigned long>(system.f_type);
  out.made_at_each_read = type == SYSFS_MAGIC || type == PROC_SUPER_MAGIC || type == DEBUGFS_MAGIC;
  return out;
}

}  // namespace

std::variant<double, ChannelFault> read_number_file(const std::string& path, FileWriting& writing) {
  writing = {};
  const int fd = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (fd < 0) return ChannelFault{.kind = ChannelFault::Kind::unreadable, .error = errno};
  struct stat info {};
  if (fstat(fd, &info) != 0 || !S_ISREG(info.st_mode)) {
    close(fd);
    return ChannelFault{.kind = ChannelFault::Kind::no_file};
  }
  writing = writing_of(fd, info);
  std::array<char, 128> text{};
  const ssize_t length = ::read(fd, text.data(), text.size());
  const int error = errno;
  close(fd);
  if (length < 0) return ChannelFault{.kind = ChannelFault::Kind::unreadable, .error = error};
  // Too long for a number; its end would be missing.
  if (static_cast<std::size_t>(length) == text.size())
    return ChannelFault{.kind = ChannelFault::Kind::no_number};
  return number_in({text.data(), static_cast<std::size_t>(length)});
}

}  // namespace ifog
