// SPDX-License-Identifier: Apache-2.0
// ifog replay: sends a recording to a CAN interface, a serial device, a file or a FIFO at the recorded times.
//
// Deadlines are computed from the first item's, so that lateness does not accumulate, with absolute sleeps on
// CLOCK_MONOTONIC. Lateness is the time from an item's deadline until the system has accepted it.
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <ctime>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "daemon/sensor/duration_histogram.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/file/pace.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/interrupt.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/replay/replay_target.h"
#include "tools/ifog/replay/replay_timeline.h"

namespace ifog::tools {
namespace {

struct ReplaySettings {
  ReplaySource source;
  ReplayDestination to;
  std::string json;
  SerialSettings line;
  double speed = 1.0;
  std::uint64_t loops = 1;  // 0: unlimited
  double spin_us = 0.0;
  bool realtime = false;
};

struct ReplayResult {
  std::uint64_t sent = 0;    // accepted by the system
  std::uint64_t wanted = 0;  // 0: unlimited
  bool failed = false;
  std::int64_t begin_ns = 0;  // CLOCK_MONOTONIC, of the first deadline
  double seconds = 0.0;
  DurationHistogram late;
};

// From the start to the first deadline, so that the first item is delayed like the others.
constexpr std::int64_t kLead_ns = 20'000'000;
constexpr std::int64_t kLongestSleep_ns = 100'000'000;

// False: interrupted.
bool sleep_until(std::int64_t due_ns, std::int64_t spin_ns) {
  for (;;) {
    if (interrupted()) return false;
    const std::int64_t now = monotonic_ns();
    if (now >= due_ns) return true;
    if (due_ns - now <= spin_ns) continue;
    // In slices, because a signal may arrive between the check above and the sleep.
    const std::int64_t until = std::min(due_ns - spin_ns, now + kLongestSleep_ns);
    const timespec when{until / 1'000'000'000, until % 1'000'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr);
  }
}

// Duration of one loop: the recording and one mean step.
std::int64_t round_ns(const ReplayTimeline& timeline) {
  const std::size_t n = timeline.size();
  if (n < 2) return 1'000'000'000;
  const std::int64_t length = timeline.time_ns(n - 1) - timeline.time_ns(0);
  return length + length / static_cast<std::int64_t>(n - 1);
}

void replay(const ReplayTimeline& timeline, const ReplaySettings& settings, ReplayTarget& target,
            ReplayResult& result) {
  const std::size_t n = timeline.size();
  const bool paced = settings.speed > 0.0;
  const auto spin_ns = static_cast<std::int64_t>(settings.spin_us * 1e3);
  const std::int64_t round = round_ns(timeline);
  // Progress by recorded time if paced, in ms, so that pauses count.
  const auto in_ms = [](double time_ns) { return static_cast<std::size_t>(time_ns * 1e-6); };
  Progress progress("replay", paced ? in_ms(static_cast<double>(round) * static_cast<double>(settings.loops))
                                    : result.wanted);
  Pace pace(paced ? settings.speed : 1.0);
  result.begin_ns = monotonic_ns() + (paced ? kLead_ns : 0);
  pace.start(timeline.time_ns(0), result.begin_ns);
  // False: interrupted.
  const auto send = [&](std::size_t i, std::int64_t shift) {
    const std::int64_t recorded_ns = timeline.time_ns(i) + shift, due = pace.due_ns(recorded_ns);
    if (paced ? !sleep_until(due, spin_ns) : interrupted()) return false;
    if (!target.send(i)) return false;
    if (paced) result.late.add(monotonic_ns() - due);
    ++result.sent;
    progress.at(paced ? in_ms(static_cast<double>(recorded_ns - timeline.time_ns(0))) : result.sent);
    return true;
  };
  bool going = true;
  for (std::uint64_t loop = 0; going && (settings.loops == 0 || loop < settings.loops); ++loop)
    for (std::size_t i = 0; going && i < n; ++i) going = send(i, static_cast<std::int64_t>(loop) * round);
  target.finish();
}

void prepare(const ReplaySettings& settings) {
  // Otherwise the kernel may end a sleep 50 µs late.
  prctl(PR_SET_TIMERSLACK, 1UL);
  if (!settings.realtime) return;
  const auto going_without = [](const char* what) {
    warn("ifog replay: no {} ({}), going on without\n", what, std::generic_category().message(errno));
  };
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) going_without("locked memory");
  sched_param priority{};
  priority.sched_priority = 50;
  if (sched_setscheduler(0, SCHED_FIFO, &priority) != 0) going_without("SCHED_FIFO");
}

// True if all was sent. An unlimited loop ends with an interrupt.
bool complete(const ReplayResult& result) {
  return !result.failed && (!interrupted() || result.wanted == 0 || result.sent == result.wanted);
}

void report(const ReplaySettings& settings, const ReplayTimeline& timeline, const ReplayTarget& target,
            const ReplayResult& result) {
  const bool paced = settings.speed > 0.0 && result.sent > 0;
  const std::string of = result.wanted > result.sent ? " of " + std::to_string(result.wanted) : "";
  say("{}sent {}{} {} in {:.3f} s, {} retries\n",
      result.failed   ? "failed: "
      : interrupted() ? "interrupted: "
                      : "",
      result.sent, of, timeline.is_can() ? "frames" : "blocks", result.seconds, target.retries());
  if (paced)
    say("lateness p50 {:.1f} µs, p99 {:.1f} µs, max {:.1f} µs\n", result.late.percentile_us(0.5),
        result.late.percentile_us(0.99), result.late.max_us());
  nlohmann::json json = {{"schema", "ifog.replay/1"},
                         {"sent", result.sent},
                         {"of", nullptr},
                         {"seconds", result.seconds},
                         {"retries", target.retries()},
                         {"interrupted", interrupted()},
                         {"failed", result.failed},
                         {"lateness_us", nullptr},
                         {"unit", timeline.is_can() ? "frame" : "block"}};
  if (result.wanted > 0) json["of"] = result.wanted;
  if (paced)
    json["lateness_us"] = {{"p50", result.late.percentile_us(0.5)},
                           {"p99", result.late.percentile_us(0.99)},
                           {"max", result.late.max_us()}};
  write_json(settings.json, json);
}

void run(ReplaySettings settings) {
  const ReplayDestination& to = settings.to;
  if (to.kind == ReplayDestination::Kind::standard_output) will_write("--to", "-");
  if (to.kind == ReplayDestination::Kind::file) will_write("--to", to.name);
  settings.source.prefer_can = to.is_can();
  const ReplayTimeline timeline = read_timeline(settings.source);
  if (to.kind == ReplayDestination::Kind::file) {
    if (timeline.is_can())
      expect_no_other_kind("--to", to.name, kFrameEndings);
    else
      expect_no_other_kind("--to", to.name, kByteEndings);
  }

  catch_interrupts();
  const std::unique_ptr<ReplayTarget> target =
      open_target(to, timeline, settings.line, settings.speed == 0.0);
  if (target == nullptr) {
    warn("ifog replay: interrupted before anything was sent\n");
    throw Failed("interrupted");
  }
  prepare(settings);
  ReplayResult result;
  result.wanted = settings.loops * timeline.size();
  try {
    replay(timeline, settings, *target, result);
  } catch (const std::exception& error) {
    warn("ifog replay: {}\n", error.what());
    result.failed = true;
  }
  result.sent -= target->buffered();
  result.seconds = std::max(0.0, static_cast<double>(monotonic_ns() - result.begin_ns) * 1e-9);
  report(settings, timeline, *target, result);
  if (!complete(result)) throw Failed("not all was sent");
}

}  // namespace

void add_replay(const Command& program) {
  auto settings = std::make_shared<ReplaySettings>();
  const Command command =
      program.add_subcommand("replay", "Send a recording to a device, as it was recorded");
  ReplaySource& source = settings->source;
  command.add_option("capture", source.path,
                     "Flight recording, candump log, raw bytes, or a capture (.csv, .h5)",
                     {.required = true, .file = FileUse::read});
  command.add_taken<std::string>(
      "--to", [settings](const std::string& text) { settings->to = ReplayDestination::parse(text); },
      "can:INTERFACE, serial:DEVICE, udp:HOST:PORT, tcp:HOST:PORT (listens there), file:PATH, "
      "fifo:PATH or - (standard output)",
      {.required = true, .type = "WHERE"});
  command.add_option("--format", source.format, "of the recording",
                     {.shows_default = true, .choices = {"auto", "candump", "bytes", "csv"}});
  command.add_option("--speed", settings->speed, "times faster than recorded; 0: as fast as possible",
                     {.shows_default = true, .range = not_negative()});
  command.add_option("--loop", settings->loops, "how often; 0: for ever", {.shows_default = true});
  command.add_flag("--realtime", settings->realtime, "try SCHED_FIFO and locked memory");
  command.add_option("--spin", settings->spin_us, "µs before each deadline spent awake",
                     {.shows_default = true, .range = not_negative()});
  command.add_option("--block", source.block_bytes, "raw bytes: bytes sent together, a frame of the device");
  command.add_option("--rate", source.rate_hz, "raw bytes: blocks a second", {.range = positive()});
  source.input.add_to(command);
  command.add_option("--axis", source.axis, "CSV of one axis: the driver's axis it goes to");
  command.add_option("--baud", settings->line.baud, "serial: speed, else the driver's");
  command.add_option("--baud-base", settings->line.baud_base,
                     "serial: the UART's clock / 16, where the driver has it wrong");
  command.add_option("--data-bits", settings->line.data_bits, "serial: 5 to 8 bits a character",
                     {.shows_default = true, .range = within(5, 8)});
  command.add_taken<std::string>("--parity",
                                 [settings](const std::string& word) {
                                   settings->line.parity = word == "even"  ? SerialSettings::Parity::even
                                                           : word == "odd" ? SerialSettings::Parity::odd
                                                                           : SerialSettings::Parity::none;
                                 },
                                 "serial: none unless given", {.choices = {"none", "even", "odd"}});
  command.add_option("--stop-bits", settings->line.stop_bits, "serial: 1 or 2",
                     {.shows_default = true, .range = within(1, 2)});
  command.add_option("--json", settings->json, "write the report to this file", kWritesJson);
  command.callback([settings] { run(*settings); });
}

}  // namespace ifog::tools
