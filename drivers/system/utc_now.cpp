// SPDX-License-Identifier: Apache-2.0
#include "drivers/system/utc_now.h"

#include <ctime>

namespace ifog {

std::string utc_now() { return utc_text(std::time(nullptr)); }

std::string utc_text(std::int64_t seconds, const char* form) {
  const std::time_t time = seconds;
  std::tm utc{};
  gmtime_r(&time, &utc);
  std::string text(32, '\0');
  text.resize(std::strftime(text.data(), text.size(), form, &utc));
  return text;
}

}  // namespace ifog
