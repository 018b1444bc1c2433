// SPDX-License-Identifier: Apache-2.0
#include "daemon/sensor/sensor_parts.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <tuple>
#include <utility>

#include "daemon/state/state_folder.h"
#include "drivers/ifog/quoted.h"
#include "drivers/transport/can/can.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/file/file.h"
#include "drivers/transport/network/tcp.h"
#include "drivers/transport/network/udp.h"
#include "drivers/transport/serial/serial_port.h"

namespace ifog {
namespace {

constexpr double kFrameChannelMaxAge_s = 10.0;

// All members: an additional one does not compile.
auto tied(const FilterChoice& choice) {
  const auto& [rule, state, weights, wideband, process_noise, measurement_noise, floor, state_parameters,
               window, draws, follow_manoeuvres, conserve_angle, steady_gain, guard, plain, seed] = choice;
  return std::tie(rule, state, weights, wideband, process_noise, measurement_noise, floor, state_parameters,
                  window, draws, follow_manoeuvres, conserve_angle, steady_gain, guard, plain, seed);
}

std::vector<CanId> wanted_ids(const ifog_description& description) {
  std::vector<CanId> ids;
  for (std::uint32_t i = 0; i < description.can_ids; ++i)
    ids.push_back({description.can_id[i].id, description.can_id[i].extended != 0});
  return ids;
}

using Kind = TransportConfig::Kind;

bool is_candump(const TransportConfig& transport) {
  return transport.kind == Kind::file && transport.file.format == FileSettings::Format::candump;
}

// Throws if the driver cannot be fed from the transport.
void check_feeding(const SensorConfig& sensor, const DriverInstance& driver) {
  const TransportConfig& transport = sensor.transport;
  const bool frames = transport.kind == Kind::can || is_candump(transport);
  if (frames ? driver.takes_can() : driver.takes_bytes()) return;
  constexpr std::array kTypes{"serial", "can", "udp", "tcp", "file (bytes)"};
  const std::string type =
      is_candump(transport) ? "file (candump)" : kTypes.at(static_cast<std::size_t>(transport.kind));
  throw KeyError("transport.type",
                 "driver \"" + printable(sensor.driver) + "\" cannot be fed from a transport of type \"" +
                     type + "\": it takes " + (frames ? "bytes" : "CAN frames") +
                     (transport.kind == Kind::file && !frames ? ": format = \"candump\"" : ""));
}

// The sensor's key of that table which an error names first; else "".
std::string key_in(const SensorConfig& sensor, const std::string& table, std::string_view complaint) {
  const auto of_word = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  for (auto end = complaint.begin(); end != complaint.end();) {
    const auto begin = std::find_if(end, complaint.end(), of_word);
    end = std::find_if_not(begin, complaint.end(), of_word);
    if (const std::string key = table + std::string(begin, end); sensor.lines.contains(key)) return key;
  }
  return "";
}

}  // namespace

DriverInstance make_sensor_driver(const SensorConfig& sensor,
                                  const std::vector<std::string>& plugin_folders_first) {
  try {
    return make_driver(sensor.driver, sensor.options, plugin_folders(plugin_folders_first), sensor.folder);
  } catch (const std::exception& error) {
    const std::string key = key_in(sensor, "options.", error.what());
    throw KeyError(key.empty() ? "driver" : key, error.what());
  }
}

SerialSettings sensor_serial_settings(const SensorConfig& sensor, const DriverInstance& driver) {
  check_feeding(sensor, driver);
  SerialSettings settings = sensor.transport.serial;
  if (settings.baud == 0) settings.baud = driver.description().baud;
  if (settings.baud == 0)
    throw KeyError("transport.baud", "sensor.transport.baud: missing, and driver \"" +
                                         printable(sensor.driver) +
                                         "\" prescribes no speed; expected bits a second");
  return settings;
}

std::unique_ptr<Transport> make_sensor_transport(const SensorConfig& sensor, const DriverInstance& driver) {
  check_feeding(sensor, driver);
  const TransportConfig& transport = sensor.transport;
  FileSettings file = transport.file;
  switch (transport.kind) {
    case Kind::serial:
      return make_serial_transport(sensor_serial_settings(sensor, driver));
    case Kind::can:
      return make_can_transport({.interface = transport.interface, .ids = wanted_ids(driver.description())});
    case Kind::udp:
      return make_udp_transport(transport.udp);
    case Kind::tcp:
      return make_tcp_transport(transport.tcp);
    case Kind::file:
      break;
  }
  file.interface = transport.interface;
  if (is_candump(transport)) file.ids = wanted_ids(driver.description());
  return make_file_transport(file);
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
  const FileSettings& file = sensor.transport.file;
  if (sensor.transport.kind == Kind::file && file.pace == FileSettings::Pace::recorded)
    out.facts.speed = file.speed;
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
      throw KeyError("channel." + channel.name + ".name",
                     "sensor.channel \"" + printable(channel.name) + "\": the frames of driver \"" +
                         printable(sensor.driver) + "\" carry " + (list.empty() ? "no channels" : list));
    }
    if (of_frame) {
      const auto index = static_cast<std::size_t>(known - out.channels.begin());
      out.channel_max_age_s[index] = channel.max_age_s;
      out.facts.channel[index] = channel_limits(channel.name, channel.limits);
    } else if (known != out.channels.end()) {
      throw KeyError("channel." + channel.name + ".name",
                     "sensor.channel \"" + printable(channel.name) + "\": the frames of driver \"" +
                         printable(sensor.driver) +
                         "\" carry a channel of that name; expected another name or source = \"frame\"");
    }
  }
  for (const ChannelConfig& channel : outside) {
    out.channels.push_back(channel.name);
    out.channel_max_age_s.push_back(channel.max_age_s);
  }
  if (sensor.imu || !sensor.publish.empty()) {
    const auto& known = out.facts.acceleration_channel;
    if (out.facts.axes != kMaxAxes || std::any_of(known.begin(), known.end(), [](int c) { return c < 0; }))
      throw KeyError(
          sensor.imu ? "imu" : "publish",
          std::string(sensor.imu ? "imu = true" : "sensor.publish") +
              ": expected a driver that gives rates and accel_x_mps2, accel_y_mps2, accel_z_mps2 of "
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

bool ChainChoice::operator==(const ChainChoice& other) const {
  return tied(filter) == tied(other.filter) && start_up_s == other.start_up_s && model == other.model;
}

ChainChoice chain_choice(const SensorConfig& sensor, const Model* model) {
  return {sensor.filter, sensor.start_up_s, model != nullptr ? model_text(*model) : ""};
}

std::optional<std::int64_t> powered_ns(const SensorConfig& sensor) {
  if (!sensor.powered_with_computer) return std::nullopt;
  return arrival_clock_at_boot_ns();
}

std::string boot_id() {
  std::string out;
  if (const char* const given = std::getenv("IFOGD_BOOT_ID"))
    out = given;
  else
    std::getline(std::ifstream("/proc/sys/kernel/random/boot_id"), out);
  // One notation has dashes, the other none.
  std::erase(out, '-');
  return out;
}

std::shared_ptr<const Model> read_sensor_model(const SensorConfig& sensor) {
  if (sensor.model.empty()) return nullptr;
  try {
    return std::make_shared<const Model>(sensor.model_adopted ? parsed_state_file(sensor.model, parse_model)
                                                              : read_model(sensor.model));
  } catch (const std::exception& error) {
    throw KeyError("model", error.what());
  }
}

std::unique_ptr<ChainParts> make_chain_parts(const SensorConfig& sensor, const ChainSettings& settings) {
  try {
    return std::make_unique<ChainParts>(settings);
  } catch (const ModelMisfit& misfit) {
    const std::string line = misfit.line > 0 ? ":" + std::to_string(misfit.line) : "";
    throw KeyError("model", sensor.model + line + ": " + misfit.what());
  } catch (const std::exception& error) {
    // A setting that was not chosen here is the model's.
    const std::string key = key_in(sensor, "filter.", error.what());
    if (key.empty() && settings.model && settings.model->filter)
      throw KeyError("model", sensor.model + ": " + error.what());
    throw KeyError(key.empty() ? "filter" : key, error.what());
  }
}

}  // namespace ifog
