// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/results.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "drivers/capture/files/input_file.h"
#include "drivers/ifog/quoted.h"
#include "filters/model_file/sha256.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/json.h"

namespace ifog {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TypeCandidate, found_in, forms)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ChannelRange, channel, low, high)
}  // namespace ifog

namespace ifog::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShort = 16;  // hex digits of an id
constexpr const char *kTypeSchema = "ifog.type/1", *kGyroSchema = "ifog.gyro/1",
                     *kMeasuredSchema = "ifog.measured/1";

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path))
    throw refusal("{}: cannot make the folder: {}", path.string(),
                  error ? error.message() : "something of that name exists");
}

// nullopt: missing, truncated, or from another program.
template <typename T>
std::optional<T> read_marker(const std::string& path, const std::string& schema) {
  std::error_code none;
  if (!fs::is_regular_file(path, none)) return std::nullopt;
  try {
    const nlohmann::json json = parse_json(read_whole_file(path), path);
    if (json.at("schema") != schema) return std::nullopt;
    return json.get<T>();
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

std::string stamp(const fs::path& path) {
  std::error_code error;
  const auto size = fs::is_regular_file(path, error) ? fs::file_size(path, error) : 0;
  const auto time = fs::last_write_time(path, error);
  return path.string() + "\n" + (error ? "missing" : std::to_string(size)) + "\n" +
         (error ? "" : std::to_string(time.time_since_epoch().count())) + "\n";
}

}  // namespace

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EffectOfType, of_type, effect, likelihood_ratio, not_measured, instead)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(AxisMeasured, axis, together, beside, covariance, means, ranges)
// Content of the files after their schema.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TypeToMeasure, id, type, effects)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(GyroDone, serial, captures, inputs, failed)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(GyroMeasured, serial, type, inputs, failed, axes)

Results::Results(std::string folder) : folder_(std::move(folder)) { make_folder(fs::path(folder_) / "log"); }

std::string Results::path(const std::string& file) const { return (fs::path(folder_) / file).string(); }

std::string Results::log(std::size_t gyro) const { return path("log/" + std::to_string(gyro) + ".txt"); }

std::string Results::see_log(std::size_t gyro) const {
  const std::string file = log(gyro);
  std::error_code none;
  if (const auto bytes = fs::file_size(file, none); !none && bytes > 0) return ", see " + file;
  // On a full disk the output is lost too; writing one byte detects that.
  const int fd = ::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  const bool written = fd >= 0 && ::write(fd, "\n", 1) == 1;
  const int error = errno;
  if (fd >= 0) ::close(fd);
  return written ? ", see " + file : ", and " + file + ": cannot write: " + std::strerror(error);
}

std::string Results::path(const FleetGyro& gyro, const std::string& file) const {
  return path("gyros/" + gyro.serial + "/" + file);
}

void Results::make_folder_of(const FleetGyro& gyro) const { make_folder(path(gyro, "")); }

std::optional<TypeToMeasure> Results::type() const {
  auto file = read_marker<TypeToMeasure>(path("type.json"), kTypeSchema);
  // The id becomes part of a file name.
  if (file &&
      (file->id.size() != kShort || file->id.find_first_not_of("0123456789abcdef") != std::string::npos))
    file.reset();
  return file;
}

std::optional<GyroDone> Results::done(const FleetGyro& gyro) const {
  return read_marker<GyroDone>(path(gyro, "gyro.json"), kGyroSchema);
}

std::optional<GyroMeasured> Results::measured(const FleetGyro& gyro, const std::string& type_id) const {
  return read_marker<GyroMeasured>(path(gyro, measured_name(type_id)), kMeasuredSchema);
}

void Results::write(TypeToMeasure& type) const {
  type.id =
      sha256_hex(nlohmann::json(type.effects).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace))
          .substr(0, kShort);
  write_json(path("type.json"), with_schema(kTypeSchema, type));
}

void Results::write(const FleetGyro& gyro, const GyroDone& done) const {
  write_json(path(gyro, "gyro.json"), with_schema(kGyroSchema, done));
}

void Results::write(const FleetGyro& gyro, const GyroMeasured& measured) const {
  write_json(path(gyro, measured_name(measured.type)), with_schema(kMeasuredSchema, measured));
}

void Results::forget(const std::string& file) const {
  std::error_code error;
  fs::remove(path(file), error);
  if (error) throw refusal("{}: cannot be removed: {}", path(file), error.message());
}

void Results::forget(const FleetGyro& gyro, const std::string& file) const {
  forget("gyros/" + gyro.serial + "/" + file);
}

std::string measured_name(const std::string& type_id) { return "measured-" + type_id + ".json"; }

std::string identity_of(const FleetGyro& gyro, const std::string& options) {
  std::string text = options + "\n";
  for (const std::string& capture : gyro.captures) {
    text += stamp(capture);
    std::error_code none;
    if (!fs::is_directory(capture, none)) continue;
    std::vector<std::string> inside;
    for (const fs::directory_entry& each : fs::directory_iterator(capture, none))
      inside.push_back(stamp(each.path()));
    std::ranges::sort(inside);
    for (const std::string& each : inside) text += each;
  }
  return sha256_hex(text).substr(0, kShort);
}

}  // namespace ifog::tools
