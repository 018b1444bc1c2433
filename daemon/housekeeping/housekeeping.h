// SPDX-License-Identifier: Apache-2.0
// The daemon around its pipelines: opens, starts, watches, reports, reloads and stops them. One ordinary
// thread, which does everything that allocates, locks, formats or waits.
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
#include "daemon/publish/channel_claim.h"
#include "daemon/state/running_mark.h"

namespace ifog {

class Housekeeping {
 public:
  // Throws ConfigError (a sensor that cannot be put together) or std::runtime_error (LCM).
  // It makes no thread, and opens nothing but what `make_publisher` does.
  using PublisherMaker = std::function<std::unique_ptr<Publisher>(const std::string& lcm_url)>;
  explicit Housekeeping(Config config, const PublisherMaker& make_publisher = make_lcm_publisher);
  ~Housekeeping();

  // Until SIGTERM, SIGINT or the end of all files; these and SIGHUP must be blocked in the calling thread, so
  // that all threads block them. Returns 0, or 1 when no sensor can run or a file could not be read. Throws
  // std::runtime_error with one line where another daemon works with the state folder or reads a device.
  int run();

 private:
  struct Sensor {
    SensorConfig config;
    AssembledSensor parts;
    StatusReport report;
    std::shared_ptr<spdlog::logger> log;
    ChannelWatch channels;
    FilterSnapshot snapshot{};
    bool open = false;     // at start-up; else it is tried again
    bool answered = true;  // the filter thread answered the last question
    int unanswered = 0;    // seconds since it did
    std::uint64_t reader_turns = 0;
    int reader_stuck = 0;      // seconds since the reader last came round
    int starved = 0;           // seconds in which a thread did not come round for want of a processor
    std::int32_t state = -1;   // as last logged
    std::string fault{};       // as last logged
    std::uint64_t worded = 0;  // events logged in this second
    std::uint64_t unworded = 0;
    std::uint32_t settings = 0;  // number of those offered last; 0: those of the start
  };

  // What a reload has made of a sensor.
  struct Renewed {
    Sensor* sensor;
    SensorConfig config;
    ChainChoice choice{};
    std::unique_ptr<ChainParts> parts{};  // null: the choice is the one in use
    std::string noise{};                  // that the parts begin with, as it is kept
    std::vector<std::string> remarks{};   // on axes of the model that the sensor does not have
  };

  void mark_as_running();
  bool open_all();
  void start_all();
  // Says so where another process has the channel.
  void claim(const Sensor& sensor, const std::string& channel);
  void drain_events(Sensor& sensor);
  void report_second(Sensor& sensor, double interval_s);
  // Counts the seconds that a thread does not come round.
  static void count_idle(Sensor& sensor);
  void publish(Sensor& sensor);
  // The status of every sensor, and the service manager's sign of life.
  void each_second(double interval_s);
  static void keep_noise(Sensor& sensor, bool at_once);
  // Null where both of its threads come round.
  [[nodiscard]] static const char* stuck_thread(const Sensor& sensor);
  // Everything new is built before anything of it is used: the whole configuration takes effect, or nothing.
  // Gives what was refused, a line each, "" for nothing.
  std::string reload();
  void say_what_needs_a_restart(const Config& fresh);
  // A sensor's complaint where its key is.
  static std::string told_at(const Config& config, const SensorConfig& sensor, const std::exception& error);
  static Renewed renew(Sensor& sensor, const SensorConfig& fresh);
  void use(Renewed renewed);
  void stop_all();
  void notify(const std::string& state);

  Config config_;
  std::shared_ptr<spdlog::logger> log_;
  std::vector<std::unique_ptr<Sensor>> sensors_;
  std::vector<ChannelClaim> claims_;  // of the sensors' LCM channels
  std::unique_ptr<ChannelSources> sources_;
  std::unique_ptr<Publisher> status_publisher_;
  RunningMark mark_;
  std::vector<std::uint8_t> buffer_;
  bool watchdog_ = true;  // signs of life are given: none after a pipeline was once stuck
};

}  // namespace ifog
