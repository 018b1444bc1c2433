// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/words.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>

namespace ifog {

std::string printed(const char* format, ...) {
  std::array<char, 512> text{};
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(text.data(), text.size(), format, values);
  va_end(values);
  return text.data();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace ifog
