// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/results.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "drivers/capture/files/input_file.h"
#include "drivers/ifog/quoted.h"
#include "filters/model_file/sha256.h"
#include "tools/ifog/console/json_file.h"
#include "tools/ifog/field/state_json.h"

namespace ifog::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kShort = 16;  // hex digits of an id

void forget(const std::string& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) throw std::runtime_error(path + ": cannot be removed: " + error.message());
}

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path))
    throw std::runtime_error(path.string() + ": cannot make the folder: " +
                             (error ? error.message() : "something of that name exists"));
}

// What was written, or nothing: missing, cut short by an old disk, of another program.
template <typename Read>
auto read_marker(const std::string& path, const std::string& schema, Read&& read)
    -> std::optional<decltype(read(nlohmann::json{}))> {
  std::error_code none;
  if (!fs::is_regular_file(path, none)) return std::nullopt;
  try {
    const nlohmann::json json = parse_json(read_whole_file(path), path);
    if (json.at("schema") != schema) return std::nullopt;
    return read(json);
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

std::optional<std::string> words_or_null(const nlohmann::json& json) {
  if (json.is_null()) return std::nullopt;
  return json.get<std::string>();
}

Json words_or_null(const std::optional<std::string>& words) { return words ? Json(*words) : Json(nullptr); }

std::string stamp(const fs::path& path) {
  std::error_code error;
  const auto size = fs::is_regular_file(path, error) ? fs::file_size(path, error) : 0;
  const auto time = fs::last_write_time(path, error);
  return path.string() + "\n" + (error ? "missing" : std::to_string(size)) + "\n" +
         (error ? "" : std::to_string(time.time_since_epoch().count())) + "\n";
}

AxisMeasured axis_of(const nlohmann::json& json) {
  AxisMeasured axis;
  axis.axis = json.at("axis").get<std::string>();
  axis.covariance = json.at("covariance").get<std::vector<double>>();
  for (const nlohmann::json& each : json.at("together")) {
    axis.of_type.push_back(each.at("of_type").get<std::size_t>());
    axis.together.push_back({effect_of(each.at("effect")), each.at("likelihood_ratio").get<double>(),
                             each.at("not_measured").get<std::string>(),
                             each.at("instead").get<std::vector<double>>()});
  }
  for (const nlohmann::json& each : json.at("beside")) axis.beside.push_back(effect_of(each));
  for (const nlohmann::json& each : json.at("ranges"))
    axis.ranges.push_back(
        {each.at("channel").get<std::string>(), each.at("low").get<double>(), each.at("high").get<double>()});
  return axis;
}

Json axis_json(const AxisMeasured& axis) {
  Json json = {{"axis", axis.axis}, {"together", Json::array()}, {"beside", Json::array()}};
  for (std::size_t i = 0; i < axis.together.size(); ++i) {
    const MeasuredEffect& each = axis.together[i];
    json["together"].push_back({{"of_type", axis.of_type[i]},
                                {"effect", effect_json(each.effect)},
                                {"likelihood_ratio", each.likelihood_ratio},
                                {"not_measured", each.not_measured},
                                {"instead", each.instead}});
  }
  for (const Effect& each : axis.beside) json["beside"].push_back(effect_json(each));
  json["covariance"] = axis.covariance;
  json["ranges"] = Json::array();
  for (const ChannelRange& each : axis.ranges)
    json["ranges"].push_back({{"channel", each.channel}, {"low", each.low}, {"high", each.high}});
  return json;
}

}  // namespace

Results::Results(std::string folder) : folder_(std::move(folder)) { make_folder(fs::path(folder_) / "log"); }

std::string Results::path(const std::string& file) const { return (fs::path(folder_) / file).string(); }

std::string Results::log(std::size_t gyro) const { return path("log/" + std::to_string(gyro) + ".txt"); }

std::string Results::told_in_log(std::size_t gyro) const {
  const std::string file = log(gyro);
  std::error_code none;
  if (const auto bytes = fs::file_size(file, none); !none && bytes > 0) return ", see " + file;
  // A full disk takes nothing of what was said, either; the next byte shows it.
  const int fd = open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  const bool written = fd >= 0 && write(fd, "\n", 1) == 1;
  const int error = errno;
  if (fd >= 0) close(fd);
  return written ? ", see " + file : ", and " + file + ": cannot write: " + std::strerror(error);
}

std::string Results::path(const FleetGyro& gyro, const std::string& file) const {
  return (fs::path(folder_) / "gyros" / gyro.serial / file).string();
}

void Results::make_folder_of(const FleetGyro& gyro) const { make_folder(path(gyro, "")); }

std::optional<TypeToMeasure> Results::type() const {
  return read_marker(path("type.json"), "ifog.type/1", [](const nlohmann::json& json) {
    TypeToMeasure type;
    type.id = json.at("id").get<std::string>();
    if (type.id.size() != kShort || type.id.find_first_not_of("0123456789abcdef") != std::string::npos)
      throw std::runtime_error("an id that is none");  // it becomes part of a file's name
    for (const nlohmann::json& each : json.at("effects")) {
      TypeCandidate candidate;
      candidate.found_in = each.at("found_in").get<std::size_t>();
      for (const nlohmann::json& form : each.at("forms")) candidate.forms.push_back(effect_of(form));
      type.effects.push_back(std::move(candidate));
    }
    return type;
  });
}

void Results::write_type(const std::string& type, TypeToMeasure& effects) const {
  Json json = {{"schema", "ifog.type/1"}, {"id", ""}, {"type", type}, {"effects", Json::array()}};
  for (const TypeCandidate& each : effects.effects) {
    Json forms = Json::array();
    for (const Effect& form : each.forms) forms.push_back(effect_json(form));
    json["effects"].push_back({{"found_in", each.found_in}, {"forms", std::move(forms)}});
  }
  effects.id =
      sha256_hex(json["effects"].dump(-1, ' ', true, Json::error_handler_t::replace)).substr(0, kShort);
  json["id"] = effects.id;
  write_json(path("type.json"), json);
}

void Results::forget_type() const { forget(path("type.json")); }

void Results::forget_done(const FleetGyro& gyro) const { forget(path(gyro, "gyro.json")); }

void Results::forget_measured(const FleetGyro& gyro, const std::string& type_id) const {
  forget(path(gyro, "measured-" + type_id + ".json"));
}

void Results::forget_with_prior(const FleetGyro& gyro) const { forget(path(gyro, "with_prior.toml")); }

void Results::forget_population() const {
  forget(path("fleet.json"));
  forget(path("fleet.html"));
}

std::optional<GyroDone> Results::done(const FleetGyro& gyro) const {
  return read_marker(path(gyro, "gyro.json"), "ifog.gyro/1", [](const nlohmann::json& json) {
    return GyroDone{json.at("inputs").get<std::string>(), words_or_null(json.at("failed"))};
  });
}

void Results::write_done(const FleetGyro& gyro, const GyroDone& done) const {
  write_json(path(gyro, "gyro.json"), Json{{"schema", "ifog.gyro/1"},
                                           {"serial", gyro.serial},
                                           {"captures", gyro.captures},
                                           {"inputs", done.inputs},
                                           {"failed", words_or_null(done.failed)}});
}

std::optional<GyroMeasured> Results::measured(const FleetGyro& gyro, const std::string& type_id) const {
  const std::string file = path(gyro, "measured-" + type_id + ".json");
  return read_marker(file, "ifog.measured/1", [](const nlohmann::json& json) {
    GyroMeasured measured{json.at("inputs").get<std::string>(), words_or_null(json.at("failed")), {}};
    for (const nlohmann::json& each : json.at("axes")) measured.axes.push_back(axis_of(each));
    return measured;
  });
}

void Results::write_measured(const FleetGyro& gyro, const std::string& type_id,
                             const GyroMeasured& measured) const {
  Json json = {{"schema", "ifog.measured/1"},
               {"serial", gyro.serial},
               {"type", type_id},
               {"inputs", measured.inputs},
               {"failed", words_or_null(measured.failed)},
               {"axes", Json::array()}};
  for (const AxisMeasured& each : measured.axes) json["axes"].push_back(axis_json(each));
  write_json(path(gyro, "measured-" + type_id + ".json"), json);
}

std::string identity_of(const FleetGyro& gyro, const std::string& options) {
  std::string text = options + "\n";
  for (const std::string& capture : gyro.captures) {
    text += stamp(capture);
    std::error_code none;
    if (!fs::is_directory(capture, none)) continue;
    std::vector<std::string> inside;
    for (const fs::directory_entry& each : fs::directory_iterator(capture, none))
      inside.push_back(stamp(each.path()));
    std::sort(inside.begin(), inside.end());
    for (const std::string& each : inside) text += each;
  }
  return sha256_hex(text).substr(0, kShort);
}

}  // namespace ifog::tools
