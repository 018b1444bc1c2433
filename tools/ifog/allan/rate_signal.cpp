// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/allan/rate_signal.h"

#include <string_view>

namespace ifog::tools {

bool signal_of(const std::string& column, std::string& signal, std::string& axis) {
  constexpr std::string_view kUnit = "_radps";
  for (const char* prefix : {"rate", "raw", "compensated", "denoised"}) {
    const std::string start = prefix;
    if (!column.starts_with(start) || !column.ends_with(kUnit)) continue;
    if (column.size() < start.size() + kUnit.size()) continue;
    const std::string middle = column.substr(start.size(), column.size() - start.size() - kUnit.size());
    if (!middle.empty() &&
        (middle.size() < 2 || middle[0] != '_' || middle.find('_', 1) != std::string::npos))
      continue;
    signal = start;
    axis = middle.empty() ? "" : middle.substr(1);
    return true;
  }
  return false;
}

}  // namespace ifog::tools
