// SPDX-License-Identifier: Apache-2.0
// What the readers of all tables of a configuration share.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/config/table_reader.h"

namespace ifog {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr Range kNotNegative{0.0, kInfinity};

// Into the setting where the key was given.
template <typename T, typename U>
void take(std::optional<U>&& given, T& setting) {
  if (given) setting = static_cast<T>(std::move(*given));
}

// What the readers of all tables share.
struct ReadingContext {
  std::string file;
  std::filesystem::path folder;
  // Of a flight recording: what was once recorded is read, however little sense it made.
  bool recorded = false;
  std::vector<std::string> errors;

  // "-" is the standard input, not a file.
  [[nodiscard]] std::string absolute(const std::string& path) const {
    if (path.empty() || path == "-") return path;
    return (folder / path).lexically_normal().string();
  }
};

}  // namespace ifog
