// ifog monitor: what the daemon publishes, live, as an engineer wants to see it.
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <ifog/decode.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "filters/units/field_units.h"
#include "msgs/state_name.h"
#include "tools/ifog/captures/lcm_listener.h"
#include "tools/ifog/captures/lcm_loss.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  std::string sensor, url = "udpm://239.255.76.67:7667?ttl=0";
  double seconds = 0.0;  // 0: until interrupted
  bool once = false;
};

// Of one axis, since the last line was shown.
struct AxisFigures {
  double mean = 0.0, square = 0.0;  // of denoised
  double raw_mean = 0.0, raw_square = 0.0;
  double angle = 0.0, variance = 0.0;
};

struct Sensor {
  std::int64_t messages = 0, shown = 0, gaps = 0, gated = 0;
  std::int64_t in_interval = 0;
  LcmLoss way;
  std::vector<AxisFigures> axes;
  std::string model;
  bool has_status = false;
  status_t status{};
};

// Beyond a tenth no crystal is off: a recording is played faster or slower than it was made.
std::string clock_text(double offset_ppm) {
  if (std::abs(offset_ppm) > 1e5) return "not in real time";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%+.0f ppm", offset_ppm);
  return text.data();
}

// A rate in the unit a person reads: °/h below 0.1 °/s.
std::string rate_text(double radps) {
  std::array<char, 48> text{};
  if (std::abs(radps) / kDegree < 0.1)
    std::snprintf(text.data(), text.size(), "%+.4f °/h", radps / kDegreePerHour);
  else
    std::snprintf(text.data(), text.size(), "%+.5f °/s", radps / kDegree);
  return text.data();
}

// What came in and where it went, as status_t's identities have it.
std::string books_text(const status_t& status) {
  const auto n = [](std::int64_t count) { return std::to_string(count); };
  std::string text = "  books: ";
  if (status.frames_read > 0)
    text += n(status.frames_read) + " CAN frames = " + n(status.frames_good) + " decoded + " +
            n(status.frames_format) + " refused + " + n(status.frames_other) + " not the sensor's; ";
  else
    text += n(status.bytes_read) + " bytes = " + n(status.bytes_framed) + " in frames + " +
            n(status.bytes_skipped) + " skipped + " + n(status.bytes_pending) + " pending; ";
  return text + n(status.samples_in) + " samples = " + n(status.samples_published) + " published + " +
         n(status.samples_merged) + " merged + " + n(status.lcm_failures) + " not sent + " +
         n(status.samples_waiting) + " waiting, " + n(status.samples_repeated) + " came twice";
}

// Environment channels by name; the age of one that is not fresh.
std::string channels_text(const status_t& status) {
  constexpr double kFresh_s = 2.0;
  std::string out;
  for (std::size_t i = 0; i < status.channel_name.size(); ++i) {
    std::array<char, 96> text{};
    if (!std::isfinite(status.channel_age_s[i]))
      std::snprintf(text.data(), text.size(), " not heard of");
    else if (status.channel_age_s[i] > kFresh_s)
      std::snprintf(text.data(), text.size(), " %.6g (%.0f s old)", status.channel_value[i],
                    status.channel_age_s[i]);
    else
      std::snprintf(text.data(), text.size(), " %.6g", status.channel_value[i]);
    out += (i == 0 ? "" : "  ") + status.channel_name[i] + text.data();
  }
  return out;
}

class Monitor {
 public:
  explicit Monitor(const Options& options)
      : options_(options),
        listener_(options.url, [this](const lcm_recv_buf_t& message, const std::string& channel) {
          take(message, channel);
        }) {
    listener_.listen_to_sensor(options.sensor);
  }

  // False: nothing was heard.
  bool run();

 private:
  void take(const lcm_recv_buf_t& buffer, const std::string& channel);
  void take_rate(Sensor& sensor, const rate_t& message);
  void show(double interval_s);
  [[nodiscard]] bool all_shown() const;

  const Options& options_;
  LcmListener listener_;
  std::map<std::string, Sensor> sensors_;
  std::uint64_t refused_ = 0;  // that are no message of their channel's type
  std::size_t lines_drawn_ = 0;
};

void Monitor::take(const lcm_recv_buf_t& buffer, const std::string& channel) {
  constexpr std::string_view kPrefix = "IFOG_", kStatus = "_STATUS";
  std::string name = channel.substr(kPrefix.size());
  if (name.ends_with(kStatus)) {
    status_t status{};
    if (!decode_message(buffer.data, buffer.data_size, status)) {
      ++refused_;
      return;
    }
    name.resize(name.size() - kStatus.size());
    sensors_[name].status = std::move(status);
    sensors_[name].has_status = true;
    return;
  }
  rate_t message{};
  if (!decode_message(buffer.data, buffer.data_size, message)) {
    ++refused_;
    return;
  }
  take_rate(sensors_[name], message);
}

void Monitor::take_rate(Sensor& sensor, const rate_t& message) {
  ++sensor.messages;
  ++sensor.in_interval;
  sensor.model = message.model;
  if ((message.flags & rate_t::FLAG_GAP) != 0) ++sensor.gaps;
  if ((message.flags & rate_t::FLAG_GATED) != 0) ++sensor.gated;
  sensor.way.take(message);
  sensor.axes.resize(static_cast<std::size_t>(message.axes));
  const auto n = static_cast<double>(sensor.in_interval);
  for (std::size_t a = 0; a < sensor.axes.size(); ++a) {
    AxisFigures& axis = sensor.axes[a];
    const auto update = [n](double value, double& mean, double& square) {
      if (!std::isfinite(value)) return;
      const double difference = value - mean;
      mean += difference / n;
      square += difference * (value - mean);
    };
    update(message.denoised[a], axis.mean, axis.square);
    update(message.raw[a], axis.raw_mean, axis.raw_square);
    axis.angle = message.angle[a];
    axis.variance = message.variance[a];
  }
}

void Monitor::show(double interval_s) {
  std::vector<std::string> lines;
  const auto line = [&](std::string content) { lines.push_back(std::move(content)); };
  for (auto& [name, sensor] : sensors_) {
    std::array<char, 256> head{};
    const status_t& status = sensor.status;
    std::snprintf(head.data(), head.size(),
                  "%s  %.1f Hz  %lld messages, %lld lost on LCM, %lld gaps, %lld gated%s%s", name.c_str(),
                  static_cast<double>(sensor.in_interval) / interval_s,
                  static_cast<long long>(sensor.messages), static_cast<long long>(sensor.way.lost()),
                  static_cast<long long>(sensor.gaps), static_cast<long long>(sensor.gated),
                  sensor.model.empty() ? "" : "  model ", sensor.model.c_str());
    line(head.data());
    if (sensor.in_interval == 0)
      line(std::string("  no samples in the last second") +
           (sensor.has_status ? std::string(": ") + state_name(status.state) : ""));
    const auto n = static_cast<double>(std::max<std::int64_t>(2, sensor.in_interval));
    for (std::size_t a = 0; sensor.in_interval > 0 && a < sensor.axes.size(); ++a) {
      AxisFigures& axis = sensor.axes[a];
      std::array<char, 256> row{};
      std::snprintf(row.data(), row.size(), "  axis %zu  %s  noise %.4f °/h (raw %.4f)  angle %+.6f°", a,
                    rate_text(axis.mean).c_str(), std::sqrt(axis.square / (n - 1.0)) / kDegreePerHour,
                    std::sqrt(axis.raw_square / (n - 1.0)) / kDegreePerHour, axis.angle / kDegree);
      std::string content = row.data();
      if (sensor.has_status && a < status.nis_mean.size()) {
        std::snprintf(row.data(), row.size(), "  NIS %.2f  whiteness %+.2f", status.nis_mean[a],
                      status.whiteness[a]);
        content += row.data();
      }
      line(content);
      axis = AxisFigures{};
    }
    if (sensor.has_status) {
      std::array<char, 512> row{};
      std::snprintf(
          row.data(), row.size(),
          "  latency p50 %.0f p99 %.0f max %.0f us  crc %lld  skipped %lld bytes  missing %lld  "
          "repeated %lld  incomplete %lld  merged %lld  kernel drops %lld (channels %lld)  line errors "
          "%lld  stale %lld  clock %s",
          status.latency_p50_us, status.latency_p99_us, status.latency_max_us,
          static_cast<long long>(status.frames_crc), static_cast<long long>(status.bytes_skipped),
          static_cast<long long>(status.sequence_missing),
          static_cast<long long>(status.frames_repeated) + status.samples_repeated,
          static_cast<long long>(status.samples_incomplete), static_cast<long long>(status.samples_merged),
          static_cast<long long>(status.kernel_drops), static_cast<long long>(status.channel_drops),
          static_cast<long long>(status.can_error_frames), static_cast<long long>(status.channel_stale),
          clock_text(status.clock_offset_ppm).c_str());
      line(row.data());
      line(books_text(status));
      if (const std::string channels = channels_text(status); !channels.empty()) line("  " + channels);
      if (!status.fault.empty()) line("  " + status.fault);
    }
    sensor.shown = sensor.messages;
    sensor.in_interval = 0;
  }
  if (refused_ > 0) line(std::to_string(refused_) + " messages that are none of ours, or damaged");
  redraw(lines_drawn_, lines);
  lines_drawn_ = lines.size();
}

bool Monitor::all_shown() const {
  return !sensors_.empty() && std::all_of(sensors_.begin(), sensors_.end(),
                                          [](const auto& entry) { return entry.second.shown > 0; });
}

bool Monitor::run() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  sigprocmask(SIG_BLOCK, &set, nullptr);
  const int stop = signalfd(-1, &set, SFD_CLOEXEC);
  const auto start = Clock::now();
  auto shown = start;
  const auto seconds_since = [](Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  };
  std::array<pollfd, 2> wanted{pollfd{stop, POLLIN, 0}, pollfd{listener_.descriptor(), POLLIN, 0}};
  for (;;) {
    const int ready = poll(wanted.data(), wanted.size(), 50);
    if (ready > 0 && (wanted[0].revents & POLLIN) != 0) break;
    if (ready > 0 && (wanted[1].revents & POLLIN) != 0) listener_.take();
    if (seconds_since(shown) >= 1.0) {
      show(seconds_since(shown));
      shown = Clock::now();
      if (options_.once && all_shown()) break;
    }
    if (options_.seconds > 0.0 && seconds_since(start) >= options_.seconds) break;
  }
  close(stop);
  if (!options_.once && seconds_since(shown) > 0.2) show(seconds_since(shown));
  return std::any_of(sensors_.begin(), sensors_.end(),
                     [](const auto& entry) { return entry.second.messages > 0; });
}

}  // namespace

void add_monitor(CLI::App& app) {
  CLI::App* command = app.add_subcommand("monitor", "Show live what the daemon publishes");
  auto options = std::make_shared<Options>();
  command->add_option("--sensor", options->sensor, "Only this sensor")->type_name("NAME");
  command->add_option("--seconds", options->seconds, "Stop after this long")->check(CLI::PositiveNumber);
  command->add_flag("--once", options->once, "Stop after one second of every sensor heard");
  command->add_option("--lcm-url", options->url, "As in the daemon's configuration")->type_name("URL");
  command->callback([options] {
    // Without a time limit, --once waits for a daemon that may never come: give up as a script would want.
    constexpr double kPatience_s = 10.0;
    if (options->once && options->seconds == 0.0) options->seconds = kPatience_s;
    if (!Monitor(*options).run()) {
      warn("ifog monitor: nothing heard on %s\n", options->url.c_str());
      throw Failed("nothing heard");
    }
  });
}

}  // namespace ifog::tools
