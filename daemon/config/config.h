// SPDX-License-Identifier: Apache-2.0
// The daemon's configuration, a TOML file. daemon/examples/reference.toml has every key with unit, range and
// default, and is tested.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/transport/file/file.h"
#include "drivers/transport/network/tcp.h"
#include "drivers/transport/network/udp.h"
#include "drivers/transport/serial/serial_port.h"
#include "filters/chain/reading.h"
#include "filters/settings/filter_settings.h"

namespace ifog {

// Types published for each sample besides rate_t.
// Names of the types in the configuration.
inline constexpr std::string_view kImuType = "ifog.imu_t", kInertialType = "ifog.inertial_t",
                                  kInsType = "bot_core.ins_t", kMicrostrainType = "microstrain.ins_t",
                                  kKvhBatchType = "bot_core.kvh_raw_imu_batch_t";

// A type and its LCM channel.
struct PublishedType {
  std::string type, channel;

  bool operator==(const PublishedType&) const = default;
};

struct TransportConfig {
  enum class Kind { serial, can, udp, tcp, file };
  Kind kind = Kind::file;
  // serial; baud 0: from the driver
  SerialSettings serial;
  std::string interface;  // can: "can0"; file: only this interface of a candump log, "" for all
  UdpSettings udp;
  TcpSettings tcp;
  FileSettings file;

  bool operator==(const TransportConfig&) const = default;
};

struct ChannelConfig {
  enum class Source { frame, can, lcm, file };
  std::string name;  // as in the model file: NAME_UNIT
  Source source = Source::frame;
  double max_age_s = 10.0;           // older values are stale; 0: never
  std::string interface;             // can: "can0"
  std::string dbc, signal;           // can: file, and MESSAGE.SIGNAL or SIGNAL
  std::string lcm_channel;           // lcm: carries ifog.channel_t, ifog.rate_t or ifog.status_t
  std::string field;                 // lcm: see LcmField; "": the name
  std::string path;                  // file: contains one number, e.g. hwmon's temp1_input
  double scale = 1.0, offset = 0.0;  // value = number * scale + offset; lcm, can and file
  Limits limits;                     // of the value; others are invalid
  double period_s = 1.0;             // file: reading interval

  bool operator==(const ChannelConfig&) const = default;
};

struct RealtimeConfig {
  int reader_priority = 0, filter_priority = 0;  // SCHED_FIFO; 0: ordinary
  std::vector<int> reader_cpus, filter_cpus;
  bool spin = false;   // the filter thread never sleeps
  bool direct = true;  // the reader thread does the step of an idle filter
  int ring_slots = 1024;

  bool operator==(const RealtimeConfig&) const = default;
};

// Flight recorder.
struct RecordConfig {
  std::string folder;                   // files are in FOLDER/SENSOR; "": no recording
  std::uint64_t bytes = 1'000'000'000;  // limit for all of the sensor's files
  double days = 30.0;                   // older files are removed
  std::uint64_t file_bytes = 16'000'000;
  double file_s = 3600.0;                  // limits of size and age at which a file is closed
  std::uint64_t buffer_bytes = 4'194'304;  // limit of data waiting for the disk

  bool operator==(const RecordConfig&) const = default;
};

// Lines of the file by key path.
using KeyLines = std::map<std::string, std::uint32_t, std::less<>>;

struct SensorConfig {
  std::string name;  // letters, digits, _ and -; LCM channel IFOG_<NAME in capitals>
  std::string driver;
  std::string model;                   // path, or ""
  bool model_adopted = false;          // it is in the state folder
  double nominal_rate_hz = 0.0;        // 0: from the driver
  double range_radps = 0.0;            // full scale of every axis; 0: from the driver
  Limits limits;                       // of every axis's rate, rad/s
  bool imu = false;                    // publish ifog.imu_t at the sample rate, too
  std::vector<PublishedType> publish;  // further types on configured channels
  double start_up_s = 4.0;
  bool powered_with_computer = false;  // powered with the computer: time since power-up is time since boot
  TransportConfig transport;
  std::map<std::string, std::string> options;  // of the driver
  std::string folder;                          // folder of the file, for relative paths in options
  FilterChoice filter;
  RealtimeConfig realtime;
  RecordConfig record;
  std::vector<ChannelConfig> channels;
  std::string text;        // this sensor alone as a configuration
  std::uint32_t line = 0;  // in the file, for messages
  KeyLines lines;          // "driver", "transport.port", "channel.supply_V.path"

  // Line of the key, or of its table if the key is absent.
  [[nodiscard]] std::uint32_t line_of(std::string_view key) const;
  [[nodiscard]] std::string lcm_channel() const;  // "IFOG_NAME"
  // Keys and tables that differ in `other` and need a restart: models, filters and start-up can be exchanged
  // between two samples, devices and drivers cannot. "" if none.
  [[nodiscard]] std::string restart_for(const SensorConfig& other) const;
  // This configuration with the parts of `fresh` that need no restart, also in `text`.
  [[nodiscard]] SensorConfig reloaded(const SensorConfig& fresh) const;
};

struct Config {
  std::string file;
  std::vector<std::string> plugin_folders;
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string log_level = "info";
  std::string state_folder;  // folder of learned noise; "": the service manager's STATE_DIRECTORY, if any
  bool lock_memory = true;
  std::vector<SensorConfig> sensors;
  KeyLines lines;  // of the table [daemon]: "lcm_url"

  [[nodiscard]] std::string restart_for(const Config& other) const;  // the same for the table [daemon]
};

// All errors, one line each, joined by '\n'.
struct ConfigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Error in a complete sensor, with the key that causes it, as in SensorConfig::lines.
struct KeyError : std::runtime_error {
  KeyError(std::string at, const std::string& what) : std::runtime_error(what), key(std::move(at)) {}
  std::string key;
};

// Throws ConfigError. Relative paths (models, DBC files, captures, plugin folders) are relative to the file.
// A sensor without `model` uses the adopted one, see use_adopted_models().
Config read_config(const std::string& path);
Config parse_config(const std::string& text, const std::string& path);
// A configuration from a flight recording; also accepts what would no longer run.
Config parse_recorded_config(const std::string& text, const std::string& path);

// Gives every sensor without a model the one in the state folder, if any. folder "": none.
void use_adopted_models(Config& config, const std::string& folder);

}  // namespace ifog
