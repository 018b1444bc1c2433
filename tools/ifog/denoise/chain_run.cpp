// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/denoise/chain_run.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "daemon/sensor/facts.h"
#include "daemon/sensor/sensor_parts.h"
#include "tools/ifog/console/errors.h"

namespace ifog::tools {
namespace {

// Attributes an error to the filter's settings, or to the model with its file.
std::unique_ptr<ChainParts> parts_of(const ChainSettings& settings, const std::string& model_path) {
  const auto made = [](const ChainSettings& of) { return std::make_unique<ChainParts>(of); };
  if (!settings.model || model_path.empty()) return made(settings);
  try {
    return made(settings);
  } catch (const ModelMisfit& misfit) {
    const std::string line = misfit.line > 0 ? ":" + std::to_string(misfit.line) : "";
    throw refusal("{}{}: {}", model_path, line, misfit.what());
  } catch (const std::exception& error) {
    ChainSettings without = settings;
    without.model.reset();
    static_cast<void>(made(without));  // throws if the model is not the cause
    throw refusal("{}: {}", model_path, error.what());
  }
}

void add(const IncrementerCounts& from, const IncrementerCounts& less, IncrementerCounts& to) {
  for (std::uint64_t IncrementerCounts::*count :
       {&IncrementerCounts::samples, &IncrementerCounts::gaps, &IncrementerCounts::missing,
        &IncrementerCounts::ambiguous, &IncrementerCounts::repeated, &IncrementerCounts::mixed,
        &IncrementerCounts::restarts, &IncrementerCounts::invalid, &IncrementerCounts::saturated,
        &IncrementerCounts::implausible, &IncrementerCounts::channel_implausible,
        &IncrementerCounts::clock_steps, &IncrementerCounts::sensor_clock_sets, &IncrementerCounts::pauses})
    to.*count += from.*count - less.*count;
}

}  // namespace

// The daemon's settings, with those of the recording. Its own message for an unknown rate names a
// configuration key, not the file.
ChainSettings recording_settings(const OfflineSettings& settings, const DriverInstance& driver,
                                 const std::string& path) {
  const ifog_description& description = driver.description();
  if (!(settings.sensor.nominal_rate_hz > 0.0) && !(description.nominal_rate_hz > 0.0))
    throw refusal("{}: driver {} does not know the sample rate, expected --rate HZ or --option rate_hz=HZ",
                  path, driver.table().name);
  ChainSettings out = sensor_chain_settings(settings.sensor, description, settings.model);
  out.learned = settings.learned;
  out.since_power_up_s = settings.since_power_up_s;
  return out;
}

ChainRun::ChainRun(const ChainSettings& settings, const OfflineSettings& offline)
    : model_path_(offline.sensor.model), first_sequence_(offline.first_sequence) {
  begin(settings);
}

void ChainRun::begin(const ChainSettings& settings) {
  if (incrementer_) count(counts_);  // counts after the last sample
  counted_ = {};
  incrementer_.emplace(settings.facts);
  chain_.emplace(parts_of(settings, model_path_));
  sequence_shift_ = 0;
  result_.axes = settings.axes;
  result_.sample_rate_hz = settings.facts.nominal_rate_hz;
  describe();
}

void ChainRun::exchange(const ChainSettings& settings) {
  (void)chain_->swap(parts_of(settings, model_path_));
  describe();
}

const Increment* ChainRun::run(const Reading& reading, ChainOutput& out) {
  if (!incrementer_->next(reading, increment_)) return nullptr;
  // Modulo 2^64, because the part may begin before its own counter.
  if (first_sequence_) sequence_shift_ = *std::exchange(first_sequence_, std::nullopt) - increment_.sequence;
  increment_.sequence += sequence_shift_;
  chain_->process(increment_, out);
  return &increment_;
}

OfflineResult ChainRun::finish() {
  count(counts_);
  result_.filter = chain_->parts().filter();
  result_.shares = chain_->parts().shares();
  result_.learns_walk = chain_->parts().learns_walk();
  result_.noise_known = chain_->parts().noise_known();
  return std::move(result_);
}

void ChainRun::count(bool counts) {
  const IncrementerCounts& now = incrementer_->counts();
  if (counts) add(now, counted_, result_.counts);
  if (counts && incrementer_->refused_clock()) result_.refused_clock = incrementer_->refused_clock();
  counted_ = now;
  counts_ = counts;
}

void ChainRun::describe() {
  for (const std::string& effect : chain_->parts().left_out())
    if (std::find(result_.left_out.begin(), result_.left_out.end(), effect) == result_.left_out.end())
      result_.left_out.push_back(effect);
  result_.model = chain_->parts().model_identity();
  result_.noise_learned = !chain_->parts().noise_known();
}

}  // namespace ifog::tools
