// SPDX-License-Identifier: Apache-2.0
#include "daemon/sensor/noise_memory.h"

#include <cmath>
#include <exception>
#include <filesystem>

#include "daemon/state/state_folder.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/utc_now.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr std::int64_t kEvery_ns = 600'000'000'000;
// Nominal rates with a smaller relative difference are of the same sensor.
constexpr double kSameRate = 0.01;

std::string in_words(const KeptNoise& kept) {
  return "noise as learned until " + printable(kept.learned) + ": " +
         formatted(
             "process_noise = %.4g (rad/s)^2/s, measurement_noise = %.4g (rad/s)^2, from %.0f s at rest",
             kept.noise.process_noise, kept.noise.measurement_noise,
             kept.noise.samples / kept.sample_rate_hz);
}

}  // namespace

NoiseMemory::NoiseMemory(const std::string& folder, const std::string& sensor, const std::string& driver,
                         const SensorFacts& facts) {
  if (folder.empty()) return;
  path_ = (std::filesystem::path(folder) / noise_file_name(sensor)).string();
  kept_.sensor = sensor;
  kept_.driver = driver;
  kept_.axes = facts.axes;
  kept_.sample_rate_hz = facts.nominal_rate_hz;
  if (!is_in_state_folder(path_)) return;
  try {
    const KeptNoise found = parsed_state_file(path_, parse_kept_noise);
    const bool same = found.driver == driver && found.axes == facts.axes &&
                      std::abs(found.sample_rate_hz / facts.nominal_rate_hz - 1.0) < kSameRate;
    if (same) {
      recalled_ = found.noise;
      kept_.learned = found.learned;
      remark_ = in_words(found);
    } else {
      remark_ = path_ + ": is for driver \"" + printable(found.driver) + "\", " + std::to_string(found.axes) +
                " axes at " + std::to_string(found.sample_rate_hz) + " Hz: learned again";
    }
  } catch (const std::exception& error) {
    remark_ = std::string(error.what()) + ": learned again";
  }
}

std::string NoiseMemory::text(const std::optional<LearnedNoise>& learned) const {
  if (!learned) return "";
  KeptNoise out = kept_;
  out.noise = *learned;
  return kept_noise_text(out);
}

std::string NoiseMemory::keep(const LearnedNoise& learned, std::int64_t now_ns, bool at_once) {
  if (path_.empty() || learned.samples == written_samples_) return "";
  if (!at_once && tried_ns_ && now_ns - *tried_ns_ < kEvery_ns) return "";
  // Nothing was learned since it was recalled: the date is kept.
  if (recalled_ && learned.samples == recalled_->samples) return "";
  tried_ns_ = now_ns;
  kept_.noise = learned;
  kept_.learned = utc_now();
  try {
    write_state_file(path_, kept_noise_text(kept_));
  } catch (const std::exception& error) {
    const bool reported = failed_;
    failed_ = true;
    return reported ? "" : std::string("learned noise is not kept: ") + error.what();
  }
  written_samples_ = learned.samples;
  failed_ = false;
  return "";
}

}  // namespace ifog
