// SPDX-License-Identifier: Apache-2.0
#include "drivers/host/driver_instance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr std::size_t kErrorLength = 4096;
using ErrorText = std::array<char, kErrorLength>;

// Settings in the plugin's order with defaults.
std::vector<ifog_setting> complete(const ifog_driver& table, const DriverSettings& settings) {
  const std::string who = std::string("driver ") + table.name + ": ";
  std::vector<std::string_view> known;
  for (const ifog_option* option = table.options; option->key != nullptr; ++option)
    known.emplace_back(option->key);
  for (const auto& [key, value] : settings) {
    const ifog_option* option = table.options;
    while (option->key != nullptr && key != option->key) ++option;
    if (option->key == nullptr)
      throw std::runtime_error(who + "unknown option " + in_quotes(key) + " (value " + in_quotes(value) +
                               ")" + (known.empty() ? ", expected none" : meant_or_known(key, known)));
  }
  std::vector<ifog_setting> all;
  for (const ifog_option* option = table.options; option->key != nullptr; ++option) {
    const auto given = settings.find(option->key);
    if (given != settings.end())
      all.push_back({option->key, given->second.c_str()});
    else if (option->default_value != nullptr)
      all.push_back({option->key, option->default_value});
    else
      throw std::runtime_error(who + "option '" + option->key + "' is missing, expected " + option->values +
                               " (" + option->help + ")");
  }
  return all;
}

template <std::size_t N>
bool ended(const char (&name)[N]) {
  return std::memchr(name, '\0', N) != nullptr;
}

// Collects an encoder's output through C; a failed allocation is reported afterwards.
template <typename Item>
struct Collected {
  std::vector<Item>& out;
  std::exception_ptr thrown;

  void take(const Item* items, std::size_t count) noexcept {
    try {
      if (!thrown) out.insert(out.end(), items, items + count);
    } catch (...) {
      thrown = std::current_exception();
    }
  }
};

// Sizes and indices must be valid for any plugin.
std::string impossible(const ifog_description& d) {
  if (d.kind > IFOG_ANGLE) return "a kind that is none of rate, delta angle, angle";
  if (d.axes < 1 || d.axes > IFOG_MAX_AXES) return "a number of axes outside 1 … 3";
  for (std::uint32_t i = 0; i < d.axes; ++i)
    if (!ended(d.axis[i])) return "an axis name without end";
  if (d.environments > IFOG_MAX_ENVIRONMENT) return "more environment channels than the interface holds";
  for (std::uint32_t i = 0; i < d.environments; ++i)
    if (!ended(d.environment[i]) || d.environment[i][0] == '\0')
      return "an environment channel without a proper name";
  if (d.can_ids > IFOG_MAX_CAN_IDS) return "more CAN ids than the interface holds";
  if (!std::isfinite(d.nominal_rate_hz) || d.nominal_rate_hz < 0.0) return "a nominal rate that is no rate";
  if (!std::isfinite(d.angle_wrap_rad) || d.angle_wrap_rad < 0.0) return "an angle wrap that is no angle";
  for (std::uint32_t i = 0; i < d.axes; ++i)
    if (!std::isfinite(d.full_scale[i]) || d.full_scale[i] < 0.0) return "a full scale that is no rate";
  if (d.opening_length > sizeof d.opening) return "more opening bytes than the interface holds";
  std::set<std::string> columns{"time_s"};
  for (const std::string& name : capture_columns(d)) {
    const bool of_rate = columns.size() > d.axes && name.starts_with("rate_") && name.ends_with("radps");
    if (!columns.insert(name).second || of_rate)
      return "a channel or an axis by the name of another, of a rate or of the time: " + in_quotes(name);
  }
  return "";
}

}  // namespace

std::vector<std::string> capture_columns(const ifog_description& description) {
  std::vector<std::string> out;
  for (std::uint32_t i = 0; i < description.axes; ++i)
    out.push_back(description.axis[i][0] == '\0' ? "rate_radps"
                                                 : "rate_" + std::string(description.axis[i]) + "_radps");
  for (std::uint32_t i = 0; i < description.environments; ++i) out.emplace_back(description.environment[i]);
  return out;
}

DriverInstance::DriverInstance(std::shared_ptr<const Plugin> plugin, const DriverSettings& settings)
    : instance_(nullptr, Destroy{std::move(plugin)}) {
  const std::vector<ifog_setting> all = complete(table(), settings);
  ErrorText error{};
  instance_.reset(table().create(all.data(), all.size(), error.data(), error.size()));
  error.back() = '\0';
  if (instance_ == nullptr) {
    throw std::runtime_error(
        std::string("driver ") + table().name + ": " +
        (error[0] == '\0' ? "was not created and gave no reason" : printable(error.data(), kLongestMessage)));
  }
  for (std::string_view rest = error.data(); !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    warnings_.push_back(std::string("driver ") + table().name + ": " +
                        printable(rest.substr(0, end), kLongestMessage));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  table().describe(instance_.get(), &description_);
  if (const std::string what = impossible(description_); !what.empty())
    throw std::runtime_error(std::string("driver ") + table().name + ": describes " + what);
  portion_.asked = description_.sequence_modulus == 0 && description_.has_device_time == 0;
}

ifog_driver_counters DriverInstance::counters() const {
  ifog_driver_counters out{};
  table().counters(instance_.get(), &out);
  return out;
}

template <typename Item, typename Encode, typename Emit>
void DriverInstance::encode(Encode encoder, const char* to, const ifog_sample& sample, std::vector<Item>& out,
                            Emit emit) {
  const std::string who = std::string("driver ") + table().name + ": ";
  if (encoder == nullptr) throw std::runtime_error(who + "cannot encode to " + to);
  ErrorText error{};
  Collected<Item> collected{out, {}};
  const std::size_t before = out.size();
  const int failed = encoder(instance_.get(), &sample, emit, &collected, error.data(), error.size());
  if (collected.thrown) std::rethrow_exception(collected.thrown);
  if (failed == 0) return;
  out.resize(before);  // a sample is encoded completely or not at all
  throw std::runtime_error(who + printable(error.data(), kLongestMessage));
}

void DriverInstance::encode_bytes(const ifog_sample& sample, std::vector<std::uint8_t>& out) {
  encode(table().encode_bytes, "bytes", sample, out, [](void* to, const std::uint8_t* bytes, std::size_t n) {
    static_cast<Collected<std::uint8_t>*>(to)->take(bytes, n);
  });
}

void DriverInstance::encode_can(const ifog_sample& sample, std::vector<ifog_can_frame>& out) {
  encode(table().encode_can, "CAN frames", sample, out, [](void* to, const ifog_can_frame* frame) {
    static_cast<Collected<ifog_can_frame>*>(to)->take(frame, 1);
  });
}

std::vector<std::string> file_settings(const ifog_driver& table, const DriverSettings& settings) {
  std::vector<std::string> keys;
  for (const ifog_option* option = table.options; option->key != nullptr; ++option) {
    const auto given = settings.find(option->key);
    if (given != settings.end() && !given->second.empty() &&
        std::string_view(option->values) == IFOG_OPTION_FILE)
      keys.emplace_back(option->key);
  }
  return keys;
}

DriverSettings with_files_in(const std::filesystem::path& folder, const ifog_driver& table,
                             DriverSettings settings) {
  for (const std::string& key : file_settings(table, settings))
    settings[key] = (folder / settings[key]).lexically_normal().string();
  return settings;
}

DriverInstance make_driver(const std::string& name, const DriverSettings& settings,
                           const std::vector<std::string>& folders, const std::filesystem::path& files_from) {
  std::shared_ptr<const Plugin> plugin = find_plugin(name, folders);
  const DriverSettings placed = with_files_in(files_from, plugin->table(), settings);
  return DriverInstance(std::move(plugin), placed);
}

}  // namespace ifog
