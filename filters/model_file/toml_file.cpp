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

std::optional<SettingValue> setting_value(const toml::node& node) {
  if (const auto* const value = node.as_boolean()) return value->get();
  if (const auto* const value = node.as_integer()) return value->get();
  if (const auto* const value = node.as_floating_point()) return value->get();
  if (const auto* const value = node.as_string()) return value->get();
  const toml::array* const array = node.as_array();
  if (array == nullptr) return std::nullopt;
  std::vector<double> items;
  for (const toml::node& item : *array) {
    const auto value = item.value<double>();
    if (!item.is_number() || !value) return std::nullopt;
    items.push_back(*value);
  }
  return items;
}

}  // namespace ifog
