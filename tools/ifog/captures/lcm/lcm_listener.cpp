// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/lcm/lcm_listener.h"

#include <boost/algorithm/string/case_conv.hpp>
#include <utility>

#include "daemon/config/lcm_url.h"
#include "drivers/ifog/quoted.h"
#include "tools/ifog/console/errors.h"

namespace ifog::tools {

namespace {

// LCM would print a text from the network unchanged.
const std::string& usable(const std::string& url) {
  const std::string expected =
      printable(url, kLongestMessage) == url ? lcm_url_complaint(url) : "no control characters";
  if (!expected.empty()) throw WrongUsage("--lcm-url", "is " + in_quotes(url) + ", expected " + expected);
  return url;
}

}  // namespace

LcmListener::LcmListener(const std::string& url, Handler handler)
    : handler_(std::move(handler)), lcm_(lcm_create(usable(url).c_str())) {
  if (lcm_ == nullptr) throw refusal("--lcm-url {}: LCM cannot use it", printable(url));
}

LcmListener::~LcmListener() { lcm_destroy(lcm_); }

void LcmListener::listen_to(const std::string& pattern) {
  lcm_subscription_t* const subscription = lcm_subscribe(lcm_, pattern.c_str(), &LcmListener::received, this);
  if (subscription == nullptr) throw refusal("\"{}\": no name LCM can listen to", printable(pattern));
  // Long enough that a slow terminal or disk loses no messages.
  lcm_subscription_set_queue_capacity(subscription, 100'000);
}

void LcmListener::listen_to_sensor(const std::string& name) {
  const std::string upper = boost::to_upper_copy(name);
  listen_to(upper.empty() ? "IFOG_.*" : "IFOG_" + upper + "(_STATUS|_IMU)?");
}

int LcmListener::descriptor() const { return lcm_get_fileno(lcm_); }

void LcmListener::take() {
  lcm_handle(lcm_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

// Called from C code: must not throw.
void LcmListener::received(const lcm_recv_buf_t* message, const char* channel, void* user) noexcept {
  auto* const self = static_cast<LcmListener*>(user);
  try {
    self->handler_(*message, channel);
  } catch (...) {
    if (!self->failure_) self->failure_ = std::current_exception();
  }
}

}  // namespace ifog::tools
