// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/denoise/offline_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "daemon/sensor/facts.h"
#include "daemon/sensor/sensor_parts.h"
#include "drivers/capture/candump/candump.h"
#include "drivers/capture/capture.h"
#include "drivers/capture/times/sample_times.h"
#include "drivers/row_times/sample_clock.h"
#include "filters/model_file/channel_names.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/denoise/denoised_rows.h"

namespace ifog::tools {
namespace {

constexpr double kChannelMaxAge_s = 10.0;  // as for channels in a sensor's frames in the daemon

bool used(const Model* model, const std::string& channel) {
  const auto names_it = [&](const std::string& of_effect) {
    const ChannelNames names = names_in(of_effect);
    return names.of == channel || names.less == channel;
  };
  return model != nullptr && std::ranges::any_of(model->effects, [&](const Effect& effect) {
           return names_it(effect.channel) || names_it(effect.with_channel);
         });
}

// Channels that the chain uses: all, or if they are too many, those of the model.
std::vector<CaptureView::Channel> chosen_channels(const CaptureView& capture, const Model* model) {
  const auto most = static_cast<std::size_t>(kMaxChannels);
  std::vector<CaptureView::Channel> out = capture.channels;
  if (out.size() > most) std::erase_if(out, [&](const auto& channel) { return !used(model, channel.name); });
  if (out.size() > most)
    throw refusal("the model uses {} channels, expected at most {}", out.size(), kMaxChannels);
  return out;
}

ChainSettings chain_settings_of(const CaptureView& capture, const std::string& path,
                                const std::vector<CaptureView::Channel>& channels,
                                const OfflineSettings& settings, const SampleClock& clock) {
  ChainSettings out;
  out.facts.axes = static_cast<int>(capture.axes.size());
  if (capture.size() < 2 && settings.sensor.nominal_rate_hz <= 0.0)
    throw refusal("{}: has fewer than 2 samples, expected more or --rate HZ", path);
  out.facts.nominal_rate_hz =
      settings.sensor.nominal_rate_hz > 0.0 ? settings.sensor.nominal_rate_hz : rounded_rate(clock.period_s);
  out.facts.frame_channels = out.facts.channels = static_cast<int>(channels.size());
  out.axes = capture.axes;
  for (const CaptureView::Channel& channel : channels) {
    out.channels.push_back(channel.name);
    const auto configured = std::ranges::find(settings.sensor.channels, channel.name, &ChannelConfig::name);
    out.channel_max_age_s.push_back(configured == settings.sensor.channels.end() ? kChannelMaxAge_s
                                                                                 : configured->max_age_s);
  }
  out.filter = settings.sensor.filter;
  out.start_up_s = settings.sensor.start_up_s;
  out.model = settings.model;
  out.learned = settings.learned;
  out.since_power_up_s = settings.since_power_up_s;
  return out;
}

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

// Adds what the results show.
void add(const IncrementerCounts& from, const IncrementerCounts& less, IncrementerCounts& to) {
  for (std::uint64_t IncrementerCounts::*count :
       {&IncrementerCounts::samples, &IncrementerCounts::gaps, &IncrementerCounts::missing,
        &IncrementerCounts::ambiguous, &IncrementerCounts::mixed, &IncrementerCounts::invalid,
        &IncrementerCounts::saturated, &IncrementerCounts::implausible})
    to.*count += from.*count - less.*count;
}

}  // namespace

OfflineResult denoise_capture(const CaptureView& capture, const std::string& name,
                              const OfflineSettings& settings, DenoisedRows& rows) {
  const std::vector<CaptureView::Channel> channels = chosen_channels(capture, settings.model.get());
  const SampleClock clock = capture.size() < 2 ? SampleClock{} : sample_clock(capture.time_s);
  ChainRun chain(chain_settings_of(capture, name, channels, settings, clock), settings, rows);
  Reading reading;
  std::optional<RowTimes> times;
  if (capture.size() > 0) times.emplace(capture.time_s, clock);
  Progress progress("denoising", capture.size());
  for (std::size_t i = 0; i < capture.size(); ++i) {
    if (i % RowBatch::kRows == 0) progress.at(i);
    // The file's times serve as the device's clock.
    reading.device_time_ns = std::llround(times->next(capture.time_s[i]) * 1e9);
    reading.valid_axes = 0;
    for (std::size_t axis = 0; axis < capture.axes.size(); ++axis) {
      reading.value[axis] = capture.rate_radps[axis][i];
      if (std::isfinite(reading.value[axis])) reading.valid_axes |= 1u << axis;
    }
    reading.fresh_channels = 0;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      reading.channel[c] = channels[c].values[i];
      if (std::isfinite(reading.channel[c])) reading.fresh_channels |= 1u << c;
    }
    chain.run(reading, capture.time_s[i]);
  }
  OfflineResult result = chain.finish();
  // Row times are as logged; no clock was set.
  result.counts.ambiguous = 0;
  return result;
}

OfflineResult denoise_recording(const CaptureInput& input, InputFile& file, DriverInstance& driver,
                                const OfflineSettings& settings, DenoisedRows& rows) {
  const ChainSettings chain_settings = recording_settings(settings, driver, file.path());
  const SensorFacts& facts = chain_settings.facts;
  ChainRun chain(chain_settings, settings, rows);
  Reading reading;
  // The recording has no channels of other sources: they have no value and infinite age.
  reading.channel.fill(std::numeric_limits<double>::quiet_NaN());
  reading.channel_age_s.fill(std::numeric_limits<float>::infinity());
  SampleTimes times(driver.description());
  times.allow_restarts();
  if (driver.takes_can()) times.keep_stamps(zero_of_stamps(file.head()));
  input.for_each_sample(file, driver, [&](const ifog_sample& sample) {
    (void)times.next(sample);
    rows.count_from(times.origin());
    read_sample(sample, facts.frame_channels, reading);
    chain.run(reading, times.last_s());
  });
  return chain.finish();
}

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

ChainRun::ChainRun(const ChainSettings& settings, const OfflineSettings& offline, DenoisedRows& rows)
    : model_path_(offline.sensor.model), rows_(rows), first_sequence_(offline.first_sequence) {
  begin(settings);
  rows_.begin(settings.axes, offline);
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

bool ChainRun::run(const Reading& reading, double time_s) {
  if (!incrementer_->next(reading, increment_)) return false;
  // Modulo 2^64, because the part may begin before its own counter.
  if (first_sequence_) sequence_shift_ = *std::exchange(first_sequence_, std::nullopt) - increment_.sequence;
  increment_.sequence += sequence_shift_;
  chain_->process(increment_, out_);
  count(rows_.add(time_s, increment_, out_));
  return true;
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
    if (std::ranges::find(result_.left_out, effect) == result_.left_out.end())
      result_.left_out.push_back(effect);
  result_.model = chain_->parts().model_identity();
  result_.noise_learned = !chain_->parts().noise_known();
}

}  // namespace ifog::tools
