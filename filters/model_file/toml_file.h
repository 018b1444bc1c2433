// SPDX-License-Identifier: Apache-2.0
// Reads TOML files; every error is one line.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <string_view>

#include "filters/settings/filter_table.h"

namespace ifog {

// Text of a file written by a user. Throws std::runtime_error with one line if it is missing, unreadable, too
// large, or not a regular file (a FIFO would block, a device may never end).
std::string read_toml_text(const std::string& path);

// Throws std::runtime_error: "NAME:LINE: error".
toml::table parse_toml(std::string_view text, const std::string& name);

// Value of a filter setting; nullopt for a node of another type.
std::optional<SettingValue> setting_value(const toml::node& node);

}  // namespace ifog
