// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/config.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "daemon/config/lcm_url.h"
#include "daemon/config/reading_context.h"
#include "daemon/config/table_reader.h"
#include "daemon/state/state_folder.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"
#include "filters/chain/plausibility.h"
#include "filters/model_file/toml_file.h"
#include "filters/settings/filter_table.h"
#include "msgs/channel_name.h"

namespace ifog {
namespace {

std::string as_text(const toml::table& table) {
  std::ostringstream text;
  text << table;
  return text.str();
}

// Notes the line of every key, including nested tables; keys of a channel are under its name.
void note_lines(const toml::table& table, const std::string& path, KeyLines& out) {
  for (const auto& [key, node] : table) {
    const std::string here = path + std::string(key.str());
    out.emplace(here, node.source().begin.line);
    if (const toml::table* const inner = node.as_table()) note_lines(*inner, here + ".", out);
    const toml::array* const array = node.as_array();
    for (std::size_t i = 0; array != nullptr && i < array->size(); ++i)
      if (const toml::table* const inner = array->get(i)->as_table()) {
        const std::string name =
            here + "." + inner->at_path("name").value_or(inner->at_path("channel").value_or(std::string()));
        out.emplace(name, inner->source().begin.line);
        note_lines(*inner, name + ".", out);
      }
  }
}

bool good_name(const std::string& name) {
  constexpr std::size_t kLongest = 32;
  return !name.empty() && name.size() <= kLongest && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
}

FilterChoice read_filter(const toml::table& table, double& start_up_s, ReadingContext& context) {
  TableReader in(table, "sensor.filter", context.file, context.errors);
  FilterChoice out;
  for (const FilterSetting& setting : filter_table()) in.filter_setting(setting, out);
  take(in.number("start_up_s", {0.01, 3600.0}), start_up_s);
  in.refuse_the_rest();
  return out;
}

RealtimeConfig read_realtime(const toml::table& table, ReadingContext& context) {
  TableReader in(table, "sensor.realtime", context.file, context.errors);
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

RecordConfig read_record(const toml::table& table, ReadingContext& context) {
  TableReader in(table, "sensor.record", context.file, context.errors);
  RecordConfig out;
  const std::size_t errors_before = context.errors.size();
  out.folder = context.absolute(in.required_text("folder", "a folder, \"/var/lib/ifogd/record\""));
  take(in.integer("bytes", 1'000'000, std::numeric_limits<std::int64_t>::max()), out.bytes);
  take(in.number("days", {1e-3, 1e5}), out.days);
  take(in.integer("file_bytes", 100'000, 1'000'000'000), out.file_bytes);
  take(in.number("file_s", {1.0, 1e6}), out.file_s);
  take(in.integer("buffer_bytes", 262'144, 1'000'000'000), out.buffer_bytes);
  // With fewer than four files, removing the oldest would remove most data. Not checked after an error of a
  // single number.
  if (context.errors.size() == errors_before && out.bytes / 4 < out.file_bytes)
    in.complain(in.has("bytes") ? "bytes" : "file_bytes",
                ": bytes = " + std::to_string(out.bytes) + " with file_bytes = " +
                    std::to_string(out.file_bytes) + ": expected room for at least four files");
  in.refuse_the_rest();
  return out;
}

SensorConfig read_sensor(const toml::table& table, ReadingContext& context) {
  TableReader in(table, "sensor", context.file, context.errors);
  SensorConfig out;
  out.line = table.source().begin.line;
  note_lines(table, "", out.lines);
  out.folder = context.folder.string();
  out.name = in.required_text("name", "a name, letters, digits, _ and -");
  if (!out.name.empty() && !good_name(out.name))
    in.complain("name", " = " + in_quotes(out.name) + ": expected at most 32 letters, digits, _ and -");
  out.driver = in.required_text("driver", "the name of a driver, see `ifog drivers`");
  out.model = context.absolute(in.text("model").value_or(""));
  take(in.number("nominal_rate_hz", {1e-3, 1e6}), out.nominal_rate_hz);
  take(in.number("range_radps", {1e-9, kMostRate_radps}), out.range_radps);
  out.limits = read_limits(in, kMostRate_radps, context);
  if (out.range_radps > 0.0 && !context.recorded) {
    if (out.limits.minimum >= out.range_radps)
      in.complain("minimum", ": expected less than range_radps, or no rate is left");
    if (out.limits.maximum <= -out.range_radps)
      in.complain("maximum", ": expected more than -range_radps, or no rate is left");
  }
  take(in.boolean("imu"), out.imu);
  take(in.boolean("powered_with_computer"), out.powered_with_computer);
  if (const toml::table* const transport = in.table("transport"))
    out.transport = read_transport(*transport, context);
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
  if (const auto rate = out.options.find("rate_hz"); rate != out.options.end() && !context.recorded) {
    const double hz = std::strtod(rate->second.c_str(), nullptr);
    if (hz > 0.0 && out.nominal_rate_hz > 0.0 && std::abs(out.nominal_rate_hz / hz - 1.0) > 0.01)
      in.complain("nominal_rate_hz", ": options.rate_hz is " + in_quotes(rate->second) +
                                         "; expected the same, or one of the two");
  }
  if (const toml::table* const filter = in.table("filter"))
    out.filter = read_filter(*filter, out.start_up_s, context);
  if (const toml::table* const realtime = in.table("realtime"))
    out.realtime = read_realtime(*realtime, context);
  if (const toml::table* const record = in.table("record")) out.record = read_record(*record, context);
  for (const toml::table* const publish : in.tables("publish"))
    out.publish.push_back(read_publish(*publish, context));
  std::set<std::string> names;
  for (const toml::table* const channel : in.tables("channel")) {
    out.channels.push_back(read_channel(*channel, context));
    const std::string& name = out.channels.back().name;
    if (!name.empty() && !names.insert(name).second)
      TableReader(*channel, "sensor.channel", context.file, context.errors)
          .complain("name", " = " + in_quotes(name) + ": this sensor has a channel of that name already");
  }
  in.refuse_the_rest();
  out.text = as_text(toml::table{{"sensor", toml::array{table}}});
  return out;
}

void read_daemon(const toml::table& table, Config& out, ReadingContext& context) {
  TableReader in(table, "daemon", context.file, context.errors);
  if (const auto folder = in.text("plugin_folder")) out.plugin_folders = {context.absolute(*folder)};
  note_lines(table, "", out.lines);
  if (const auto url = in.text("lcm_url")) {
    out.lcm_url = *url;
    if (const std::string expected = lcm_url_complaint(*url); !expected.empty())
      in.complain("lcm_url", " = " + in_quotes(*url) + ": expected " + expected);
  }
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

std::uint32_t SensorConfig::line_of(std::string_view key) const {
  for (;;) {
    if (const auto found = lines.find(key); found != lines.end()) return found->second;
    const std::size_t end = key.rfind('.');
    if (end == std::string_view::npos) return line;
    key = key.substr(0, end);
  }
}

std::string SensorConfig::lcm_channel() const {
  std::string out = "IFOG_" + name;
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return out;
}

namespace {

// Names of the keys that differ.
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
                    {"publish", publish == other.publish},
                    {"powered_with_computer", powered_with_computer == other.powered_with_computer},
                    {"realtime", realtime == other.realtime},
                    {"record", record == other.record},
                    {"channel", channels == other.channels}});
}

SensorConfig SensorConfig::reloaded(const SensorConfig& fresh) const {
  SensorConfig out = *this;
  out.model = fresh.model;
  out.model_adopted = fresh.model_adopted;
  out.filter = fresh.filter;
  out.start_up_s = fresh.start_up_s;
  out.lines = fresh.lines;
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

namespace {

Config parse(const std::string& text, const std::string& path, bool recorded) {
  toml::table root;
  try {
    root = parse_toml(text, path);
  } catch (const std::runtime_error& error) {
    throw ConfigError(error.what());
  }
  ReadingContext context{path, std::filesystem::absolute(path).parent_path(), recorded, {}};
  Config out;
  out.file = path;
  TableReader in(root, "", path, context.errors);
  if (const toml::table* const daemon = in.table("daemon")) read_daemon(*daemon, out, context);
  std::set<std::string> channels;
  const std::vector<const toml::table*> sensors = in.tables("sensor");
  if (sensors.size() > kInputLimits.sensors)
    throw ConfigError(path + ": " + std::to_string(sensors.size()) + " tables [[sensor]], expected at most " +
                      std::to_string(kInputLimits.sensors));
  for (const toml::table* const sensor : sensors) {
    out.sensors.push_back(read_sensor(*sensor, context));
    const SensorConfig& read = out.sensors.back();
    // LCM channel names are in capitals; a sensor uses three, and `a_status` conflicts with the second of
    // `a`.
    std::string claimed;
    for (const std::string_view ending : {std::string_view(), kStatusEnding, kImuEnding})
      if (const std::string channel = read.lcm_channel() + std::string(ending);
          !channels.insert(channel).second && claimed.empty())
        claimed = channel;
    for (const PublishedType& publish : read.publish)
      if (!publish.channel.empty() && !channels.insert(publish.channel).second)
        context.errors.push_back(path + ":" +
                                 std::to_string(read.line_of("publish." + publish.channel + ".channel")) +
                                 ": sensor.publish.channel = " + in_quotes(publish.channel) +
                                 ": something else is published on it already, expected another channel");
    if (!read.name.empty() && channel_name(read.lcm_channel()).content != ChannelContent::rate)
      TableReader(*sensor, "sensor", path, context.errors)
          .complain("name", " = " + in_quotes(read.name) +
                                ": expected one that does not end in _status or _imu, as other channels do");
    else if (!read.name.empty() && !claimed.empty())
      TableReader(*sensor, "sensor", path, context.errors)
          .complain("name",
                    " = " + in_quotes(read.name) + ": another sensor publishes on " + claimed + " already");
  }
  if (!in.has("sensor")) context.errors.push_back(path + ": no [[sensor]]: expected at least one");
  in.refuse_the_rest();
  if (!recorded)
    for (const auto& found : {shared_sources(out), feedback_loops(out)})
      context.errors.insert(context.errors.end(), found.begin(), found.end());
  if (!context.errors.empty()) throw ConfigError(joined(context.errors));
  return out;
}

}  // namespace

Config parse_config(const std::string& text, const std::string& path) { return parse(text, path, false); }

Config parse_recorded_config(const std::string& text, const std::string& path) {
  return parse(text, path, true);
}

void use_adopted_models(Config& config, const std::string& folder) {
  if (folder.empty()) return;
  for (SensorConfig& sensor : config.sensors) {
    const std::string path = std::filesystem::absolute(adopted_model_path(folder, sensor.name)).string();
    if (!sensor.model.empty() || !is_in_state_folder(path)) continue;
    sensor.model = path;
    sensor.model_adopted = true;
    // So that flight recordings contain the model in use.
    toml::table table = parse_toml(sensor.text, "");
    table["sensor"][0].as_table()->insert_or_assign("model", sensor.model);
    sensor.text = as_text(table);
  }
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
