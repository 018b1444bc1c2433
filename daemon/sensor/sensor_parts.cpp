// SPDX-License-Identifier: Apache-2.0
#include "daemon/sensor/sensor_parts.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "drivers/transport/can.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/file.h"
#include "drivers/transport/serial.h"
#include "drivers/transport/tcp.h"
#include "drivers/transport/udp.h"

namespace ifog {
namespace {

constexpr double kFrameChannelMaxAge_s = 10.0;

std::vector<CanId> wanted_ids(const ifog_description& description) {
  std::vector<CanId> ids;
  for (std::uint32_t i = 0; i < description.can_ids; ++i)
    ids.push_back({description.can_id[i].id, description.can_id[i].extended != 0});
  return ids;
}

void require(bool fits, const SensorConfig& sensor, const char* type, const char* needs) {
  if (!fits)
    throw std::runtime_error("driver \"" + printable(sensor.driver) +
                             "\" cannot be fed from a transport of type \"" + type + "\": it takes " + needs);
}

std::unique_ptr<Transport> can_transport(const SensorConfig& sensor, const DriverInstance& driver) {
  require(driver.takes_can(), sensor, "can", "bytes");
  CanSettings settings;
  settings.interface = sensor.transport.interface;
  settings.ids = wanted_ids(driver.description());
  return make_can_transport(settings);
}

std::unique_ptr<Transport> file_transport(const SensorConfig& sensor, const DriverInstance& driver) {
  const TransportConfig& config = sensor.transport;
  if (config.candump)
    require(driver.takes_can(), sensor, "file (candump)", "bytes");
  else
    require(driver.takes_bytes(), sensor, "file (bytes)", "CAN frames: format = \"candump\"");
  FileSettings settings;
  settings.path = config.path;
  settings.format = config.candump ? FileSettings::Format::candump : FileSettings::Format::bytes;
  settings.pace = config.recorded ? FileSettings::Pace::recorded : FileSettings::Pace::free;
  settings.speed = config.speed;
  settings.bytes_per_second = config.bytes_per_second;
  settings.block_bytes = config.block_bytes;
  settings.await_writer = config.await_writer;
  settings.interface = config.interface;
  if (config.candump) settings.ids = wanted_ids(driver.description());
  return make_file_transport(settings);
}

}  // namespace

DriverInstance make_sensor_driver(const SensorConfig& sensor,
                                  const std::vector<std::string>& plugin_folders_first) {
  return make_driver(sensor.driver, sensor.options, plugin_folders(plugin_folders_first), sensor.folder);
}

SerialSettings sensor_serial_settings(const SensorConfig& sensor, const DriverInstance& driver) {
  require(driver.takes_bytes(), sensor, "serial", "CAN frames");
  SerialSettings settings = sensor.transport.serial;
  if (settings.baud == 0) settings.baud = driver.description().baud;
  if (settings.baud == 0)
    throw std::runtime_error("sensor.transport.baud: missing, and driver \"" + printable(sensor.driver) +
                             "\" prescribes no speed; expected bits a second");
  return settings;
}

std::unique_ptr<Transport> make_sensor_transport(const SensorConfig& sensor, const DriverInstance& driver) {
  switch (sensor.transport.kind) {
    case TransportConfig::Kind::serial:
      return make_serial_transport(sensor_serial_settings(sensor, driver));
    case TransportConfig::Kind::can:
      return can_transport(sensor, driver);
    case TransportConfig::Kind::udp:
      require(driver.takes_bytes(), sensor, "udp", "CAN frames");
      return make_udp_transport(sensor.transport.udp);
    case TransportConfig::Kind::tcp:
      require(driver.takes_bytes(), sensor, "tcp", "CAN frames");
      return make_tcp_transport(sensor.transport.tcp);
    case TransportConfig::Kind::file:
      break;
  }
  return file_transport(sensor, driver);
}

std::vector<ChannelConfig> outside_channels(const SensorConfig& sensor) {
  std::vector<ChannelConfig> out;
  std::copy_if(sensor.channels.begin(), sensor.channels.end(), std::back_inserter(out),
               [](const ChannelConfig& channel) { return channel.source != ChannelConfig::Source::frame; });
  return out;
}

ChainSettings sensor_chain_settings(const SensorConfig& sensor, const ifog_description& description,
                                    std::shared_ptr<const Model> model) {
  ChainSettings out;
  const std::vector<ChannelConfig> outside = outside_channels(sensor);
  out.facts = sensor_facts(description, sensor.nominal_rate_hz, static_cast<int>(outside.size()));
  for (std::uint32_t i = 0; i < description.axes; ++i) out.axes.emplace_back(description.axis[i]);
  for (std::uint32_t i = 0; i < description.environments; ++i) {
    out.channels.emplace_back(description.environment[i]);
    out.channel_max_age_s.push_back(kFrameChannelMaxAge_s);
  }
  for (const ChannelConfig& channel : sensor.channels) {
    const auto known = std::find(out.channels.begin(), out.channels.end(), channel.name);
    const bool of_frame = channel.source == ChannelConfig::Source::frame;
    if (of_frame && known == out.channels.end()) {
      std::string list;
      for (const std::string& name : out.channels) list += (list.empty() ? "" : ", ") + name;
      throw std::runtime_error("sensor.channel \"" + printable(channel.name) + "\": the frames of driver \"" +
                               sensor.driver + "\" carry " + (list.empty() ? "no channels" : list));
    }
    if (of_frame) {
      const auto index = static_cast<std::size_t>(known - out.channels.begin());
      out.channel_max_age_s[index] = channel.max_age_s;
      out.facts.channel[index] = channel.limits;
    } else if (known != out.channels.end()) {
      throw std::runtime_error(
          "sensor.channel \"" + printable(channel.name) + "\": the frames of driver \"" +
          printable(sensor.driver) +
          "\" carry a channel of that name; expected another name or source = \"frame\"");
    }
  }
  for (const ChannelConfig& channel : outside) {
    out.channels.push_back(channel.name);
    out.channel_max_age_s.push_back(channel.max_age_s);
  }
  if (sensor.imu) {
    const auto& known = out.facts.acceleration_channel;
    if (out.facts.axes != kMaxAxes || std::any_of(known.begin(), known.end(), [](int c) { return c < 0; }))
      throw std::runtime_error(
          "imu = true: expected a driver that gives rates and accel_x_mps2, accel_y_mps2, accel_z_mps2 of "
          "three axes, \"" +
          printable(sensor.driver) + "\" as configured does not");
  }
  if (sensor.range_radps > 0.0) out.facts.full_scale_radps.fill(sensor.range_radps);
  out.facts.rate = sensor.limits;
  out.filter = sensor.filter;
  out.start_up_s = sensor.start_up_s;
  out.model = std::move(model);
  return out;
}

std::optional<std::int64_t> powered_ns(const SensorConfig& sensor) {
  if (!sensor.powered_with_computer) return std::nullopt;
  return arrival_clock_at_boot_ns();
}

std::shared_ptr<const Model> read_sensor_model(const SensorConfig& sensor) {
  if (sensor.model.empty()) return nullptr;
  return std::make_shared<const Model>(read_model(sensor.model));
}

}  // namespace ifog
