// TOML files as all programs here read them: a complaint is one line, whatever the file holds.
#pragma once

#include <toml++/toml.h>

#include <string>
#include <string_view>

namespace ifog {

// Throws std::runtime_error: "NAME:LINE: what is wrong".
toml::table parse_toml(std::string_view text, const std::string& name);

}  // namespace ifog
