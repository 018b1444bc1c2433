// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "daemon/sensor/facts.h"
#include "daemon/sensor/sensor_parts.h"
#include "drivers/capture/times/sample_times.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/denoise/denoised_rows.h"
#include "tools/ifog/denoise/offline_chain.h"

namespace ifog::tools {
namespace {

// Runs the chain over a flight recording, run by run of the daemon.
class FlightChain {
 public:
  FlightChain(FlightInput& flight, DriverInstance& driver, const std::function<OfflineSettings()>& settings,
              bool fixed, DenoisedRows& rows)
      : flight_(flight),
        driver_(driver),
        settings_(settings),
        fixed_(fixed),
        first_(settings_()),
        now_(chain_settings(first_)),
        chain_(now_, first_, rows),
        rows_(rows),
        times_(driver_.description()),
        runs_{flight.header().run, flight.header().settings},
        missed_{!begins_a_run(flight.header()), {}} {
    times_.allow_restarts();
  }

  void take(const RecordedSample& recorded) {
    read_sample(recorded.sample, now_.facts.frame_channels, reading_);
    reading_.wall_shift_ns = recorded.wall_shift_ns;
    reading_.read_ns = recorded.read_ns;
    for (std::size_t i = 0; i < recorded_at_.size(); ++i) {
      const std::size_t c = static_cast<std::size_t>(now_.facts.frame_channels) + i;
      const ChannelValue value =
          recorded_at_[i] < recorded.outside.size() ? recorded.outside[recorded_at_[i]] : ChannelValue{};
      reading_.channel[c] = value.value;
      reading_.channel_age_s[c] = value.age_s(recorded.read_ns);
    }
    (void)times_.next(recorded.sample);
    rows_.count_from(times_.origin());
    if (!chain_.run(reading_, times_.last_s())) return;
    missed_.sample(times_.last_s());
    merged_.sample(times_.last_s());
  }

  void discontinuity() {
    chain_.discontinuity();
    times_.discontinuity();
  }
  void missing() { missed_.before_next = true; }
  void merged() { merged_.before_next = true; }

  void file(const FlightHeader& header) {
    times_.go_on_as(driver_.description());
    const bool another_run = header.run != runs_.run;
    if (!another_run && (fixed_ || header.settings == runs_.settings)) return;
    runs_.run = header.run;
    runs_.settings = header.settings;
    OfflineSettings settings = settings_();
    // It applies to the first sample only.
    if (another_run) settings.since_power_up_s.reset();
    ChainSettings next = chain_settings(settings);
    if (next.axes != now_.axes)
      throw std::runtime_error(
          "continues with other axes, as the driver's options changed; expected recordings of one");
    now_ = std::move(next);
    if (another_run) {
      ++runs_.count;
      missed_.before_next = !begins_a_run(header);
      chain_.begin(now_);
    } else {
      ++runs_.exchanges;
      chain_.exchange(now_);
    }
  }

  OfflineResult finish() {
    OfflineResult out = chain_.finish();
    out.runs = runs_.count;
    out.exchanges = runs_.exchanges;
    out.not_as_published_from_s = missed_.first_s;
    out.between_runs_s = flight_.counts().between_runs_s;
    out.merged = flight_.counts().merged_samples;
    out.merged_from_s = merged_.first_s;
    return out;
  }

 private:
  // Something that happened before the next sample, and its first time.
  struct Occurrence {
    bool before_next = false;
    std::optional<double> first_s;
    void sample(double now_s) {
      if (std::exchange(before_next, false) && !first_s) first_s = now_s;
    }
  };
  struct Runs {
    std::uint64_t run;
    std::uint32_t settings;
    std::size_t count = 1, exchanges = 0;
  };

  // True also for an older recording, which does not contain it.
  static bool begins_a_run(const FlightHeader& header) {
    return header.began == 0 || header.number == header.began;
  }
  ChainSettings chain_settings(const OfflineSettings& settings) {
    ChainSettings out = recording_settings(settings, driver_, flight_.path());
    if (!settings.since_power_up_s) out.powered_ns = flight_.header().powered_ns;
    // By name, because the settings may differ from those of the recording.
    const std::vector<std::string>& names = flight_.header().channels;
    recorded_at_.clear();
    for (const ChannelConfig& channel : outside_channels(settings.sensor))
      recorded_at_.push_back(
          static_cast<std::size_t>(std::ranges::find(names, channel.name) - names.begin()));
    return out;
  }

  FlightInput& flight_;
  DriverInstance& driver_;
  const std::function<OfflineSettings()>& settings_;
  bool fixed_;
  std::vector<std::size_t> recorded_at_;
  OfflineSettings first_;
  ChainSettings now_;
  ChainRun chain_;
  DenoisedRows& rows_;
  SampleTimes times_;
  Runs runs_;
  Reading reading_;
  Occurrence missed_;  // samples or the beginning of a run
  Occurrence merged_;  // samples merged near the next one
};

}  // namespace

OfflineResult denoise_flight(FlightInput& flight, DriverInstance& driver,
                             const std::function<OfflineSettings()>& settings, bool fixed,
                             DenoisedRows& rows) {
  FlightChain chain(flight, driver, settings, fixed, rows);
  const RecordedSamples samples{[&](const RecordedSample& recorded) { chain.take(recorded); },
                                [&] { chain.discontinuity(); }, [&] { chain.missing(); },
                                [&](const FlightHeader& header) { chain.file(header); },
                                [&](std::uint64_t) { chain.merged(); }};
  flight.for_each_sample(driver, samples);
  return chain.finish();
}

}  // namespace ifog::tools
