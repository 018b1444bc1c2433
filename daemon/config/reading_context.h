// SPDX-License-Identifier: Apache-2.0
// Readers of a configuration's tables, and their common context.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/config/config.h"
#include "daemon/config/table_reader.h"

namespace ifog {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr Range kNotNegative{0.0, kInfinity};

// Sets the value if the key was given.
template <typename T, typename U>
void take(std::optional<U>&& given, T& setting) {
  if (given) setting = static_cast<T>(std::move(*given));
}

// Common context of all table readers.
struct ReadingContext {
  std::string file;
  std::filesystem::path folder;
  // The configuration is from a flight recording, so it is accepted even if not sensible.
  bool recorded = false;
  std::vector<std::string> errors;

  // "-" is standard input, not a file.
  [[nodiscard]] std::string absolute(const std::string& path) const {
    if (path.empty() || path == "-") return path;
    return (folder / path).lexically_normal().string();
  }
};

// Tables of a sensor. Errors are added to the context.
TransportConfig read_transport(const toml::table& table, ReadingContext& context);
PublishedType read_publish(const toml::table& table, ReadingContext& context);
ChannelConfig read_channel(const toml::table& table, ReadingContext& context);
// Reads minimum, maximum and max_step; values are within ±most.
Limits read_limits(TableReader& in, double most, const ReadingContext& context);

// Errors of sensor combinations: two that read one source, and channels that feed a sensor's published rate
// back into its own correction. One line each; no file is opened.
std::vector<std::string> shared_sources(const Config& config);
std::vector<std::string> feedback_loops(const Config& config);

}  // namespace ifog
