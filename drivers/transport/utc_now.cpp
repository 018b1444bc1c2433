// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/utc_now.h"

#include <ctime>

namespace ifog {

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::string text(32, '\0');
  text.resize(std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc));
  return text;
}

}  // namespace ifog
