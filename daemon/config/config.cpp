// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/config.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "daemon/config/table_reader.h"
#include "daemon/state/state_folder.h"
#include "drivers/ifog/quoted.h"
#include "filters/chain/plausibility.h"
#include "filters/model_file/toml_file.h"
#include "filters/settings/filter_table.h"
#include "msgs/channel_name.h"

namespace ifog {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Range kNotNegative{0.0, kInfinity};

template <typename T, typename U>
void take(std::optional<U>&& given, T& setting) {
  if (given) setting = static_cast<T>(std::move(*given));
}

// What the readers of all tables share.
struct Context {
  std::string file;
  std::filesystem::path folder;
  std::vector<std::string> errors;

  // "-" is the standard input, not a file.
  [[nodiscard]] std::string absolute(const std::string& path) const {
    if (path.empty() || path == "-") return path;
    return (folder / path).lexically_normal().string();
  }
};

std::string as_text(const toml::table& table) {
  std::ostringstream text;
  text << table;
  return text.str();
}

bool good_name(const std::string& name) {
  constexpr std::size_t kLongest = 32;
  return !name.empty() && name.size() <= kLongest &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
}

SerialSettings read_serial(TableReader& in) {
  SerialSettings out;
  out.device = in.required_text("device", "the path of a serial device, \"/dev/ttyUSB0\"");
  take(in.integer("baud", 50, 20'000'000), out.baud);
  take(in.integer("data_bits", 5, 8), out.data_bits);
  if (const auto parity = in.choice("parity", {"none", "even", "odd"}))
    out.parity = *parity == "even"  ? SerialSettings::Parity::even
                 : *parity == "odd" ? SerialSettings::Parity::odd
                                    : SerialSettings::Parity::none;
  take(in.integer("stop_bits", 1, 2), out.stop_bits);
  take(in.integer("baud_base", 1, 100'000'000), out.baud_base);
  return out;
}

// What concerns more keys than one is found by the transport itself; a key that is wrong by itself was told.
void check_network(TableReader& in, const std::string& complaint, std::size_t told, const Context& context) {
  if (complaint.empty() || context.errors.size() != told) return;
  const std::string key = complaint.substr(0, complaint.find_first_of(" :"));
  in.complain(key, complaint.substr(key.size()));
}

UdpSettings read_udp(TableReader& in, const Context& context) {
  const std::size_t told = context.errors.size();
  UdpSettings out;
  take(in.required_integer("port", 1, 65535), out.port);
  take(in.text("bind"), out.bind);
  take(in.text("group"), out.group);
  take(in.text("interface"), out.interface);
  take(in.text("host"), out.host);
  check_network(in, udp_complaint(out), told, context);
  return out;
}

TcpSettings read_tcp(TableReader& in, const Context& context) {
  const std::size_t told = context.errors.size();
  TcpSettings out;
  out.host = in.required_text("host", "the sensor's numeric address, \"192.168.1.20\"");
  take(in.required_integer("port", 1, 65535), out.port);
  check_network(in, tcp_complaint(out), told, context);
  return out;
}

TransportConfig read_transport(const toml::table& table, const std::string& where, Context& context) {
  TableReader in(table, where, context.file, context.errors);
  TransportConfig out;
  const auto type = in.choice("type", {"serial", "can", "udp", "tcp", "file"});
  if (!type) {
    if (!in.has("type"))
      in.complain("type", ": missing; expected \"serial\" | \"can\" | \"udp\" | \"tcp\" | \"file\"");
    return out;
  }
  if (*type == "serial") {
    out.kind = TransportConfig::Kind::serial;
    out.serial = read_serial(in);
  } else if (*type == "can") {
    out.kind = TransportConfig::Kind::can;
    out.interface = in.required_text("interface", "a CAN interface, \"can0\"");
  } else if (*type == "udp") {
    out.kind = TransportConfig::Kind::udp;
    out.udp = read_udp(in, context);
  } else if (*type == "tcp") {
    out.kind = TransportConfig::Kind::tcp;
    out.tcp = read_tcp(in, context);
  } else {
    out.kind = TransportConfig::Kind::file;
    out.path = context.absolute(in.required_text("path", "a file or FIFO, \"-\" for the standard input"));
    if (const auto format = in.choice("format", {"bytes", "candump"})) out.candump = *format == "candump";
    if (const auto pace = in.choice("pace", {"free", "recorded"})) out.recorded = *pace == "recorded";
    take(in.number("speed", {1e-3, 1e6}), out.speed);
    take(in.number("bytes_per_second", {1.0, 1e9}), out.bytes_per_second);
    take(in.integer("block_bytes", 1, 1'000'000), out.block_bytes);
    take(in.boolean("await_writer"), out.await_writer);
    take(in.text("interface"), out.interface);
    if (out.recorded && !out.candump && out.bytes_per_second <= 0.0)
      in.complain("pace", " = \"recorded\": raw bytes carry no times; expected bytes_per_second beside it");
  }
  in.refuse_the_rest();
  return out;
}

FilterChoice read_filter(const toml::table& table, const std::string& where, double& start_up_s,
                         Context& context) {
  TableReader in(table, where, context.file, context.errors);
  FilterChoice out;
  for (const FilterSetting& setting : filter_table()) in.filter_setting(setting, out);
  take(in.number("start_up_s", {0.01, 3600.0}), start_up_s);
  in.refuse_the_rest();
  return out;
}

RealtimeConfig read_realtime(const toml::table& table, const std::string& where, Context& context) {
  TableReader in(table, where, context.file, context.errors);
  RealtimeConfig out;
  take(in.integer("reader_priority", 0, 99), out.reader_priority);
  take(in.integer("filter_priority", 0, 99), out.filter_priority);
  take(in.integers("reader_cpus", 0, 1023), out.reader_cpus);
  take(in.integers("filter_cpus", 0, 1023), out.filter_cpus);
  take(in.boolean("spin"), out.spin);
  take(in.boolean("direct"), out.direct);
  take(in.integer("ring_slots", 2, 1'000'000), out.ring_slots);
  in.refuse_the_rest();
  return out;
}

RecordConfig read_record(const toml::table& table, const std::string& where, Context& context) {
  TableReader in(table, where, context.file, context.errors);
  RecordConfig out;
  out.folder = context.absolute(in.required_text("folder", "a folder, \"/var/lib/ifogd/record\""));
  take(in.integer("bytes", 1'000'000, std::numeric_limits<std::int64_t>::max()), out.bytes);
  take(in.number("days", {1e-3, 1e5}), out.days);
  take(in.integer("file_bytes", 100'000, 1'000'000'000), out.file_bytes);
  take(in.number("file_s", {1.0, 1e6}), out.file_s);
  take(in.integer("buffer_bytes", 262'144, 1'000'000'000), out.buffer_bytes);
  // With fewer than four files, removing the oldest would remove most of what there is.
  if (out.bytes / 4 < out.file_bytes)
    in.complain(in.has("bytes") ? "bytes" : "file_bytes",
                ": bytes = " + std::to_string(out.bytes) + " with file_bytes = " +
                    std::to_string(out.file_bytes) + ": expected room for at least four files");
  in.refuse_the_rest();
  return out;
}

Limits read_limits(TableReader& in, double most) {
  Limits out;
  take(in.number("minimum", {-most, most}), out.minimum);
  take(in.number("maximum", {-most, most}), out.maximum);
  take(in.number("max_step", {0.0, 2.0 * most}), out.max_step);
  if (!(out.minimum < out.maximum)) in.complain("maximum", ": not above minimum; expected minimum < maximum");
  return out;
}

ChannelConfig read_channel(const toml::table& table, const std::string& where, Context& context) {
  TableReader in(table, where, context.file, context.errors);
  ChannelConfig out;
  out.name = in.required_text("name", "a channel's name with its unit, \"temperature_degC\"");
  take(in.number("max_age_s", kNotNegative), out.max_age_s);
  out.limits = read_limits(in, kMostChannel);
  const auto source = in.choice("source", {"frame", "can", "lcm", "file"});
  if (!source) {
    if (!in.has("source"))
      in.complain("source", ": missing; expected \"frame\" | \"can\" | \"lcm\" | \"file\"");
    return out;
  }
  if (*source == "frame") {
    out.source = ChannelConfig::Source::frame;
  } else {
    take(in.number("scale", {-kMostChannel, kMostChannel}), out.scale);
    take(in.number("offset", {-kMostChannel, kMostChannel}), out.offset);
  }
  if (*source == "can") {
    out.source = ChannelConfig::Source::can;
    out.interface = in.required_text("interface", "a CAN interface, \"can0\"");
    out.dbc = context.absolute(in.required_text("dbc", "a DBC file"));
    out.signal = in.required_text("signal", "a signal of the DBC file, \"SIGNAL\" or \"MESSAGE.SIGNAL\"");
  } else if (*source == "lcm") {
    out.source = ChannelConfig::Source::lcm;
    out.lcm_channel = in.required_text(
        "lcm_channel", "an LCM channel that carries ifog.channel_t, ifog.rate_t or ifog.status_t");
    out.field = in.text("field").value_or("");
  } else if (*source == "file") {
    out.source = ChannelConfig::Source::file;
    out.path = context.absolute(in.required_text("path", "a file that holds one number"));
    take(in.number("period_s", {1e-3, 3600.0}), out.period_s);
  }
  in.refuse_the_rest();
  return out;
}

SensorConfig read_sensor(const toml::table& table, Context& context) {
  TableReader in(table, "sensor", context.file, context.errors);
  SensorConfig out;
  out.line = table.source().begin.line;
  out.folder = context.folder.string();
  out.name = in.required_text("name", "a name, letters, digits, _ and -");
  if (!out.name.empty() && !good_name(out.name))
    in.complain("name", " = " + in_quotes(out.name) + ": expected at most 32 letters, digits, _ and -");
  out.driver = in.required_text("driver", "the name of a driver, see `ifog drivers`");
  out.model = context.absolute(in.text("model").value_or(""));
  take(in.number("nominal_rate_hz", {1e-3, 1e6}), out.nominal_rate_hz);
  take(in.number("range_radps", {1e-9, kMostRate_radps}), out.range_radps);
  out.limits = read_limits(in, kMostRate_radps);
  take(in.boolean("imu"), out.imu);
  take(in.boolean("powered_with_computer"), out.powered_with_computer);
  if (const toml::table* const transport = in.table("transport"))
    out.transport = read_transport(*transport, "sensor.transport", context);
  else if (!in.has("transport"))
    in.complain("transport", ": missing; expected a table [sensor.transport]");
  if (const toml::table* const options = in.table("options")) {
    TableReader reader(*options, "sensor.options", context.file, context.errors);
    for (const auto& [key, node] : *options) {
      if (node.is_table() || node.is_array())
        reader.complain(key.str(),
                        " = " + printable(as_written(node)) + ": expected a text, a number, true or false");
      else
        out.options[std::string(key.str())] = node.is_string() ? node.as_string()->get() : as_written(node);
    }
  }
  if (const toml::table* const filter = in.table("filter"))
    out.filter = read_filter(*filter, "sensor.filter", out.start_up_s, context);
  if (const toml::table* const realtime = in.table("realtime"))
    out.realtime = read_realtime(*realtime, "sensor.realtime", context);
  if (const toml::table* const record = in.table("record"))
    out.record = read_record(*record, "sensor.record", context);
  std::set<std::string> names;
  for (const toml::table* const channel : in.tables("channel")) {
    out.channels.push_back(read_channel(*channel, "sensor.channel", context));
    const std::string& name = out.channels.back().name;
    if (!name.empty() && !names.insert(name).second)
      TableReader(*channel, "sensor.channel", context.file, context.errors)
          .complain("name", " = " + in_quotes(name) + ": this sensor has a channel of that name already");
  }
  in.refuse_the_rest();
  out.text = as_text(toml::table{{"sensor", toml::array{table}}});
  return out;
}

void read_daemon(const toml::table& table, Config& out, Context& context) {
  TableReader in(table, "daemon", context.file, context.errors);
  if (const auto folder = in.text("plugin_folder")) out.plugin_folders = {context.absolute(*folder)};
  take(in.text("lcm_url"), out.lcm_url);
  take(in.choice("log_level", {"debug", "info", "warning", "error"}), out.log_level);
  take(in.boolean("lock_memory"), out.lock_memory);
  if (const auto folder = in.text("state_folder")) out.state_folder = context.absolute(*folder);
  in.refuse_the_rest();
}

std::string joined(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) out += (out.empty() ? "" : "\n") + line;
  return out;
}

}  // namespace

std::string SensorConfig::lcm_channel() const {
  std::string out = "IFOG_" + name;
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return out;
}

namespace {

// Names of those that differ.
std::string differing(std::initializer_list<std::pair<const char*, bool>> keys) {
  std::string out;
  for (const auto& [key, same] : keys)
    if (!same) out += (out.empty() ? "" : ", ") + std::string(key);
  return out;
}

}  // namespace

std::string SensorConfig::restart_for(const SensorConfig& other) const {
  return differing({{"driver", driver == other.driver},
                    {"options", options == other.options},
                    {"transport", transport == other.transport},
                    {"nominal_rate_hz", nominal_rate_hz == other.nominal_rate_hz},
                    {"range_radps", range_radps == other.range_radps},
                    {"minimum, maximum or max_step", limits == other.limits},
                    {"imu", imu == other.imu},
                    {"powered_with_computer", powered_with_computer == other.powered_with_computer},
                    {"realtime", realtime == other.realtime},
                    {"record", record == other.record},
                    {"channel", channels == other.channels}});
}

SensorConfig SensorConfig::reloaded(const SensorConfig& fresh) const {
  SensorConfig out = *this;
  out.model = fresh.model;
  out.filter = fresh.filter;
  out.start_up_s = fresh.start_up_s;
  toml::table mine = parse_toml(text, "");
  const toml::table its = parse_toml(fresh.text, "");
  toml::table& sensor = *mine["sensor"][0].as_table();
  for (const char* const key : {"model", "filter"}) {
    sensor.erase(key);
    if (const toml::node* const node = its["sensor"][0][key].node(); node != nullptr)
      sensor.insert_or_assign(key, *node);
  }
  out.text = as_text(mine);
  return out;
}

std::string Config::restart_for(const Config& other) const {
  return differing({{"plugin_folder", plugin_folders == other.plugin_folders},
                    {"lcm_url", lcm_url == other.lcm_url},
                    {"log_level", log_level == other.log_level},
                    {"lock_memory", lock_memory == other.lock_memory},
                    {"state_folder", state_folder == other.state_folder}});
}

Config parse_config(const std::string& text, const std::string& path) {
  toml::table root;
  try {
    root = parse_toml(text, path);
  } catch (const std::runtime_error& error) {
    throw ConfigError(error.what());
  }
  Context context;
  context.file = path;
  context.folder = std::filesystem::absolute(path).parent_path();
  Config out;
  out.file = path;
  TableReader in(root, "", path, context.errors);
  if (const toml::table* const daemon = in.table("daemon")) read_daemon(*daemon, out, context);
  std::set<std::string> channels;
  for (const toml::table* const sensor : in.tables("sensor")) {
    out.sensors.push_back(read_sensor(*sensor, context));
    const SensorConfig& read = out.sensors.back();
    // By LCM channel, which has capitals only; a sensor takes three, and `a_status` has the second of `a`.
    std::string taken;
    for (const std::string_view ending : {std::string_view(), kStatusEnding, kImuEnding})
      if (const std::string channel = read.lcm_channel() + std::string(ending);
          !channels.insert(channel).second && taken.empty())
        taken = channel;
    if (!read.name.empty() && channel_name(read.lcm_channel()).content != ChannelContent::rate)
      TableReader(*sensor, "sensor", path, context.errors)
          .complain("name", " = " + in_quotes(read.name) +
                                ": expected one that does not end in _status or _imu, as other channels do");
    else if (!read.name.empty() && !taken.empty())
      TableReader(*sensor, "sensor", path, context.errors)
          .complain("name",
                    " = " + in_quotes(read.name) + ": another sensor publishes on " + taken + " already");
  }
  if (!in.has("sensor")) context.errors.push_back(path + ": no [[sensor]]: expected at least one");
  in.refuse_the_rest();
  if (!context.errors.empty()) throw ConfigError(joined(context.errors));
  return out;
}

Config read_config(const std::string& path) {
  std::string text;
  try {
    text = read_toml_text(path);
  } catch (const std::exception& error) {
    throw ConfigError(error.what());
  }
  Config out = parse_config(text, path);
  use_adopted_models(out, state_folder(out.state_folder));
  return out;
}

}  // namespace ifog
