// SPDX-License-Identifier: Apache-2.0
#include <lcm/lcm.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cerrno>
#include <cstddef>
#include <functional>
#include <stdexcept>

#include "daemon/publish/publisher.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

class LcmPublisher final : public Publisher {
 public:
  explicit LcmPublisher(const std::string& url) : lcm_(lcm_create(url.c_str())) {
    if (lcm_ == nullptr)
      throw std::runtime_error(
          "lcm_url = \"" + printable(url) +
          "\": LCM cannot use it; expected udpm://GROUP:PORT?ttl=N and a multicast route");
  }
  ~LcmPublisher() override { lcm_destroy(lcm_); }
  LcmPublisher(const LcmPublisher&) = delete;
  LcmPublisher& operator=(const LcmPublisher&) = delete;

  bool publish(const char* channel, std::span<const std::uint8_t> message) noexcept override {
    return lcm_publish(lcm_, channel, message.data(), static_cast<unsigned>(message.size())) == 0;
  }

 private:
  lcm_t* lcm_;
};

}  // namespace

std::unique_ptr<Publisher> make_lcm_publisher(const std::string& url) {
  return std::make_unique<LcmPublisher>(url);
}

// By an abstract socket name, in no folder, which the kernel gives to one process and releases when that ends.
std::optional<Fd> claim_channel(const std::string& lcm_url, const std::string& channel) {
  Fd fd(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  // A hash, as names are limited to 107 characters.
  const std::string text = "ifogd " + std::to_string(std::hash<std::string>()(lcm_url + ' ' + channel));
  text.copy(name.sun_path + 1, sizeof name.sun_path - 1);
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&name), length) != 0 && errno == EADDRINUSE)
    return std::nullopt;
  return fd;
}

}  // namespace ifog
