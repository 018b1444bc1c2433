#include "filters/model_file/toml_file.h"

#include <stdexcept>

namespace ifog {

std::string one_line(std::string_view text) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7F)
      out += c;
    else if (c == '\n')
      out += "\\n";
    else if (c == '\t')
      out += "\\t";
    else
      out += std::string("\\x") + kHex[byte >> 4U] + kHex[byte & 15U];
  }
  return out;
}

toml::table parse_toml(std::string_view text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw std::runtime_error(name + ":" + std::to_string(error.source().begin.line) + ": " +
                             one_line(error.description()));
  }
}

}  // namespace ifog
