#include "filters/model_file/toml_file.h"

#include <stdexcept>

#include "drivers/ifog/quoted.h"

namespace ifog {

toml::table parse_toml(std::string_view text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw std::runtime_error(name + ":" + std::to_string(error.source().begin.line) + ": " +
                             printable(error.description(), kLongestMessage));
  }
}

}  // namespace ifog
