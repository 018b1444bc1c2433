// SPDX-License-Identifier: Apache-2.0
// The readers of a configuration's tables, and what they share.
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

// Into the setting where the key was given.
template <typename T, typename U>
void take(std::optional<U>&& given, T& setting) {
  if (given) setting = static_cast<T>(std::move(*given));
}

// What the readers of all tables share.
struct ReadingContext {
  std::string file;
  std::filesystem::path folder;
  // The configuration is a flight recording's: what was recorded is read, whether it is sensible or not.
  bool recorded = false;
  std::vector<std::string> errors;

  // "-" is the standard input, not a file.
  [[nodiscard]] std::string absolute(const std::string& path) const {
    if (path.empty() || path == "-") return path;
    return (folder / path).lexically_normal().string();
  }
};

// `where`: the table's key path. Complaints go into the context.
TransportConfig read_transport(const toml::table& table, const std::string& where, ReadingContext& context);
PublishedType read_publish(const toml::table& table, const std::string& where, ReadingContext& context);
ChannelConfig read_channel(const toml::table& table, const std::string& where, ReadingContext& context);
// minimum, maximum and max_step of values that are within ±most.
Limits read_limits(TableReader& in, double most, const ReadingContext& context);

// What no sensor shows alone: two that read one source and would take each other's bytes, and channels that
// lead a sensor's published rate back into its own correction. Complaints, one line each; no file is opened.
std::vector<std::string> shared_sources(const Config& config);
std::vector<std::string> feedback_loops(const Config& config);

}  // namespace ifog
