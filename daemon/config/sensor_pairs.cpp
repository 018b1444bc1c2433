// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/reading_context.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

#include "daemon/config/lcm_field_name.h"
#include "drivers/ifog/quoted.h"
#include "drivers/transport/network/ip_socket.h"
#include "msgs/channel_name.h"

namespace ifog {
namespace {

using Kind = TransportConfig::Kind;

std::string complaint(const Config& config, const SensorConfig& sensor, const std::string& key,
                      const std::string& what) {
  return config.file + ":" + std::to_string(sensor.line_of(key)) + ": " +
         printable("sensor." + key + what, kLongestMessage);
}

// Device, FIFO or standard input of a transport; "" if several readers are possible.
std::string device_of(const TransportConfig& transport) {
  if (transport.kind == Kind::serial) return transport.serial.device;
  if (transport.kind != Kind::file) return "";
  struct stat info {};
  const bool regular = stat(transport.file.path.c_str(), &info) != 0 || S_ISREG(info.st_mode);
  return transport.file.path != "-" && regular ? "" : transport.file.path;
}

// Compares devices behind names: udev links, and standard input.
bool same_device(std::string a, std::string b) {
  if (a.empty() || b.empty()) return false;
  for (std::string* const name : {&a, &b})
    if (*name == "-") *name = "/dev/stdin";
  if (a == b) return true;
  struct stat of_a {
  }, of_b{};
  if (stat(a.c_str(), &of_a) == 0 && stat(b.c_str(), &of_b) == 0)
    return of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
  // If it does not exist, only the names are compared.
  std::error_code failed;
  const auto place = std::filesystem::weakly_canonical(a, failed);
  return !failed && place == std::filesystem::weakly_canonical(b, failed) && !failed;
}

// Compares addresses in any notation, with the same interface, which need not exist now.
bool same_address(const std::string& a, const std::string& b) {
  const std::size_t end_a = std::min(a.find('%'), a.size()), end_b = std::min(b.find('%'), b.size());
  const auto first = IpAddress::parse(a.substr(0, end_a)), second = IpAddress::parse(b.substr(0, end_b));
  socklen_t size = 0;
  const auto place = second ? second->at_port(1, "", size) : std::nullopt;
  return a == b || (first && place && first->is_host_of(*place) && a.substr(end_a) == b.substr(end_b));
}

bool is_v6(const UdpSettings& udp) {
  for (const std::string& address : {udp.group, udp.bind, udp.host})
    if (const auto parsed = IpAddress::parse(address)) return parsed->is_v6();
  return false;
}

bool any_address(const UdpSettings& udp) {
  return udp.bind.empty() || same_address(udp.bind, "0.0.0.0") || same_address(udp.bind, "::");
}

// True if one of two sockets could not be bound, or would get the other's datagrams. Members of a group all
// get copies.
bool same_port(const UdpSettings& a, const UdpSettings& b) {
  if (a.port != b.port || a.port == 0 || is_v6(a) != is_v6(b)) return false;
  if (!a.group.empty() && !b.group.empty()) return false;
  if (a.group.empty() && b.group.empty())
    return any_address(a) || any_address(b) || same_address(a.bind, b.bind);
  return any_address(a.group.empty() ? a : b);
}

// Place where the later of two sensors reads the earlier one's source; key "": none.
struct Shared {
  std::string key, what;
};

Shared shared(const TransportConfig& first, const TransportConfig& second) {
  if (first.kind == Kind::udp && second.kind == Kind::udp && same_port(first.udp, second.udp))
    return {"transport.port", std::to_string(second.udp.port)};
  if (first.kind == Kind::tcp && second.kind == Kind::tcp && first.tcp.port == second.tcp.port &&
      first.tcp.port != 0 && !first.tcp.host.empty() && same_address(first.tcp.host, second.tcp.host))
    return {"transport.port", host_and_port(second.tcp.host, second.tcp.port)};
  if (const std::string device = device_of(second); same_device(device_of(first), device))
    return {second.kind == Kind::serial ? "transport.device" : "transport.path", in_quotes(device)};
  return {};
}

// Sensors whose corrected rate this one uses as a channel, possibly itself.
std::vector<std::pair<const SensorConfig*, const ChannelConfig*>> taken_from(const Config& config,
                                                                             const SensorConfig& sensor) {
  std::vector<std::pair<const SensorConfig*, const ChannelConfig*>> out;
  for (const ChannelConfig& channel : sensor.channels) {
    const auto field = LcmFieldName::parse(channel.field.empty() ? channel.name : channel.field);
    if (channel.source != ChannelConfig::Source::lcm || !field || !field->of_rate()) continue;
    for (const SensorConfig& other : config.sensors)
      if (other.lcm_channel() == channel.lcm_channel && (&other == &sensor || field->name != kRateFields[0]))
        out.emplace_back(&other, &channel);
  }
  return out;
}

bool leads_to(const Config& config, const SensorConfig& from, const SensorConfig& to,
              std::set<const SensorConfig*>& seen) {
  if (&from == &to) return true;
  if (!seen.insert(&from).second) return false;
  const auto next = taken_from(config, from);
  return std::ranges::any_of(next, [&](const auto& each) { return leads_to(config, *each.first, to, seen); });
}

}  // namespace

std::vector<std::string> shared_sources(const Config& config) {
  std::vector<std::string> out;
  for (auto second = config.sensors.begin(); second != config.sensors.end(); ++second)
    for (auto first = config.sensors.begin(); first != second; ++first)
      if (const Shared found = shared(first->transport, second->transport); !found.key.empty()) {
        out.push_back(complaint(config, *second, found.key,
                                " = " + found.what + ": sensor " + in_quotes(first->name) +
                                    " reads from there already; expected a source of its own for each"));
        break;
      }
  return out;
}

std::vector<std::string> feedback_loops(const Config& config) {
  std::vector<std::string> out;
  for (const SensorConfig& sensor : config.sensors)
    for (const auto& [other, channel] : taken_from(config, sensor)) {
      std::set<const SensorConfig*> seen;
      if (!leads_to(config, *other, sensor, seen)) continue;
      out.push_back(complaint(config, sensor, "channel." + channel->name + ".lcm_channel",
                              " = " + in_quotes(channel->lcm_channel) + ": the rate of sensor " +
                                  in_quotes(sensor.name) +
                                  " would come back as a channel of its own; expected one that does not "
                                  "depend on it"));
    }
  return out;
}

}  // namespace ifog
