// SPDX-License-Identifier: Apache-2.0
#include <lcm/lcm.h>

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

}  // namespace ifog
