// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/lcm_url.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "drivers/transport/network/ip_socket.h"

namespace ifog {
namespace {

constexpr const char* kForm =
    "\"udpm://GROUP:PORT?ttl=N\", GROUP a multicast address 224.0.0.0 ... 239.255.255.255, PORT 1 ... 65535, "
    "ttl 0 ... 255; recv_buf_size=BYTES may follow behind &";

bool whole_number(std::string_view text, long least, long most) {
  long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && value >= least && value <= most;
}

bool is_option(std::string_view option) {
  const std::size_t equals = option.find('=');
  if (equals == std::string_view::npos) return false;
  const std::string_view key = option.substr(0, equals), value = option.substr(equals + 1);
  if (key == "ttl") return whole_number(value, 0, 255);
  return key == "recv_buf_size" && whole_number(value, 1, 2'000'000'000);
}

bool is_multicast(std::string_view place) {
  const std::size_t colon = place.find(':');
  if (colon == std::string_view::npos || !whole_number(place.substr(colon + 1), 1, 65535)) return false;
  const auto group = IpAddress::parse(std::string(place.substr(0, colon)));
  return group && !group->is_v6() && group->is_multicast();
}

}  // namespace

std::string lcm_url_complaint(const std::string& url) {
  constexpr std::array<std::string_view, 4> kLeftToLcm{"tcpq://", "memq://", "file://", "mpudpm://"};
  if (std::any_of(kLeftToLcm.begin(), kLeftToLcm.end(),
                  [&](std::string_view scheme) { return url.starts_with(scheme); }))
    return "";
  constexpr std::string_view kScheme = "udpm://";
  if (!url.starts_with(kScheme)) return kForm;
  std::string_view rest = std::string_view(url).substr(kScheme.size());
  const std::size_t mark = std::min(rest.find('?'), rest.size());
  // Default group and port of LCM.
  if (mark != 0 && !is_multicast(rest.substr(0, mark))) return kForm;
  rest.remove_prefix(mark);
  while (!rest.empty()) {
    rest.remove_prefix(1);  // '?' or '&'
    const std::size_t end = std::min(rest.find('&'), rest.size());
    if (!is_option(rest.substr(0, end))) return kForm;
    rest.remove_prefix(end);
  }
  return "";
}

}  // namespace ifog
