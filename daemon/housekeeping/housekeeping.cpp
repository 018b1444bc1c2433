// SPDX-License-Identifier: Apache-2.0
#include "daemon/housekeeping/housekeeping.h"

#include <signal.h>
#include <systemd/sd-daemon.h>

#include <algorithm>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "daemon/channels/can_channel.h"
#include "daemon/realtime/realtime.h"
#include "daemon/sensor/sensor_parts.h"
#include "daemon/state/state_folder.h"
#include "drivers/ifog/quoted.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/sole_reader.h"
#include "msgs/state_name.h"

namespace ifog {
namespace {

constexpr std::int64_t kTick_ns = 100'000'000;
constexpr int kTicksPerSecond = 10;
constexpr std::int64_t kReloadEvery_ns = 1'000'000'000;
constexpr std::uint64_t kWordedPerSecond = 5;  // event lines per sensor; the rest only in the counters
// A thread without progress for this long is stuck; then the watchdog restarts the service.
constexpr int kStuck_s = 3;

std::vector<std::string> axis_names(const ifog_description& description) {
  std::vector<std::string> out;
  for (std::uint32_t i = 0; i < description.axes; ++i) out.emplace_back(description.axis[i]);
  return out;
}

// Next signal, or 0 at `deadline_ns` of the monotonic clock. SIGHUP never hides an end.
int wait_for_signal(std::int64_t deadline_ns) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  const timespec none{};
  if (const int end = sigtimedwait(&signals, nullptr, &none); end > 0) return end;
  sigaddset(&signals, SIGHUP);
  const std::int64_t left = std::max<std::int64_t>(0, deadline_ns - monotonic_ns());
  const timespec timeout{left / 1'000'000'000, left % 1'000'000'000};
  return std::max(0, sigtimedwait(&signals, nullptr, &timeout));
}

}  // namespace

Housekeeping::Housekeeping(Config config, const PublisherMaker& make_publisher)
    : config_(std::move(config)), log_(make_log("")) {
  const auto publisher = [&] {
    try {
      return make_publisher(config_.lcm_url);
    } catch (const std::exception& error) {
      const auto line = config_.lines.find("lcm_url");
      throw std::runtime_error(config_.file +
                               (line == config_.lines.end() ? "" : ":" + std::to_string(line->second)) +
                               ": daemon." + error.what());
    }
  };
  status_publisher_ = publisher();
  std::vector<ChannelSources::Wanted> wanted;
  ReadersProcessors processors;
  std::string errors;
  for (const SensorConfig& sensor : config_.sensors) {
    try {
      AssembledSensor parts = assemble(sensor, config_, publisher(), processors);
      const ifog_description& description = parts.pipeline->reader().driver().description();
      int index = 0;
      std::vector<std::string> units;
      for (const ChannelConfig& channel : outside_channels(sensor)) {
        if (channel.source == ChannelConfig::Source::can) units.push_back(CanChannel(channel).remark());
        wanted.push_back({channel, parts.outside, index++});
      }
      StatusReport report(sensor.name, parts.channels, axis_names(description),
                          parts.pipeline->plan().facts.nominal_rate_hz);
      ChannelWatch watch(sensor, parts.channels);
      sensors_.push_back(std::make_unique<Sensor>(Sensor{.config = sensor,
                                                         .parts = std::move(parts),
                                                         .report = std::move(report),
                                                         .log = make_log(sensor.name),
                                                         .channels = std::move(watch)}));
      for (const std::string& absent : sensors_.back()->channels.absent())
        sensors_.back()->log->warn("{}", absent);
      for (const std::string& remark : sensors_.back()->parts.remarks)
        sensors_.back()->log->warn("{}: {}", sensor.model, remark);
      for (const std::string& remark : units)
        if (!remark.empty()) sensors_.back()->log->warn("channel {}", remark);
      for (const std::string& warning : sensors_.back()->parts.pipeline->reader().driver().warnings())
        sensors_.back()->log->warn("{}", warning);
    } catch (const std::exception& error) {
      errors += (errors.empty() ? "" : "\n") + error_at(config_, sensor, error);
    }
  }
  if (!errors.empty()) throw ConfigError(errors);
  sources_ = std::make_unique<ChannelSources>(std::move(wanted), config_.lcm_url);
}

std::string Housekeeping::error_at(const Config& config, const SensorConfig& sensor,
                                   const std::exception& error) {
  const auto* const keyed = dynamic_cast<const KeyError*>(&error);
  return config.file + ":" + std::to_string(keyed == nullptr ? sensor.line : sensor.line_of(keyed->key)) +
         ": sensor \"" + printable(sensor.name) + "\": " + error.what();
}

Housekeeping::~Housekeeping() = default;

void Housekeeping::notify(const std::string& state) { sd_notify(0, state.c_str()); }

// Absent devices are waited for, even a single one, since a gyro may be powered later. A missing file is not
// waited for. False: no sensor is there or may appear.
bool Housekeeping::open_all() {
  bool any = false;
  for (const auto& sensor : sensors_) {
    try {
      sensor->parts.pipeline->open();
      any = sensor->open = true;
    } catch (const DeviceInUse&) {
      throw;
    } catch (const std::exception& error) {
      sensor->log->error("{}", error.what());
      any = any || sensor->config.transport.kind != TransportConfig::Kind::file;
    }
  }
  return any;
}

void Housekeeping::start_all() {
  for (const auto& sensor : sensors_) {
    for (const std::string& effect : sensor->parts.left_out) sensor->log->warn("not corrected: {}", effect);
    const NoiseMemory& noise = sensor->parts.noise;
    tell(*sensor, noise.good() ? spdlog::level::info : spdlog::level::warn, noise.remark());
    try {
      if (sensor->parts.recorder != nullptr) sensor->parts.recorder->start();
      tell(*sensor, spdlog::level::warn, sensor->parts.pipeline->start());
    } catch (const std::system_error& error) {
      throw std::runtime_error(
          "sensor \"" + printable(sensor->config.name) +
          "\": cannot make a thread: " + error.code().message() + ", expected room for " +
          (sensor->parts.recorder != nullptr ? "three" : "two") + " (TasksMax=, ulimit -u)");
    }
    const PipelinePlan& plan = sensor->parts.pipeline->plan();
    const Transport& transport = sensor->parts.pipeline->reader().transport();
    sensor->log->info("{} {} at {} Hz, publishing on {}", sensor->open ? "reading" : "trying again to open",
                      transport.name(), plan.facts.nominal_rate_hz, plan.lcm_channel);
    claim(*sensor, plan.lcm_channel);
    for (const PublishedType& also : sensor->config.publish) {
      sensor->log->info("publishing {} on {}", also.type, also.channel);
      claim(*sensor, also.channel);
    }
  }
  sources_->start();
}

void Housekeeping::claim(const Sensor& sensor, const std::string& channel) {
  if (std::optional<Fd> claimed = claim_channel(config_.lcm_url, channel))
    claims_.push_back(std::move(*claimed));
  else
    sensor.log->warn(
        "another daemon publishes on {} of this lcm_url: subscribers receive both as one sensor; expected "
        "a name or a channel of its own for each",
        channel);
}

void Housekeeping::tell(const Sensor& sensor, spdlog::level::level_enum level, const std::string& words) {
  if (!words.empty()) sensor.log->log(level, "{}", words);
}

void Housekeeping::drain_events(Sensor& sensor) {
  Event event;
  Notices& notices = sensor.parts.pipeline->reader().transport().notices();
  if (const std::string warning = notices.take_warning(); !warning.empty()) {
    sensor.log->warn("{}", warning);
    sensor.report.count_warning();
  }
  tell(sensor, spdlog::level::info, notices.take_answers());
  if (sensor.parts.recorder != nullptr) {
    bool good = false;
    const std::string message = sensor.parts.recorder->take_message(good);
    tell(sensor, good ? spdlog::level::info : spdlog::level::warn, message);
  }
  while (sensor.parts.pipeline->take_event(event)) {
    const bool fault = event.kind != EventKind::noise_learned && event.kind != EventKind::model_in_use;
    if (fault && sensor.worded >= kWordedPerSecond) {
      ++sensor.unworded;
      continue;
    }
    if (fault) ++sensor.worded;
    sensor.log->log(fault ? spdlog::level::warn : spdlog::level::info, "{}", describe(event));
  }
}

void Housekeeping::publish(Sensor& sensor) {
  const status_t& message = sensor.report.message();
  buffer_.resize(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
  const std::string channel = sensor.config.lcm_channel() + "_STATUS";
  if (!status_publisher_->publish(channel.c_str(), buffer_))
    sensor.log->warn("LCM did not take the status message");
}

// A thread without processor time is not stuck, nor is the one that waits for it; a restart would not help.
void Housekeeping::count_idle(Sensor& sensor) {
  Pipeline& pipeline = *sensor.parts.pipeline;
  const char* const starved = pipeline.starved();
  const std::uint64_t turns = sensor.snapshot.reader.turns;
  const bool filter_came = sensor.answered || pipeline.ended();
  const bool reader_came = turns != sensor.reader_turns || pipeline.ended();
  sensor.reader_turns = turns;
  const int counts = starved == nullptr ? 1 : 0;
  sensor.unanswered = filter_came ? 0 : sensor.unanswered + counts;
  sensor.reader_stuck = reader_came ? 0 : sensor.reader_stuck + counts;
  if (filter_came && reader_came) {
    if (sensor.starved >= kStuck_s) sensor.log->info("its threads get a processor again");
    sensor.starved = 0;
  } else if (starved != nullptr && ++sensor.starved == kStuck_s) {
    sensor.log->warn(
        "the {} thread is ready and has had no processor for {} s: something of a higher priority keeps it, "
        "look with `ps -eLo rtprio,pcpu,comm` and give one of them other processors (reader_cpus, "
        "filter_cpus)",
        starved, kStuck_s);
  }
}

void Housekeeping::report_second(Sensor& sensor, double interval_s) {
  Pipeline& pipeline = *sensor.parts.pipeline;
  sensor.answered = pipeline.filter().take_snapshot(sensor.snapshot);
  // If the filter makes no progress, the reader's data wait.
  if (!sensor.answered) sensor.snapshot.reader = pipeline.reader().books();
  count_idle(sensor);
  if (sensor.unworded > 0) sensor.log->warn("{} more such lines in this second", sensor.unworded);
  sensor.worded = sensor.unworded = 0;
  if (sensor.parts.recorder != nullptr) sensor.report.update(*sensor.parts.recorder);
  const status_t& message = sensor.report.update(pipeline, sensor.snapshot, interval_s);
  bool fault_worded = message.fault.empty() || message.fault == sensor.fault;
  if (message.state != sensor.state) {
    const bool good = message.state == status_t::STATE_RUNNING || message.state == status_t::STATE_STARTING ||
                      message.state == status_t::STATE_ENDED;
    sensor.log->log(good ? spdlog::level::info : spdlog::level::warn, "{}{}{}", state_name(message.state),
                    message.fault.empty() ? "" : ": ", message.fault);
    sensor.state = message.state;
    fault_worded = true;
  }
  if (!fault_worded) sensor.log->warn("{}", message.fault);
  sensor.fault = message.fault;
  tell(sensor, spdlog::level::warn, sensor.report.moved());
  for (const ChannelWatch::News& news : sensor.channels.look(message, *sensor.parts.outside))
    sensor.log->log(news.good ? spdlog::level::info : spdlog::level::warn, "{}", news.words);
  if (!pipeline.reader().transport().holds_back())
    tell(sensor, spdlog::level::warn, sensor.report.wrong_rate());
  tell(sensor, spdlog::level::info, sensor.report.unseen_axes());
  tell(sensor, spdlog::level::warn, sensor.report.unknown_noise());
  tell(sensor, spdlog::level::warn, sensor.report.newly_frozen());
  tell(sensor, spdlog::level::warn, sensor.report.newly_noticed());
  publish(sensor);
  keep_noise(sensor, false);
}

void Housekeeping::keep_noise(Sensor& sensor, bool at_once) {
  if (!sensor.snapshot.learned) return;
  tell(sensor, spdlog::level::warn,
       sensor.parts.noise.keep(*sensor.snapshot.learned, monotonic_ns(), at_once));
}

const char* Housekeeping::stuck_thread(const Sensor& sensor) {
  if (sensor.reader_stuck >= kStuck_s) return "reader";
  return sensor.unanswered >= kStuck_s ? "filter" : nullptr;
}

void Housekeeping::stop_all() {
  notify("STOPPING=1");
  sources_->stop();
  for (const auto& sensor : sensors_) sensor->parts.pipeline->stop();
  for (const auto& sensor : sensors_)
    if (sensor->parts.recorder != nullptr) sensor->parts.recorder->stop();
  for (const auto& sensor : sensors_) {
    drain_events(*sensor);
    report_second(*sensor, 0.0);
    keep_noise(*sensor, true);
    const status_t& message = sensor->report.message();
    if (const auto& recorder = sensor->parts.recorder; recorder != nullptr)
      sensor->log->info(
          "recorder: {} deliveries, {} lost, {} bytes written, {} entries that the disk did not take",
          message.record_deliveries, message.record_lost, message.record_file_bytes,
          recorder->counts().entries_unwritten);
    sensor->log->info("{} samples read, {} published, {} missing, {} merged", message.samples_in,
                      message.samples_published, message.sequence_missing, message.samples_merged);
    if (const auto beyond = sensor->snapshot.reader.driver.values_beyond; beyond > 0)
      sensor->log->info("{} values beyond the range that the file states: kept", beyond);
  }
}

void Housekeeping::each_second(double interval_s) {
  // The previous holder may have ended.
  if (!mark_.is_set() && mark_.set(state_folder(config_.state_folder)).empty() && mark_.is_set())
    log_->info("{}: marked as this daemon's", state_folder(config_.state_folder));
  double rate = 0.0;
  std::vector<std::string> statuses;
  for (const auto& sensor : sensors_) {
    report_second(*sensor, interval_s);
    statuses.emplace_back(buffer_.begin(), buffer_.end());
    rate += sensor->report.message().output_rate_hz;
  }
  mark_.tell(statuses);
  bool stuck = false;
  for (const auto& sensor : sensors_)
    if (const char* const thread = stuck_thread(*sensor); watchdog_ && thread != nullptr) {
      stuck = true;
      sensor->log->critical("the {} thread has not come round for {} s: no more signs of life", thread,
                            kStuck_s);
    }
  if (stuck) watchdog_ = false;
  if (watchdog_)
    notify("WATCHDOG=1\nSTATUS=" + std::to_string(sensors_.size()) + " sensor(s), " +
           std::to_string(std::lround(rate)) + " samples/s published");
}

// Before anything is opened: of two daemons with one state folder, the second must not touch anything.
void Housekeeping::mark_as_running() {
  const std::string folder = state_folder(config_.state_folder);
  std::string missed = make_state_folder(folder);
  if (missed.empty()) missed = mark_.set(folder);
  if (mark_.in_use()) throw std::runtime_error(missed);
  if (!missed.empty()) log_->warn("{}", missed);
}

int Housekeeping::run() {
  mark_as_running();
  if (!open_all()) {
    log_->error("no sensor can run");
    return 1;
  }
  if (config_.lock_memory)
    if (const std::string missed = lock_memory(); !missed.empty()) log_->warn("{}", missed);
  start_all();
  notify("READY=1\nSTATUS=" + std::to_string(sensors_.size()) + " sensor(s)");
  bool ended = false, reload_asked = false;
  std::int64_t deadline_ns = monotonic_ns();
  std::int64_t reloaded_ns = deadline_ns - kReloadEvery_ns;
  std::int64_t second_ns = deadline_ns;
  for (std::int64_t tick = 1; !ended; ++tick) {
    deadline_ns += kTick_ns;
    int signal = 0;
    while ((signal = wait_for_signal(deadline_ns)) == SIGHUP) {
      reload_asked = true;
      if (monotonic_ns() >= deadline_ns) break;
    }
    if (signal == SIGTERM || signal == SIGINT) {
      log_->info("stopping on {}", signal == SIGTERM ? "SIGTERM" : "SIGINT");
      break;
    }
    // Within the tick, which continues with status and watchdog; the first reload at once, more of them once
    // a second.
    reload_asked = mark_.serve() || reload_asked;
    if (reload_asked && monotonic_ns() - reloaded_ns >= kReloadEvery_ns) {
      reload_asked = false;
      mark_.answer(reload());
      reloaded_ns = monotonic_ns();
    }
    ended = true;
    for (const auto& sensor : sensors_) {
      drain_events(*sensor);
      sensor->parts.pipeline->filter().collect_retired();
      ended = ended && sensor->parts.pipeline->ended();
      if (tick % kTicksPerSecond == kTicksPerSecond - 1) sensor->parts.pipeline->filter().ask();
    }
    if (tick % kTicksPerSecond != 0 || ended) continue;
    const std::int64_t now_ns = monotonic_ns();
    each_second(static_cast<double>(now_ns - std::exchange(second_ns, now_ns)) * 1e-9);
    // After a long halt of the computer, no burst of overdue seconds.
    deadline_ns = std::max(deadline_ns, now_ns - kTick_ns);
  }
  stop_all();
  const bool failed = std::any_of(sensors_.begin(), sensors_.end(), [](const auto& sensor) {
    return sensor->report.message().state == status_t::STATE_FAILED;
  });
  return failed ? 1 : 0;
}

}  // namespace ifog
