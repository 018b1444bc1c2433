// SPDX-License-Identifier: Apache-2.0
#include "daemon/sensor/flight_header.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "daemon/sensor/noise_memory.h"
#include "daemon/sensor/sensor_parts.h"
#include "daemon/state/state_folder.h"
#include "drivers/capture/candump/candump.h"
#include "drivers/capture/recording.h"
#include "drivers/system/input_limits.h"

namespace ifog {
namespace {

// Within the common limit. Files in the state folder are read with its rules.
void attach(const std::string& path, bool of_state, std::size_t& room, FlightHeader& header) try {
  if (header.files.contains(path)) return;
  std::string text = of_state ? read_state_file(path, room) : InputFile(path).bytes();
  // A header doubles line ends and backslashes.
  const auto doubled =
      std::count(text.begin(), text.end(), '\n') + std::count(text.begin(), text.end(), '\\');
  const std::size_t bytes = text.size() + static_cast<std::size_t>(doubled);
  if (bytes > room) return;
  room -= bytes;
  header.files[path] = std::move(text);
} catch (const std::runtime_error&) {
}

// For a log that can be read in advance; a FIFO cannot.
std::string interface_of(const TransportConfig& transport, const DriverInstance& driver) {
  std::error_code error;
  if (!transport.interface.empty() || !std::filesystem::is_regular_file(transport.file.path, error))
    return transport.interface;
  try {
    return first_interface(InputFile(transport.file.path).head(),
                           [&](const ifog_can_frame& frame) { return wants(driver.description(), frame); });
  } catch (const std::runtime_error&) {
    return {};
  }
}

}  // namespace

std::string source_of(const TransportConfig& transport) {
  switch (transport.kind) {
    case TransportConfig::Kind::serial:
      return transport.serial.device;
    case TransportConfig::Kind::can:
      return transport.interface;
    case TransportConfig::Kind::udp:
      return "udp port " + std::to_string(transport.udp.port);
    case TransportConfig::Kind::tcp:
      return transport.tcp.host + " port " + std::to_string(transport.tcp.port);
    case TransportConfig::Kind::file:
      break;
  }
  return transport.file.path;
}

FlightHeader flight_header(const SensorConfig& sensor, const Config& config, const DriverInstance& driver,
                           const std::string& noise) {
  FlightHeader out;
  out.program = IFOG_VERSION;
  out.sensor = sensor.name;
  const TransportConfig& transport = sensor.transport;
  const bool can = transport.kind == TransportConfig::Kind::can ||
                   (transport.kind == TransportConfig::Kind::file &&
                    transport.file.format == FileSettings::Format::candump);
  out.carries = can ? FlightHeader::Carries::can : FlightHeader::Carries::bytes;
  out.source = source_of(transport);
  if (can) out.interface = interface_of(transport, driver);
  out.driver = sensor.driver;
  out.options = sensor.options;
  for (const ChannelConfig& channel : sensor.channels)
    if (channel.source != ChannelConfig::Source::frame) out.channels.push_back(channel.name);
  out.powered_ns = powered_ns(sensor);
  if (out.powered_ns) out.boot = boot_id();
  out.configuration = sensor.text;
  out.configuration_file = std::filesystem::absolute(config.file).string();
  if (!noise.empty()) out.files[noise_file_name(sensor.name)] = noise;
  std::size_t room = kInputLimits.carried_bytes;
  if (!sensor.model.empty()) attach(sensor.model, sensor.model_adopted, room, out);
  out.options = with_files_in(sensor.folder, driver.table(), std::move(out.options));
  for (const std::string& key : file_settings(driver.table(), out.options))
    attach(out.options[key], false, room, out);
  return out;
}

SensorConfig recorded_sensor(const FlightHeader& header) {
  if (header.configuration.empty()) {
    SensorConfig named;
    named.name = header.sensor;
    named.driver = header.driver;
    named.options = header.options;
    return named;
  }
  Config config;
  try {
    config = parse_recorded_config(header.configuration, header.configuration_file);
  } catch (const ConfigError& error) {
    const std::string lines = error.what();
    throw std::runtime_error("was recorded by version " + header.program +
                             " with a configuration that this one does not take: " +
                             lines.substr(0, lines.find('\n')) + "; expected --config with one that it does");
  }
  return config.sensors.front();
}

}  // namespace ifog
