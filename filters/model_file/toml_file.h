// SPDX-License-Identifier: Apache-2.0
// TOML files as all programs here read them: a complaint is one line, whatever the file holds.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <string_view>

#include "filters/settings/filter_table.h"

namespace ifog {

// The text of a file that a person writes. Throws std::runtime_error with one line: not there, not readable,
// larger than any such file, or something that is no regular file: a FIFO would hold up who reads it, a
// device may never end.
std::string read_toml_text(const std::string& path);

// Throws std::runtime_error: "NAME:LINE: what is wrong".
toml::table parse_toml(std::string_view text, const std::string& name);

// As a filter's setting is read; nothing for a node of a type that no setting has.
std::optional<SettingValue> setting_value(const toml::node& node);

}  // namespace ifog
