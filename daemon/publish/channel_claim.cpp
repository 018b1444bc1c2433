// SPDX-License-Identifier: Apache-2.0
#include "daemon/publish/channel_claim.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace ifog {
namespace {

// FNV-1a hash of a text, as names are limited to 107 characters.
std::string short_name(const std::string& text) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  return std::to_string(hash);
}

}  // namespace

ChannelClaim::ChannelClaim(const std::string& lcm_url, const std::string& channel)
    : fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
  if (fd_ < 0) return;
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  // Starts with a zero: an abstract name, in no folder.
  const std::string text = "ifogd " + short_name(lcm_url + ' ' + channel);
  std::copy(text.begin(), text.end(), name.sun_path + 1);
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
  in_use_ = ::bind(fd_, reinterpret_cast<const sockaddr*>(&name), length) != 0 && errno == EADDRINUSE;
}

ChannelClaim::~ChannelClaim() {
  if (fd_ >= 0) ::close(fd_);
}

ChannelClaim::ChannelClaim(ChannelClaim&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), in_use_(other.in_use_) {}

}  // namespace ifog
