// SPDX-License-Identifier: Apache-2.0
// The daemon's configuration, a TOML file. Every key, its unit, range and default is in
// daemon/examples/reference.toml, which a test reads.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/config/published_type.h"
#include "drivers/transport/network/tcp.h"
#include "drivers/transport/network/udp.h"
#include "drivers/transport/serial/serial_port.h"
#include "filters/chain/reading.h"
#include "filters/settings/filter_settings.h"

namespace ifog {

struct TransportConfig {
  enum class Kind { serial, can, udp, tcp, file };
  Kind kind = Kind::file;
  // serial; its baud 0: what the driver says
  SerialSettings serial;
  // can
  std::string interface;  // "can0"; file: of a candump log's frames, empty for all
  UdpSettings udp;
  TcpSettings tcp;
  // file
  std::string path;       // "-" is the standard input
  bool candump = false;   // else raw bytes
  bool recorded = false;  // at recorded times, else as fast as it goes
  double speed = 1.0;
  double bytes_per_second = 0.0;
  std::uint32_t block_bytes = 0;
  bool await_writer = true;  // of a FIFO

  bool operator==(const TransportConfig&) const = default;
};

struct ChannelConfig {
  enum class Source { frame, can, lcm, file };
  std::string name;  // as in the model file: NAME_UNIT
  Source source = Source::frame;
  double max_age_s = 10.0;           // older is stale; 0: never
  std::string interface;             // can: "can0"
  std::string dbc, signal;           // can: file, and MESSAGE.SIGNAL or SIGNAL
  std::string lcm_channel;           // lcm: carries ifog.channel_t, ifog.rate_t or ifog.status_t
  std::string field;                 // lcm: which of it, see LcmField; "": the name
  std::string path;                  // file: holds one number, as hwmon's temp1_input
  double scale = 1.0, offset = 0.0;  // value = number * scale + offset; lcm, can and file
  Limits limits;                     // of the value; what is beyond is no measurement
  double period_s = 1.0;             // file: how often it is read

  bool operator==(const ChannelConfig&) const = default;
};

struct RealtimeConfig {
  int reader_priority = 0, filter_priority = 0;  // SCHED_FIFO; 0: ordinary
  std::vector<int> reader_cpus, filter_cpus;
  bool spin = false;   // the filter thread never sleeps
  bool direct = true;  // the reader thread does an idle filter's step
  int ring_slots = 1024;

  bool operator==(const RealtimeConfig&) const = default;
};

// The flight recorder.
struct RecordConfig {
  std::string folder;                   // its files are in FOLDER/SENSOR; "": nothing is recorded
  std::uint64_t bytes = 1'000'000'000;  // of all of the sensor's files
  double days = 30.0;                   // older files are removed
  std::uint64_t file_bytes = 16'000'000;
  double file_s = 3600.0;                  // a file is ended at this size or age, whichever comes first
  std::uint64_t buffer_bytes = 4'194'304;  // what may wait for the disk

  bool operator==(const RecordConfig&) const = default;
};

// Lines of the file by the path of their key.
using KeyLines = std::map<std::string, std::uint32_t, std::less<>>;

struct SensorConfig {
  std::string name;  // letters, digits, _ and -; LCM channel IFOG_<NAME in capitals>
  std::string driver;
  std::string model;                   // path, "" for none
  bool model_adopted = false;          // it is in the state folder
  double nominal_rate_hz = 0.0;        // 0: what the driver says
  double range_radps = 0.0;            // full scale of every axis; 0: what the driver says
  Limits limits;                       // of every axis's rate, rad/s
  bool imu = false;                    // ifog.imu_t at sample rate, too
  std::vector<PublishedType> publish;  // other types on channels of the user's choosing
  double start_up_s = 4.0;
  bool powered_with_computer = false;  // switched on with it: time since power-up is time since boot
  TransportConfig transport;
  std::map<std::string, std::string> options;  // of the driver
  std::string folder;                          // of the file, where relative paths in the options begin
  FilterChoice filter;
  RealtimeConfig realtime;
  RecordConfig record;
  std::vector<ChannelConfig> channels;
  std::string text;        // this sensor alone as a configuration, as it was written
  std::uint32_t line = 0;  // in the file, for messages
  KeyLines lines;          // "driver", "transport.port", "channel.supply_V.path"

  // The key's line; of a key that is not there that of its table.
  [[nodiscard]] std::uint32_t line_of(std::string_view key) const;
  [[nodiscard]] std::string lcm_channel() const;  // "IFOG_NAME"
  // Keys and tables in which `other` differs and that only a restart can change: a model, a filter and its
  // start-up are exchanged between two samples, a device or a driver is not. "" for none.
  [[nodiscard]] std::string restart_for(const SensorConfig& other) const;
  // This one with what of `fresh` needs no restart, in `text`, too.
  [[nodiscard]] SensorConfig reloaded(const SensorConfig& fresh) const;
};

struct Config {
  std::string file;
  std::vector<std::string> plugin_folders;
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string log_level = "info";
  std::string state_folder;  // where learned noise is kept; "": the service manager's STATE_DIRECTORY, if any
  bool lock_memory = true;
  std::vector<SensorConfig> sensors;
  KeyLines lines;  // of the table [daemon]: "lcm_url"

  [[nodiscard]] std::string restart_for(const Config& other) const;  // of the table [daemon], likewise
};

// Everything that is wrong, one line each, joined by '\n'.
struct ConfigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// What is wrong with a sensor once its parts are made, with the key it is due to, as in SensorConfig::lines.
struct KeyError : std::runtime_error {
  KeyError(std::string at, const std::string& what) : std::runtime_error(what), key(std::move(at)) {}
  std::string key;
};

// Throws ConfigError. Relative paths in it (models, DBC files, captures, plugin folders) are relative to the
// file. A sensor without `model` has the one that was adopted for it, see use_adopted_models().
Config read_config(const std::string& path);
Config parse_config(const std::string& text, const std::string& path);
// As the daemon has once put it into a flight recording: what runs no more is read all the same.
Config parse_recorded_config(const std::string& text, const std::string& path);

// Gives every sensor without a model the one that is kept for it in the state folder, if any. folder "":
// none.
void use_adopted_models(Config& config, const std::string& folder);

}  // namespace ifog
