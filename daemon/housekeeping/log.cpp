// SPDX-License-Identifier: Apache-2.0
#include "daemon/housekeeping/log.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <sys/stat.h>
#include <syslog.h>
#include <unistd.h>

#define SD_JOURNAL_SUPPRESS_LOCATION
#include <systemd/sd-journal.h>

#include <array>
#include <cstdlib>
#include <mutex>

namespace ifog {
namespace {

constexpr const char* kDaemon = "ifogd";  // log of no sensor

// By spdlog's levels, from trace to critical.
constexpr std::array<int, 6> kPriorities{LOG_DEBUG, LOG_DEBUG, LOG_INFO, LOG_WARNING, LOG_ERR, LOG_CRIT};

// spdlog's systemd sink has no further fields, which `journalctl IFOG_SENSOR=x` needs.
class JournalSink final : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string name(message.logger_name.begin(), message.logger_name.end());
    const std::string text(message.payload.begin(), message.payload.end());
    const int priority = kPriorities.at(static_cast<std::size_t>(message.level));
    if (name == kDaemon)
      sd_journal_send("MESSAGE=%s", text.c_str(), "PRIORITY=%i", priority, "SYSLOG_IDENTIFIER=ifogd",
                      nullptr);
    else
      sd_journal_send("MESSAGE=%s: %s", name.c_str(), text.c_str(), "PRIORITY=%i", priority,
                      "SYSLOG_IDENTIFIER=ifogd", "IFOG_SENSOR=%s", name.c_str(), nullptr);
  }
  void flush_() override {}
};

// systemd.exec(5): the variable contains device and inode of the journal's socket if that is standard error.
bool under_the_journal() {
  const char* const stream = std::getenv("JOURNAL_STREAM");
  struct stat err {};
  if (stream == nullptr || fstat(STDERR_FILENO, &err) != 0) return false;
  return std::to_string(err.st_dev) + ":" + std::to_string(err.st_ino) == stream;
}

std::shared_ptr<spdlog::sinks::sink>& the_sink() {
  static std::shared_ptr<spdlog::sinks::sink> sink;
  return sink;
}

}  // namespace

void set_up_log(const std::string& level) {
  if (under_the_journal())
    the_sink() = std::make_shared<JournalSink>();
  else
    the_sink() = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  the_sink()->set_pattern("%Y-%m-%dT%H:%M:%S.%e %l: %n: %v");
  the_sink()->set_level(level == "debug"     ? spdlog::level::debug
                        : level == "warning" ? spdlog::level::warn
                        : level == "error"   ? spdlog::level::err
                                             : spdlog::level::info);
}

std::shared_ptr<spdlog::logger> make_log(const std::string& sensor) {
  if (!the_sink()) set_up_log("info");
  auto log = std::make_shared<spdlog::logger>(sensor.empty() ? kDaemon : sensor, the_sink());
  log->set_level(spdlog::level::debug);
  log->flush_on(spdlog::level::debug);
  return log;
}

}  // namespace ifog
