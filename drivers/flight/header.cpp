// SPDX-License-Identifier: Apache-2.0
#include "drivers/flight/header.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <stdexcept>

#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr std::size_t kFixed = 10;  // u64 file, u16 version
constexpr const char* kCarries[] = {"bytes", "can", "messages"};

std::string escaped(std::string_view value) {
  std::string out;
  for (const char c : value) {
    if (c == '\\' || c == '\n') out += '\\';
    out += c == '\n' ? 'n' : c;
  }
  return out;
}

std::string unescaped(std::string_view value) {
  std::string out;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const bool escape = value[i] == '\\' && i + 1 < value.size();
    i += escape ? 1 : 0;
    out += escape && value[i] == 'n' ? '\n' : value[i];
  }
  return out;
}

[[noreturn]] void refuse(std::string_view key, const std::string& value, const char* expected) {
  throw std::runtime_error("its header says " + std::string(key) + " = " + in_quotes(value) + ", expected " +
                           expected);
}

template <typename T>
T number(std::string_view key, const std::string& text) {
  T out{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (error != std::errc() || end != text.data() + text.size()) refuse(key, text, "a whole number");
  return out;
}

// Keys with plain text values, and with numbers; missing ones are empty or 0.
template <typename T>
struct Key {
  std::string_view key;
  T FlightHeader::*value;
};
constexpr Key<std::string> kTexts[] = {{"program", &FlightHeader::program},
                                       {"sensor", &FlightHeader::sensor},
                                       {"source", &FlightHeader::source},
                                       {"driver", &FlightHeader::driver},
                                       {"configuration_file", &FlightHeader::configuration_file},
                                       {"configuration", &FlightHeader::configuration},
                                       {"boot", &FlightHeader::boot},
                                       {"interface", &FlightHeader::interface}};
constexpr Key<std::uint64_t> kNumbers[] = {
    {"run", &FlightHeader::run}, {"number", &FlightHeader::number}, {"began", &FlightHeader::began}};

void take(FlightHeader& out, std::string_view key, std::string value) {
  constexpr std::string_view kOption = "option.", kFile = "file.";
  for (const auto& each : kTexts)
    if (key == each.key) out.*each.value = value;
  for (const auto& each : kNumbers)
    if (key == each.key) out.*each.value = number<std::uint64_t>(key, value);
  if (key == "settings") out.settings = number<std::uint32_t>(key, value);
  if (key == "opened_ns") out.opened_ns = number<std::int64_t>(key, value);
  if (key == "powered_ns") {
    out.powered_ns = number<std::int64_t>(key, value);
    // Differences of times since 1970 do not overflow.
    if (*out.powered_ns < 0) refuse(key, value, "a time since 1970");
  }
  if (key == "channel") out.channels.push_back(value);
  if (key.starts_with(kOption)) out.options[unescaped(key.substr(kOption.size()))] = value;
  if (key.starts_with(kFile)) out.files[unescaped(key.substr(kFile.size()))] = value;
  if (key == "carries") {
    const auto* const found = std::find(std::begin(kCarries), std::end(kCarries), value);
    if (found == std::end(kCarries)) refuse(key, value, "bytes, can or messages");
    out.carries = static_cast<FlightHeader::Carries>(found - std::begin(kCarries));
  }
}

}  // namespace

std::vector<std::uint8_t> header_payload(const FlightHeader& header) {
  std::string text;
  // A key ends at the first '='; option names and paths must not contain one.
  const auto add = [&text](const std::string& key, std::string_view value) {
    text += key + "=" + escaped(value) + "\n";
  };
  const auto add_named = [&](const char* kind, const auto& named) {
    for (const auto& [name, value] : named)
      if (name.find('=') == std::string::npos) add(kind + escaped(name), value);
  };
  for (const auto& each : kTexts)
    if (!(header.*each.value).empty()) add(std::string(each.key), header.*each.value);
  add("carries", kCarries[static_cast<int>(header.carries)]);
  add_named("option.", header.options);
  for (const std::string& channel : header.channels) add("channel", channel);
  add("run", std::to_string(header.run));
  add("number", std::to_string(header.number));
  if (header.began != 0) add("began", std::to_string(header.began));
  if (header.settings != 0) add("settings", std::to_string(header.settings));
  add("opened_ns", std::to_string(header.opened_ns));
  if (header.powered_ns) add("powered_ns", std::to_string(*header.powered_ns));
  add_named("file.", header.files);
  std::vector<std::uint8_t> out(kFixed + text.size());
  std::memcpy(out.data(), &header.file, sizeof header.file);
  std::memcpy(out.data() + sizeof header.file, &kFlightVersion, sizeof kFlightVersion);
  std::copy(text.begin(), text.end(), out.begin() + kFixed);
  return out;
}

FlightHeader parse_header(std::span<const std::uint8_t> payload) {
  FlightHeader out;
  std::uint16_t version = 0;
  if (payload.size() < kFixed) throw std::runtime_error("its header is cut off");
  std::memcpy(&out.file, payload.data(), sizeof out.file);
  std::memcpy(&version, payload.data() + sizeof out.file, sizeof version);
  if (version != kFlightVersion)
    throw std::runtime_error("is a flight recording of version " + std::to_string(version) +
                             ", expected version " + std::to_string(kFlightVersion));
  std::string_view text(reinterpret_cast<const char*>(payload.data()) + kFixed, payload.size() - kFixed);
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos)
      throw std::runtime_error("its header has the line " + in_quotes(line) + ", expected KEY=VALUE");
    take(out, line.substr(0, equals), unescaped(line.substr(equals + 1)));
  }
  return out;
}

}  // namespace ifog
