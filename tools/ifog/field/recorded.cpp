// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/recorded.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <deque>
#include <filesystem>
#include <optional>
#include <string_view>

#include "drivers/capture/files/input_file.h"
#include "tools/ifog/captures/flight/flight_input.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/progress.h"

namespace ifog::tools {
namespace {

namespace fs = std::filesystem;

// Of the date in NUMBER-20260131T130509Z.ifr; 0 for other names.
std::time_t opened_at(const char* date) {
  std::tm utc{};
  return strptime(date, "%Y%m%dT%H%M%SZ", &utc) == nullptr ? 0 : timegm(&utc);
}

struct PowerUp {
  std::int64_t powered_ns;
  std::string boot;
};

// Power-up in the file's header; nullopt also if the file cannot be read, which is reported later.
std::optional<PowerUp> power_up(const RecordedFile& file) try {
  InputFile input(file.path, std::deque<std::string>{file.path});
  const FlightInput flight(input);
  if (!flight.header().powered_ns) return std::nullopt;
  return PowerUp{*flight.header().powered_ns, flight.header().boot};
} catch (const std::exception&) {
  return std::nullopt;
}

// Tolerance for changes of the wall clock between runs of the daemon.
constexpr std::int64_t kOnePowerUp_ns = 10'000'000'000;

// Compares boot identities too, because clocks may start at the same time every day.
bool same(const PowerUp& a, const PowerUp& b) {
  if (!a.boot.empty() && !b.boot.empty() && a.boot != b.boot) return false;
  return std::abs(a.powered_ns - b.powered_ns) <= kOnePowerUp_ns;
}

// The parts of the stretches from row `begin` on.
std::vector<Stretch> from_row(const std::vector<Stretch>& all, std::size_t begin) {
  std::vector<Stretch> out;
  for (const Stretch& each : all)
    if (each.end > begin) out.push_back({std::max(each.begin, begin), each.end});
  return out;
}

}  // namespace

std::vector<RecordedFile> recorded_files(const SensorConfig& sensor) {
  std::vector<RecordedFile> out;
  std::error_code error;
  const fs::path folder = fs::path(sensor.record.folder) / sensor.name;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    RecordedFile file;
    file.open = name.ends_with(".ifr.open");
    if (!file.open && !name.ends_with(".ifr")) continue;
    const auto [end, wrong] = std::from_chars(name.data(), name.data() + name.size(), file.number);
    if (wrong != std::errc() || *end != '-') continue;
    file.opened = opened_at(end + 1);
    // Links are ignored, because others may write here. The file may have been removed or renamed.
    std::error_code gone;
    if (entry.symlink_status(gone).type() != fs::file_type::regular) continue;
    file.bytes = entry.file_size(gone);
    if (gone) continue;
    file.path = entry.path().string();
    out.push_back(std::move(file));
  }
  if (error && error != std::errc::no_such_file_or_directory)
    throw refusal("{}: cannot read: {}", folder.string(), error.message());
  std::ranges::sort(out, [](const RecordedFile& a, const RecordedFile& b) { return a.number < b.number; });
  return out;
}

std::vector<RecordedFile> newest(std::span<const RecordedFile> files, std::size_t most, double most_bytes) {
  std::vector<RecordedFile> out;
  double bytes = 0.0;
  for (auto file = files.rbegin(); file != files.rend() && out.size() < most; ++file) {
    bytes += static_cast<double>(file->bytes);
    if (!out.empty() && bytes > most_bytes) break;
    out.insert(out.begin(), *file);
  }
  return out;
}

std::vector<RecordedFile> of_one_power_up(const std::vector<RecordedFile>& files) {
  std::vector<RecordedFile> best, these;
  std::uint64_t most = 0, bytes = 0;
  std::optional<PowerUp> since;
  for (const RecordedFile& file : files) {
    const std::optional<PowerUp> now = power_up(file);
    if (now && since && !same(*now, *since)) {
      these.clear();
      bytes = 0;
    }
    if (now) since = now;
    these.push_back(file);
    bytes += file.bytes;
    if (bytes < most) continue;
    most = bytes;
    best = these;
  }
  return best;
}

Recorded read_recorded(const SensorConfig& sensor, const std::vector<RecordedFile>& files,
                       const std::vector<std::string>& plugin_folders) {
  const std::string folder = (fs::path(sensor.record.folder) / sensor.name).string();
  if (files.empty()) throw refusal("{}: no recordings", folder);
  std::deque<std::string> paths;
  for (const RecordedFile& file : files) paths.push_back(file.path);
  InputFile input(folder, std::move(paths));
  const ReadingProgress progress(input);
  FlightInput flight(input);
  DriverInstance driver = flight.make_driver("", {}, plugin_folders, &sensor);
  LongCapture read(flight.table(driver), folder);
  const CaptureView& capture = read.view();
  if (capture.size() < 2) throw refusal("{}: fewer than two samples recorded", folder);
  const double period_s = sample_clock(capture.time_s).period_s;
  Rest rest = find_rest(capture.rate_radps, {}, period_s);
  return {std::move(read), period_s, std::move(rest)};
}

std::vector<AxisGain> weigh_models(const Recorded& recorded, const Model& before, const Model& after,
                                   std::size_t begin) {
  const CaptureView& capture = recorded.capture.view();
  const std::vector<Samples> old_rate = compensated_rates(capture, before);
  const std::vector<Samples> new_rate = compensated_rates(capture, after);
  const std::vector<Stretch> at_rest = from_row(recorded.rest.at_rest, begin);
  std::vector<AxisGain> out;
  for (std::size_t axis = 0; axis < old_rate.size(); ++axis) {
    const bool changes = [&] {
      for (std::size_t i = begin; i < old_rate[axis].size(); ++i)
        if (old_rate[axis][i] != new_rate[axis][i] && std::isfinite(old_rate[axis][i])) return true;
      return false;
    }();
    if (!changes) continue;
    out.push_back(
        {capture.axes[axis], weigh_promise({capture.time_s, old_rate[axis], new_rate[axis], at_rest})});
  }
  return out;
}

}  // namespace ifog::tools
