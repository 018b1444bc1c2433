// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/denoise/offline_chain.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <utility>

#include "daemon/sensor/facts.h"
#include "daemon/sensor/sensor_parts.h"
#include "drivers/capture/capture.h"
#include "filters/allan/stretches.h"
#include "filters/model_file/channel_names.h"
#include "filters/series/series_view.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

constexpr double kChannelMaxAge_s = 10.0;  // as for the channels of a sensor's own frames in the daemon

// What is wrong with the filter's settings, said of them; with the model, of its file.
std::unique_ptr<ChainParts> parts_of(const ChainSettings& settings, const std::string& model_path) {
  const auto made = [](const ChainSettings& of) { return std::make_unique<ChainParts>(of); };
  if (!settings.model || model_path.empty()) return made(settings);
  try {
    return made(settings);
  } catch (const std::exception& error) {
    ChainSettings without = settings;
    without.model.reset();
    static_cast<void>(made(without));  // throws where it was not the model
    throw std::runtime_error(model_path + ": " + error.what());
  }
}

void add(const IncrementerCounts& from, IncrementerCounts& to) {
  for (std::uint64_t IncrementerCounts::*count :
       {&IncrementerCounts::samples, &IncrementerCounts::gaps, &IncrementerCounts::missing,
        &IncrementerCounts::repeated, &IncrementerCounts::restarts, &IncrementerCounts::invalid,
        &IncrementerCounts::saturated, &IncrementerCounts::implausible,
        &IncrementerCounts::channel_implausible, &IncrementerCounts::clock_steps})
    to.*count += from.*count;
}

class Chain {
 public:
  Chain(const ChainSettings& settings, const OfflineSettings& offline)
      : model_path_(offline.sensor.model), first_sequence_(offline.first_sequence) {
    begin(settings);
  }
  // As the daemon starts.
  void begin(const ChainSettings& settings) {
    if (incrementer_) add(incrementer_->counts(), result_.counts);
    incrementer_.emplace(settings.facts);
    chain_.emplace(parts_of(settings, model_path_));
    sequence_shift_ = 0;
    result_.axes = settings.axes;
    result_.sample_rate_hz = settings.facts.nominal_rate_hz;
    describe();
  }
  // As it takes other settings into use, from the next sample on.
  void exchange(const ChainSettings& settings) {
    (void)chain_->swap(parts_of(settings, model_path_));
    describe();
  }
  // Null: the sample came twice.
  const Increment* run(const Reading& reading, ChainOutput& out) {
    if (!incrementer_->next(reading, increment_)) return nullptr;
    // Modulo 2^64: the part may begin before where its own counter does.
    if (first_sequence_)
      sequence_shift_ = *std::exchange(first_sequence_, std::nullopt) - increment_.sequence;
    increment_.sequence += sequence_shift_;
    chain_->process(increment_, out);
    return &increment_;
  }
  void discontinuity() { incrementer_->discontinuity(); }
  OfflineResult finish() {
    add(incrementer_->counts(), result_.counts);
    result_.filter = chain_->parts().filter();
    result_.noise_known = chain_->parts().noise_known();
    return std::move(result_);
  }

 private:
  void describe() {
    for (const std::string& effect : chain_->parts().left_out())
      if (std::find(result_.left_out.begin(), result_.left_out.end(), effect) == result_.left_out.end())
        result_.left_out.push_back(effect);
    result_.model = chain_->parts().model_identity();
    result_.noise_learned = !chain_->parts().noise_known();
  }

  std::string model_path_;
  std::optional<Incrementer> incrementer_;
  std::optional<SignalChain> chain_;
  Increment increment_;
  std::optional<std::uint64_t> first_sequence_;
  std::uint64_t sequence_shift_ = 0;
  OfflineResult result_;
};

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

// Columns that the chain can hold, by their place: all channels, or where they are too many, those the model
// uses.
std::vector<std::size_t> chosen_channels(const LongTable& capture, const CaptureShape& shape,
                                         const Model* model) {
  std::vector<std::size_t> out;
  const bool all = shape.channels <= static_cast<std::size_t>(kMaxChannels);
  for (std::size_t c = 0; c < capture.columns.size(); ++c)
    if (shape.places[c].kind == CaptureShape::Place::Kind::channel &&
        (all || used(model, capture.columns[c].name)))
      out.push_back(c);
  return out;
}

// Of the median step, which holes cannot move; of the mean where the stamps are too coarse or scatter too
// much for that.
double rate_of(const SeriesView& time_s, const SampleClock& clock) {
  constexpr double kCoarse = 1e-4;
  const double median = 1.0 / median_step(time_s), mean = 1.0 / clock.period_s;
  return clock.scatters() || std::abs(mean / median - 1.0) > kCoarse ? mean : median;
}

// The times of the rows: their stamps, or where those scatter an even clock, anew behind each hole.
class RowTimes {
 public:
  RowTimes(const SeriesView& time_s, const SampleClock& clock)
      : period_s_(clock.period_s), first_s_(time_s.at(0)) {
    if (clock.scatters()) holes_ = holes(time_s, clock);
    scatters_ = clock.scatters();
  }
  // ns since the first row, of each row in turn.
  std::int64_t next(double stamp_s) {
    if (!scatters_) return std::llround((stamp_s - first_s_) * 1e9);
    if (row_ > 0) {
      const bool hole = at_ < holes_.size() && holes_[at_] + 1 == row_;
      at_ += hole ? 1 : 0;
      even_s_ += hole ? period_s_ * std::max(2.0, std::round((stamp_s - last_s_) / period_s_)) : period_s_;
    }
    ++row_;
    last_s_ = stamp_s;
    return std::llround(even_s_ * 1e9);
  }

 private:
  double period_s_, first_s_;
  bool scatters_ = false;
  std::vector<std::size_t> holes_;
  std::size_t row_ = 0, at_ = 0;
  double even_s_ = 0.0, last_s_ = 0.0;
};

ChainSettings chain_settings_of(const LongTable& capture, const std::string& path, const CaptureShape& shape,
                                const std::vector<std::size_t>& channels, const OfflineSettings& settings,
                                const SampleClock& clock) {
  ChainSettings out;
  out.facts.axes = static_cast<int>(shape.axes.size());
  if (capture.size() < 2 && settings.sensor.nominal_rate_hz <= 0.0)
    throw std::runtime_error(path + ": has fewer than 2 samples, expected more or --rate HZ");
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

// As the daemon sets its chain up, with what only a recording knows. The daemon's own refusal of a driver
// without a rate would name no file and a key of its configuration.
ChainSettings recording_settings(const OfflineSettings& settings, const DriverInstance& driver,
                                 const std::string& path) {
  const ifog_description& description = driver.description();
  if (!(settings.sensor.nominal_rate_hz > 0.0) && !(description.nominal_rate_hz > 0.0))
    throw std::runtime_error(path + ": driver " + driver.table().name +
                             " does not know the sample rate, expected --rate HZ or --option rate_hz=HZ");
  ChainSettings out = sensor_chain_settings(settings.sensor, description, settings.model);
  out.learned = settings.learned;
  out.since_power_up_s = settings.since_power_up_s;
  return out;
}

}  // namespace

OfflineResult denoise_capture(const LongTable& capture, const std::string& name,
                              const OfflineSettings& settings, const OfflineSink& sink) {
  const CaptureShape shape = capture_shape(capture.names(), name, capture);
  const std::vector<std::size_t> channels = chosen_channels(capture, shape, settings.model.get());
  const SampleClock clock = capture.size() < 2 ? SampleClock{} : sample_clock(capture.time_s);
  Chain chain(chain_settings_of(capture, name, shape, channels, settings, clock), settings);
  sink.begin(shape.axes);
  // The time, the axes, the channels.
  std::vector<SeriesView> views{capture.time_s};
  views.resize(1 + shape.axes.size());
  for (std::size_t c = 0; c < capture.columns.size(); ++c)
    if (shape.places[c].kind == CaptureShape::Place::Kind::rate)
      views[1 + shape.places[c].at] = capture.columns[c].values;
  for (const std::size_t c : channels) views.emplace_back(capture.columns[c].values);
  std::vector<std::vector<double>> room(views.size());
  std::vector<std::span<const double>> now(views.size());
  Reading reading;
  ChainOutput out;
  std::optional<RowTimes> times;
  if (capture.size() > 0) times.emplace(views[0], clock);
  Progress progress("denoising", capture.size());
  for (std::size_t begin = 0; begin < capture.size(); begin += kSeriesPiece) {
    progress.at(begin);
    const std::size_t count = std::min(kSeriesPiece, capture.size() - begin);
    for (std::size_t v = 0; v < views.size(); ++v) now[v] = views[v].piece(begin, count, room[v]);
    for (std::size_t i = 0; i < count; ++i) {
      // The column's own times are the device's clock; from the first sample on, as a clock cannot be
      // negative here.
      reading.device_time_ns = times->next(now[0][i]);
      reading.valid_axes = 0;
      for (std::size_t axis = 0; axis < shape.axes.size(); ++axis) {
        reading.value[axis] = now[1 + axis][i];
        if (std::isfinite(reading.value[axis])) reading.valid_axes |= 1u << axis;
      }
      reading.fresh_channels = 0;
      for (std::size_t c = 0; c < channels.size(); ++c) {
        reading.channel[c] = now[1 + shape.axes.size() + c][i];
        if (std::isfinite(reading.channel[c])) reading.fresh_channels |= 1u << c;
      }
      if (const Increment* const increment = chain.run(reading, out)) sink.sample(now[0][i], *increment, out);
    }
  }
  return chain.finish();
}

OfflineResult denoise_recording(const CaptureInput& input, InputFile& file, DriverInstance& driver,
                                const OfflineSettings& settings, const OfflineSink& sink) {
  const ChainSettings chain_settings = recording_settings(settings, driver, file.path());
  const SensorFacts& facts = chain_settings.facts;
  sink.begin(chain_settings.axes);
  Chain chain(chain_settings, settings);
  Reading reading;
  // Channels that did not come in the frames are not in the recording: never a value, for ever stale.
  reading.channel.fill(std::numeric_limits<double>::quiet_NaN());
  reading.channel_age_s.fill(std::numeric_limits<float>::infinity());
  ChainOutput out;
  double time_s = 0.0;
  bool first = true;
  const RecordingCounts counts = input.for_each_sample(file, driver, [&](const ifog_sample& sample) {
    read_sample(sample, facts.frame_channels, reading);
    const Increment* const increment = chain.run(reading, out);
    if (increment == nullptr) return;
    if (!std::exchange(first, false)) time_s += increment->dt_s;
    sink.sample(time_s, *increment, out);
  });
  for (const std::string& loss : losses(counts)) warn("%s: %s\n", file.path().c_str(), loss.c_str());
  return chain.finish();
}

namespace {

// A flight recording through the chain, run by run of the daemon.
class FlightChain {
 public:
  FlightChain(FlightInput& flight, DriverInstance& driver, const std::function<OfflineSettings()>& settings,
              const OfflineSink& sink)
      : flight_(flight),
        driver_(driver),
        settings_(settings),
        sink_(sink),
        first_(settings_()),
        now_(chain_settings(first_)),
        chain_(now_, first_),
        run_(flight.header().run),
        number_(flight.header().settings),
        missed_(!begins_a_run(flight.header())) {
    sink_.begin(now_.axes);
  }

  void take(const RecordedSample& recorded) {
    read_sample(recorded.sample, now_.facts.frame_channels, reading_);
    reading_.wall_shift_ns = recorded.wall_shift_ns;
    reading_.came_ns = recorded.came_ns;
    for (std::size_t i = 0; i < recorded_at_.size(); ++i) {
      const std::size_t c = static_cast<std::size_t>(now_.facts.frame_channels) + i;
      const ChannelValue value =
          recorded_at_[i] < recorded.outside.size() ? recorded.outside[recorded_at_[i]] : ChannelValue{};
      reading_.channel[c] = value.value;
      reading_.channel_age_s[c] = value.age_s(recorded.came_ns);
    }
    const Increment* const increment = chain_.run(reading_, out_);
    if (increment == nullptr) return;
    if (came_ns_) time_s_ += between_runs_ ? pause_s(recorded.came_ns, *increment) : increment->dt_s;
    between_runs_ = false;
    came_ns_ = recorded.came_ns;
    if (std::exchange(missed_, false) && !missed_at_s_) missed_at_s_ = time_s_;
    sink_.sample(time_s_, *increment, out_);
  }

  void discontinuity() { chain_.discontinuity(); }
  void missing() { missed_ = true; }

  void file(const FlightHeader& header) {
    const bool another_run = header.run != run_;
    if (!another_run && header.settings == number_) return;
    run_ = header.run;
    number_ = header.settings;
    OfflineSettings settings = settings_();
    // What was said of the first sample.
    if (another_run) settings.since_power_up_s.reset();
    now_ = chain_settings(settings);
    if (another_run) {
      ++runs_;
      between_runs_ = true;
      missed_ = !begins_a_run(header);
      chain_.begin(now_);
    } else {
      ++exchanges_;
      chain_.exchange(now_);
    }
  }

  OfflineResult finish() {
    OfflineResult out = chain_.finish();
    out.runs = runs_;
    out.exchanges = exchanges_;
    out.not_as_published_from_s = missed_at_s_;
    return out;
  }

 private:
  // Nobody knows it of an older recording.
  static bool begins_a_run(const FlightHeader& header) {
    return header.began == 0 || header.number == header.began;
  }
  ChainSettings chain_settings(const OfflineSettings& settings) {
    ChainSettings out = recording_settings(settings, driver_, flight_.path());
    if (!settings.since_power_up_s) out.powered_ns = flight_.header().powered_ns;
    // By name: the settings may be others than those it was recorded with.
    const std::vector<std::string>& names = flight_.header().channels;
    recorded_at_.clear();
    for (const ChannelConfig& channel : outside_channels(settings.sensor))
      recorded_at_.push_back(
          static_cast<std::size_t>(std::find(names.begin(), names.end(), channel.name) - names.begin()));
    return out;
  }

  // From one run to the next by when their samples came; a clock that was set back says nothing.
  [[nodiscard]] double pause_s(std::int64_t came_ns, const Increment& increment) const {
    return came_ns > *came_ns_ ? static_cast<double>(came_ns - *came_ns_) * 1e-9 : increment.dt_s;
  }

  FlightInput& flight_;
  DriverInstance& driver_;
  const std::function<OfflineSettings()>& settings_;
  const OfflineSink& sink_;
  std::vector<std::size_t> recorded_at_;
  OfflineSettings first_;
  ChainSettings now_;
  Chain chain_;
  std::uint64_t run_;
  std::uint32_t number_;
  std::size_t runs_ = 1, exchanges_ = 0;
  Reading reading_;
  ChainOutput out_;
  double time_s_ = 0.0;
  std::optional<std::int64_t> came_ns_;  // of the sample before
  bool between_runs_ = false;
  bool missed_;                        // something, before the next sample
  std::optional<double> missed_at_s_;  // the first time
};

}  // namespace

OfflineResult denoise_flight(FlightInput& flight, DriverInstance& driver,
                             const std::function<OfflineSettings()>& settings, bool fixed,
                             const OfflineSink& sink) {
  FlightChain chain(flight, driver, settings, sink);
  RecordedSamples samples{[&](const RecordedSample& recorded) { chain.take(recorded); },
                          [&] { chain.discontinuity(); },
                          [&] { chain.missing(); },
                          {}};
  if (!fixed) samples.file = [&](const FlightHeader& header) { chain.file(header); };
  const RecordingCounts counts = flight.for_each_sample(driver, samples);
  for (const std::string& loss : losses(counts))
    warn("%s: %s\n", flight.header().sensor.c_str(), loss.c_str());
  return chain.finish();
}

}  // namespace ifog::tools
