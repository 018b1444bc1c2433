// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/watch.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

// Recordings before the exchange, in which effects with memory settle.
constexpr std::size_t kFilesBefore = 3;
constexpr std::uint64_t kMostBytesBefore = 64'000'000;

// Number of rows in those recordings; unreadable recordings are skipped.
std::size_t rows_to_settle(const SensorConfig& sensor, std::vector<RecordedFile>& files, const Field& field) {
  if (files.empty()) return 0;
  try {
    return read_recorded(sensor, files, field.required_config().plugin_folders).capture.view().size();
  } catch (const std::exception&) {
    files.clear();
    return 0;
  }
}

void weigh(Watched& out, const Field& field, const SensorConfig& sensor, const Model& before,
           const Model& after, std::uint64_t recorded_before) {
  if (sensor.record.folder.empty()) {
    out.not_weighed = "nothing is recorded of the sensor ([sensor.record])";
    return;
  }
  try {
    std::vector<RecordedFile> all = recorded_files(sensor), settling;
    std::uint64_t bytes = 0;
    while (!all.empty() && all.front().number <= recorded_before) {
      settling.push_back(all.front());
      bytes += all.front().bytes;
      all.erase(all.begin());
    }
    while (settling.size() > kFilesBefore || bytes > kMostBytesBefore) {
      bytes -= settling.front().bytes;
      settling.erase(settling.begin());
    }
    if (all.empty()) {
      out.not_weighed = "nothing was recorded meanwhile";
      return;
    }
    const std::size_t begin = rows_to_settle(sensor, settling, field);
    all.insert(all.begin(), settling.begin(), settling.end());
    const Recorded recorded = read_recorded(sensor, all, field.required_config().plugin_folders);
    out.gain = weigh_models(recorded, before, after, begin);
    if (out.gain.empty()) out.not_weighed = "the two models corrected alike meanwhile";
  } catch (const std::exception& error) {
    // The history must not quote content of a recording.
    warn("{}\n", error.what());
    out.not_weighed = "the recordings could not be used";
  }
}

}  // namespace

Watched watch(LiveStatus& live, const Field& field, const SensorConfig& sensor, const Model& before,
              const Model& after, std::uint64_t recorded_before, double seconds) {
  using Clock = std::chrono::steady_clock;
  Watched out;
  const Clock::time_point start = Clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  std::optional<status_t> first;
  {
    Progress progress("watching " + sensor.name, static_cast<std::size_t>(std::max(1.0, seconds)));
    std::int64_t last = 0;
    const auto take = [&](const status_t& status) {
      if (std::exchange(last, status.utime) == status.utime) return;
      if (!first) first = status;
      ++out.statuses;
      out.divergences = status.divergences - first->divergences;
      out.gated = status.gated - first->gated;
      if (!status.notice.empty()) out.noticed = status.notice;
      out.nis.resize(status.nis_mean.size());
      out.whiteness.resize(status.nis_mean.size());
      const auto n = static_cast<double>(out.statuses);
      for (std::size_t a = 0; a < out.nis.size(); ++a) {
        out.nis[a] += (status.nis_mean[a] - out.nis[a]) / n;
        out.whiteness[a] += (status.whiteness[a] - out.whiteness[a]) / n;
      }
      progress.at(static_cast<std::size_t>(passed()));
    };
    try {
      live.ask(std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1e3)), [&](const Statuses& all) {
        if (const auto now = all.find(sensor.name); now != all.end()) take(now->second);
        return passed() >= seconds;
      });
    } catch (const std::exception& error) {
      warn("{}\n", error.what());
    }
  }
  out.seconds = std::min(passed(), seconds);
  out.whole = passed() >= seconds;
  weigh(out, field, sensor, before, after, recorded_before);
  return out;
}

std::string outcome(const Watched& watched) {
  if (watched.gain.empty()) return "whether the promise came true cannot be judged: " + watched.not_weighed;
  std::string figures;
  for (const AxisGain& axis : watched.gain) {
    figures += (figures.empty() ? "" : ", ") + (axis.axis.empty() ? "" : axis.axis + ": ") +
               (std::isfinite(axis.kept.share_error)
                    ? fmt::format("{:.0f} ± {:.0f} % of the predicted improvement was achieved",
                                  100.0 * axis.kept.share, 100.0 * axis.kept.share_error)
                    : "the new model's correction did not move");
  }
  if (const std::string errors = gain_text(watched.gain); !errors.empty()) figures += "; " + errors;
  switch (verdict_of(watched.gain)) {
    case PromiseVerdict::kept:
      return "the promise came true: " + figures;
    case PromiseVerdict::in_part:
      return "the promise came true in part: " + figures;
    case PromiseVerdict::broken:
      return "the promise was broken, the model before was better: " + figures;
    case PromiseVerdict::open:
      break;
  }
  return "whether the promise came true cannot be judged yet, too little has changed around the sensor: " +
         figures;
}

}  // namespace ifog::tools
