// SPDX-License-Identifier: Apache-2.0
// Control of the pipelines: opens, starts, monitors, reports, reloads and stops them. One ordinary thread for
// everything that allocates, locks, formats or waits.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "daemon/channels/channel_sources.h"
#include "daemon/channels/channel_watch.h"
#include "daemon/config/config.h"
#include "daemon/housekeeping/log.h"
#include "daemon/housekeeping/status_report.h"
#include "daemon/pipeline/assemble.h"
#include "daemon/publish/publisher.h"
#include "daemon/state/running_mark.h"

namespace ifog {

class Housekeeping {
 public:
  // Throws ConfigError (a sensor cannot be assembled) or std::runtime_error (LCM). Makes no thread, and opens
  // only what `make_publisher` opens.
  using PublisherMaker = std::function<std::unique_ptr<Publisher>(const std::string& lcm_url)>;
  explicit Housekeeping(Config config, const PublisherMaker& make_publisher = make_lcm_publisher);
  ~Housekeeping();

  // Runs until SIGTERM, SIGINT or the end of all files; these and SIGHUP must be blocked in the calling
  // thread, so that all threads block them. Returns 0, or 1 if no sensor can run or a file could not be read.
  // Throws std::runtime_error with one line if another daemon uses the state folder or reads a device.
  int run();

 private:
  struct Sensor {
    SensorConfig config;
    AssembledSensor parts;
    StatusReport report;
    std::shared_ptr<spdlog::logger> log;
    ChannelWatch channels;
    FilterSnapshot snapshot{};
    bool open = false;     // at start-up; else it is retried
    bool answered = true;  // the filter thread answered the last request
    int unanswered = 0;    // seconds since its last answer
    std::uint64_t reader_turns = 0;
    int reader_stuck = 0;      // seconds without progress of the reader
    int starved = 0;           // seconds without progress for lack of processor time
    std::int32_t state = -1;   // last logged
    std::string fault{};       // last logged
    std::uint64_t worded = 0;  // events logged in this second
    std::uint64_t unworded = 0;
    std::uint32_t settings = 0;  // number of the last offered ones; 0: those of the start
  };

  // Result of a reload for one sensor.
  struct Renewed {
    Sensor* sensor;
    SensorConfig config;
    ChainChoice choice{};
    std::unique_ptr<ChainParts> parts{};  // null: unchanged
    std::string noise{};                  // initial noise of the parts, as stored
    std::vector<std::string> remarks{};   // about axes of the model that the sensor does not have
  };

  void mark_as_running();
  bool open_all();
  void start_all();
  // Logs if another process uses the channel.
  void claim(const Sensor& sensor, const std::string& channel);
  // Logs the words, unless there are none.
  static void tell(const Sensor& sensor, spdlog::level::level_enum level, const std::string& words);
  void drain_events(Sensor& sensor);
  void report_second(Sensor& sensor, double interval_s);
  // Counts seconds without progress of a thread.
  static void count_idle(Sensor& sensor);
  void publish(Sensor& sensor);
  // Status of every sensor, and the watchdog.
  void each_second(double interval_s);
  static void keep_noise(Sensor& sensor, bool at_once);
  // Null if both threads make progress.
  [[nodiscard]] static const char* stuck_thread(const Sensor& sensor);
  // Everything new is built before it is used: the whole configuration takes effect, or nothing. Returns the
  // errors, one per line, or "".
  std::string reload();
  void say_what_needs_a_restart(const Config& fresh);
  // Error text with the place of the sensor's key.
  static std::string error_at(const Config& config, const SensorConfig& sensor, const std::exception& error);
  Renewed renew(Sensor& sensor, const SensorConfig& fresh);
  void use(Renewed renewed);
  void stop_all();
  void notify(const std::string& state);

  Config config_;
  std::shared_ptr<spdlog::logger> log_;
  std::vector<std::unique_ptr<Sensor>> sensors_;
  std::vector<Fd> claims_;  // on the sensors' LCM channels
  std::unique_ptr<ChannelSources> sources_;
  std::unique_ptr<Publisher> status_publisher_;
  RunningMark mark_;
  std::vector<std::uint8_t> buffer_;
  bool watchdog_ = true;  // the watchdog is served; false after a pipeline was stuck
};

}  // namespace ifog
