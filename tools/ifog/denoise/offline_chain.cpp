// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/denoise/offline_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "daemon/sensor/facts.h"
#include "daemon/sensor/sensor_parts.h"
#include "drivers/capture/candump/candump.h"
#include "drivers/capture/capture.h"
#include "filters/allan/row_times.h"
#include "filters/model_file/channel_names.h"
#include "filters/series/median_step.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/denoise/chain_run.h"

namespace ifog::tools {
namespace {

constexpr double kChannelMaxAge_s = 10.0;  // as for channels in a sensor's frames in the daemon

bool used(const Model* model, const std::string& channel) {
  const auto names_it = [&](const std::string& of_effect) {
    const ChannelNames names = names_in(of_effect);
    return names.of == channel || names.less == channel;
  };
  return model != nullptr &&
         std::any_of(model->effects.begin(), model->effects.end(), [&](const Effect& effect) {
           return names_it(effect.channel) || names_it(effect.with_channel);
         });
}

// Columns of channels that the chain uses: all, or if they are too many, those of the model.
std::vector<std::size_t> chosen_channels(const LongTable& capture, const CaptureShape& shape,
                                         const Model* model) {
  std::vector<std::size_t> out;
  const bool all = shape.channels <= static_cast<std::size_t>(kMaxChannels);
  for (std::size_t c = 0; c < capture.columns.size(); ++c)
    if (shape.places[c].kind == CaptureShape::Place::Kind::channel &&
        (all || used(model, capture.columns[c].name)))
      out.push_back(c);
  if (out.size() > static_cast<std::size_t>(kMaxChannels))
    throw refusal("the model uses {} channels, expected at most {}", out.size(), kMaxChannels);
  return out;
}

// Rate from the median step, which gaps do not bias; from the mean if the stamps are coarse or scatter.
double rate_of(std::span<const double> time_s, const SampleClock& clock) {
  constexpr double kCoarse = 1e-4;
  const double median = rounded_rate(median_step(time_s)), mean = rounded_rate(clock.period_s);
  return clock.scatters() || std::abs(mean / median - 1.0) > kCoarse ? mean : median;
}

ChainSettings chain_settings_of(const LongTable& capture, const std::string& path, const CaptureShape& shape,
                                const std::vector<std::size_t>& channels, const OfflineSettings& settings,
                                const SampleClock& clock) {
  ChainSettings out;
  out.facts.axes = static_cast<int>(shape.axes.size());
  if (capture.size() < 2 && settings.sensor.nominal_rate_hz <= 0.0)
    throw refusal("{}: has fewer than 2 samples, expected more or --rate HZ", path);
  out.facts.nominal_rate_hz = settings.sensor.nominal_rate_hz > 0.0 ? settings.sensor.nominal_rate_hz
                                                                    : rate_of(capture.time_s, clock);
  out.facts.frame_channels = out.facts.channels = static_cast<int>(channels.size());
  out.axes = shape.axes;
  for (const std::size_t c : channels) {
    const std::string& name = capture.columns[c].name;
    out.channels.push_back(name);
    double max_age_s = kChannelMaxAge_s;
    for (const ChannelConfig& channel : settings.sensor.channels)
      if (channel.name == name) max_age_s = channel.max_age_s;
    out.channel_max_age_s.push_back(max_age_s);
  }
  out.filter = settings.sensor.filter;
  out.start_up_s = settings.sensor.start_up_s;
  out.model = settings.model;
  out.learned = settings.learned;
  out.since_power_up_s = settings.since_power_up_s;
  return out;
}

}  // namespace

OfflineTimes::OfflineTimes(const ifog_description& description, const OfflineSink& sink)
    : times_(description), sink_(sink) {
  times_.allow_restarts();
}

void OfflineTimes::advance(const ifog_sample& sample) {
  if (const std::optional<SampleTimes::Stamped> stamped = times_.next(sample)) now_s_ = stamped->since_s;
  if (!std::exchange(begun_, true)) sink_.count_from(times_.origin());
}

OfflineResult denoise_capture(const LongTable& capture, const std::string& name,
                              const OfflineSettings& settings, const OfflineSink& sink) {
  const CaptureShape shape = capture_shape(capture.names(), name, capture);
  const std::vector<std::size_t> channels = chosen_channels(capture, shape, settings.model.get());
  const SampleClock clock = capture.size() < 2 ? SampleClock{} : sample_clock(capture.time_s);
  ChainRun chain(chain_settings_of(capture, name, shape, channels, settings, clock), settings);
  sink.begin(shape.axes);
  // The time, the axes, the channels.
  std::vector<std::span<const double>> views{capture.time_s};
  views.resize(1 + shape.axes.size());
  for (std::size_t c = 0; c < capture.columns.size(); ++c)
    if (shape.places[c].kind == CaptureShape::Place::Kind::rate)
      views[1 + shape.places[c].at] = capture.columns[c].values;
  for (const std::size_t c : channels) views.emplace_back(capture.columns[c].values);
  Reading reading;
  ChainOutput out;
  std::optional<RowTimes> times;
  if (capture.size() > 0) times.emplace(views[0], clock);
  Progress progress("denoising", capture.size());
  for (std::size_t i = 0; i < capture.size(); ++i) {
    if (i % RowBatch::kRows == 0) progress.at(i);
    // The file's times serve as the device's clock.
    reading.device_time_ns = std::llround(times->next(views[0][i]) * 1e9);
    reading.valid_axes = 0;
    for (std::size_t axis = 0; axis < shape.axes.size(); ++axis) {
      reading.value[axis] = views[1 + axis][i];
      if (std::isfinite(reading.value[axis])) reading.valid_axes |= 1u << axis;
    }
    reading.fresh_channels = 0;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      reading.channel[c] = views[1 + shape.axes.size() + c][i];
      if (std::isfinite(reading.channel[c])) reading.fresh_channels |= 1u << c;
    }
    if (const Increment* const increment = chain.run(reading, out))
      chain.count(sink.sample(views[0][i], *increment, out));
  }
  OfflineResult result = chain.finish();
  // Row times are as logged; no clock was set.
  result.counts.ambiguous = 0;
  return result;
}

OfflineResult denoise_recording(const CaptureInput& input, InputFile& file, DriverInstance& driver,
                                const OfflineSettings& settings, const OfflineSink& sink) {
  const ChainSettings chain_settings = recording_settings(settings, driver, file.path());
  const SensorFacts& facts = chain_settings.facts;
  sink.begin(chain_settings.axes);
  ChainRun chain(chain_settings, settings);
  Reading reading;
  // The recording has no channels of other sources: they have no value and infinite age.
  reading.channel.fill(std::numeric_limits<double>::quiet_NaN());
  reading.channel_age_s.fill(std::numeric_limits<float>::infinity());
  ChainOutput out;
  OfflineTimes times(driver.description(), sink);
  if (driver.takes_can()) times.times().keep_stamps(zero_of_stamps(file.head()));
  const RecordingCounts counts = input.for_each_sample(file, driver, [&](const ifog_sample& sample) {
    times.advance(sample);
    read_sample(sample, facts.frame_channels, reading);
    if (const Increment* const increment = chain.run(reading, out))
      chain.count(sink.sample(times.now_s(), *increment, out));
  });
  for (const std::string& loss : losses(counts)) warn("{}: {}\n", file.path(), loss);
  return chain.finish();
}

}  // namespace ifog::tools
