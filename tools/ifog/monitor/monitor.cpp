// SPDX-License-Identifier: Apache-2.0
// ifog monitor: what the daemon publishes, live, as an engineer wants to see it: a screen with keys where
// people sit at a terminal, lines elsewhere, JSON for programs.
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <ifog/decode.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "drivers/capture/output_file.h"
#include "drivers/ifog/quoted.h"
#include "msgs/channel_name.h"
#include "tools/ifog/captures/lcm_listener.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/monitor/message_json.h"
#include "tools/ifog/monitor/screen.h"
#include "tools/ifog/monitor/sensor_view.h"
#include "tools/ifog/monitor/view_lines.h"

namespace ifog::tools {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  std::string sensor, url = "udpm://239.255.76.67:7667?ttl=0", json;
  double seconds = 0.0;  // 0: until interrupted
  bool once = false, plain = false;
};

double seconds_since(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}

class Monitor {
 public:
  explicit Monitor(const Options& options)
      : options_(options),
        listener_(options.url, [this](const lcm_recv_buf_t& message, const std::string& channel) {
          take(message, channel);
        }) {
    // All of them: a name that none has is answered with those that publish.
    listener_.listen_to_sensor("");
    if (!options.json.empty()) json_.emplace(options.json);
    const bool people = isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1;
    if (people && !options.plain && !options.once && options.json.empty()) screen_.emplace();
  }

  // False: nothing was heard.
  bool run();
  [[nodiscard]] std::string who_publishes() const;

 private:
  void take(const lcm_recv_buf_t& buffer, const std::string& channel);
  template <typename Message>
  void take_message(const lcm_recv_buf_t& buffer, const std::string& name);
  void tell(const std::string& line);
  [[nodiscard]] bool reader_gone() const;
  void end_interval(double seconds);
  void say_what_is_waited_for();
  bool obey(Screen::Key key);  // false: quit
  void draw();
  [[nodiscard]] std::vector<std::string> lines(const LineStyle& style) const;
  [[nodiscard]] std::vector<std::string> waiting() const;
  [[nodiscard]] bool wanted(const std::string& name) const;
  [[nodiscard]] std::string foot() const;
  [[nodiscard]] bool all_shown() const;
  [[nodiscard]] bool heard() const;

  const Options& options_;
  LcmListener listener_;
  std::optional<OutputFile> json_;
  std::optional<Screen> screen_;
  std::map<std::string, SensorView> sensors_;
  std::set<std::string> others_;  // that publish and are not wanted
  std::uint64_t refused_ = 0;     // that are no message of their channel's type
  Clock::time_point start_ = Clock::now(), last_heard_ = start_;
  // Of the screen.
  LineStyle style_;
  std::string only_;                                         // this sensor; empty: all
  std::optional<std::map<std::string, SensorView>> paused_;  // as they stood then
  bool help_ = false, told_waiting_ = false;
  std::size_t lines_drawn_ = 0;
};

// Lines without an end: who reads them ends it, as with what is said, also while nothing comes.
bool Monitor::reader_gone() const {
  if (!json_ || !is_standard_output(options_.json)) return false;
  pollfd reader{json_->descriptor(), 0, 0};
  return poll(&reader, 1, 0) > 0 && (reader.revents & POLLERR) != 0;
}

void Monitor::tell(const std::string& line) {
  try {
    json_->write(line);
  } catch (const std::runtime_error&) {
    if (reader_gone()) throw ReaderGone();
    throw;
  }
}

template <typename Message>
void Monitor::take_message(const lcm_recv_buf_t& buffer, const std::string& name) {
  Message message{};
  if (!decode_message(buffer.data, buffer.data_size, message)) {
    ++refused_;
    return;
  }
  last_heard_ = Clock::now();
  if (json_) tell(message_json(name, message) + "\n");
  // Increments are for programs: people see the same turn in the rates.
  if constexpr (!std::is_same_v<Message, imu_t>) sensors_[name].take(std::move(message));
}

void Monitor::take(const lcm_recv_buf_t& buffer, const std::string& channel) {
  const auto [content, sensor] = channel_name(channel);
  const std::string name(sensor);
  if (!wanted(name)) {
    if (content != ChannelContent::foreign) others_.insert(name);
    return;
  }
  if (content == ChannelContent::rate) take_message<rate_t>(buffer, name);
  if (content == ChannelContent::status) take_message<status_t>(buffer, name);
  if (content == ChannelContent::imu) take_message<imu_t>(buffer, name);
}

bool Monitor::wanted(const std::string& name) const {
  return options_.sensor.empty() ||
         std::equal(name.begin(), name.end(), options_.sensor.begin(), options_.sensor.end(),
                    [](char a, char b) {
                      return a == static_cast<char>(std::toupper(static_cast<unsigned char>(b)));
                    });
}

// "": none.
std::string Monitor::who_publishes() const {
  std::string out;
  for (const std::string& name : others_) out += (out.empty() ? "" : ", ") + printable(name);
  return out;
}

// For what, and since when.
std::vector<std::string> Monitor::waiting() const {
  const std::string wanted =
      options_.sensor.empty() ? "a sensor's messages (IFOG_*)" : in_quotes(options_.sensor);
  return {"waiting for " + wanted + " on " + printable(options_.url) + ",",
          std::to_string(static_cast<int>(seconds_since(last_heard_))) + " s: nothing heard"};
}

std::vector<std::string> Monitor::lines(const LineStyle& style) const {
  constexpr double kSilent_s = 1.5;
  std::vector<std::string> out;
  for (const auto& [name, sensor] : paused_ ? *paused_ : sensors_) {
    if (!only_.empty() && name != only_) continue;
    if (!out.empty() && screen_) out.emplace_back();
    std::vector<std::string> of_sensor = view_lines(name, sensor, style);
    std::move(of_sensor.begin(), of_sensor.end(), std::back_inserter(out));
  }
  if (refused_ > 0) out.push_back(std::to_string(refused_) + " messages that are none of ours, or damaged");
  if (screen_ && !paused_ && (sensors_.empty() || seconds_since(last_heard_) > kSilent_s)) {
    std::vector<std::string> wait = wrapped(waiting(), " ", style.width);
    out.insert(out.begin(), std::make_move_iterator(wait.begin()), std::make_move_iterator(wait.end()));
    if (const std::string others = who_publishes(); sensors_.empty() && !others.empty()) {
      for (std::string& line : wrapped({"These publish:", others}, " ", style.width))
        out.push_back(std::move(line));
    } else if (sensors_.empty()) {
      for (std::string& line :
           wrapped({"Is ifogd running, with this lcm_url? Is there a route for its multicast:",
                    "ip route add 224.0.0.0/4 dev lo"},
                   " ", style.width))
        out.push_back(std::move(line));
    }
  }
  return out;
}

std::string Monitor::foot() const {
  return std::string(paused_ ? " PAUSED " : "") +
         " q quit  space pause  d details  u unit  s sensor  r losses from now  ↑↓ scroll";
}

void Monitor::draw() {
  style_.width = screen_->width();
  screen_->draw(
      help_ ? std::vector<std::string>{"ifog monitor", "", "  q, escape   quit",
                                       "  space, p    pause: the figures stand still, nothing is lost",
                                       "  d           details: latency, books, channels, NIS",
                                       "  u           unit: as it suits, °/h, °/s, rad/s",
                                       "  s, tab      one sensor after the other, then all",
                                       "  r           count losses from now on",
                                       "  ↑ ↓ j k     scroll, page up and down", "",
                                       "  noise is the standard deviation within a second; the line at the",
                                       "  right is the denoised rate, a second a column. Flags are counted",
                                       "  in messages of the last second. Any key goes back."}
            : lines(style_),
      foot());
}

bool Monitor::obey(Screen::Key key) {
  if (std::exchange(help_, key == Screen::Key::help && !help_) && key != Screen::Key::quit) return true;
  switch (key) {
    case Screen::Key::quit:
      return false;
    case Screen::Key::pause:
      paused_ = paused_ ? std::nullopt : std::optional(sensors_);
      break;
    case Screen::Key::details:
      style_.details = !style_.details;
      break;
    case Screen::Key::unit:
      style_.unit = static_cast<RateUnit>((static_cast<int>(style_.unit) + 1) % 4);
      break;
    case Screen::Key::sensor: {
      const auto next = only_.empty() ? sensors_.begin() : sensors_.upper_bound(only_);
      only_ = next == sensors_.end() ? "" : next->first;
      break;
    }
    case Screen::Key::forget:
      for (auto& [name, sensor] : sensors_) sensor.forget_losses();
      refused_ = 0;
      break;
    case Screen::Key::up:
      screen_->scroll(-1);
      break;
    case Screen::Key::down:
      screen_->scroll(1);
      break;
    case Screen::Key::page_up:
      screen_->scroll(-20);
      break;
    case Screen::Key::page_down:
      screen_->scroll(20);
      break;
    case Screen::Key::none:
    case Screen::Key::help:
    case Screen::Key::resized:
      break;
  }
  return true;
}

void Monitor::end_interval(double seconds) {
  for (auto& [name, sensor] : sensors_) sensor.end_interval(seconds);
  if (screen_ || !options_.json.empty()) return;
  const std::vector<std::string> now = lines({});
  redraw(lines_drawn_, now);
  lines_drawn_ = now.size();
}

// For who sees lines only: once, while nothing has come at all.
void Monitor::say_what_is_waited_for() {
  constexpr double kPatience_s = 3.0;
  if (screen_ || told_waiting_ || !sensors_.empty() || seconds_since(start_) < kPatience_s) return;
  told_waiting_ = true;
  if (const std::string others = who_publishes(); !others.empty()) {
    warn("%s; these publish: %s\n", (waiting().front() + " " + waiting().back()).c_str(), others.c_str());
    return;
  }
  warn(
      "%s; is ifogd running, with this lcm_url, and a route for its multicast "
      "(ip route add 224.0.0.0/4 dev lo)?\n",
      (waiting().front() + " " + waiting().back()).c_str());
}

bool Monitor::heard() const {
  return std::any_of(sensors_.begin(), sensors_.end(),
                     [](const auto& entry) { return entry.second.messages() > 0 || entry.second.status(); });
}

bool Monitor::all_shown() const {
  return !sensors_.empty() && std::all_of(sensors_.begin(), sensors_.end(),
                                          [](const auto& entry) { return entry.second.shown(); });
}

bool Monitor::run() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  sigprocmask(SIG_BLOCK, &set, nullptr);
  const int stop = signalfd(-1, &set, SFD_CLOEXEC);
  auto shown = start_;
  std::array<pollfd, 3> wanted{pollfd{stop, POLLIN, 0}, pollfd{listener_.descriptor(), POLLIN, 0},
                               pollfd{screen_ ? STDIN_FILENO : -1, POLLIN, 0}};
  if (screen_) draw();
  auto drawn = start_;
  for (bool on = true; on;) {
    const int ready = poll(wanted.data(), wanted.size(), 50);
    if (reader_gone()) throw ReaderGone();
    if (ready > 0 && (wanted[0].revents & POLLIN) != 0) break;
    if (ready > 0 && (wanted[1].revents & POLLIN) != 0) listener_.take();
    const bool pressed = ready > 0 && wanted[2].revents != 0;
    if (seconds_since(shown) >= 1.0) {
      end_interval(seconds_since(shown));
      shown = Clock::now();
      if (options_.once && all_shown()) break;
    }
    say_what_is_waited_for();
    if (options_.seconds > 0.0 && seconds_since(start_) >= options_.seconds) break;
    if (!screen_ || (!pressed && ready >= 0 && seconds_since(drawn) < 0.25)) continue;
    for (Screen::Key key = screen_->key(); on && key != Screen::Key::none; key = screen_->key())
      on = obey(key);
    // A terminal that hung up is for ever ready to be read.
    if ((wanted[2].revents & (POLLHUP | POLLERR)) != 0) break;
    draw();
    drawn = Clock::now();
  }
  close(stop);
  paused_.reset();
  if (!options_.once && seconds_since(shown) > 0.2) end_interval(seconds_since(shown));
  if (screen_) {
    screen_.reset();
    only_.clear();
    redraw(0, lines({}));  // what was seen last stays on the terminal
  }
  if (json_) json_->finish();
  return heard();
}

}  // namespace

void add_monitor(const Command& program) {
  const Command command = program.add_subcommand("monitor", "Show live what the daemon publishes");
  auto options = std::make_shared<Options>();
  command.add_option("--sensor", options->sensor, "Only this sensor").type_name("NAME");
  command.add_option("--seconds", options->seconds, "Stop after this long").positive();
  command.add_flag("--once", options->once, "Stop after one second of every sensor heard");
  command.add_flag("--plain", options->plain, "Lines instead of a screen with keys, at a terminal, too");
  command
      .add_option("--json", options->json,
                  "Instead of the figures every message as a line of JSON to this file; - is standard output")
      .type_name("FILE");
  command.add_option("--lcm-url", options->url, "As in the daemon's configuration").type_name("URL");
  command.callback([options] {
    // Without a time limit, --once waits for a daemon that may never come: give up as a script would want.
    constexpr double kPatience_s = 10.0;
    if (options->once && options->seconds == 0.0) options->seconds = kPatience_s;
    will_write("--json", options->json, kJsonEndings);
    Monitor monitor(*options);
    if (!monitor.run()) {
      if (const std::string others = monitor.who_publishes(); !others.empty())
        warn("ifog monitor: --sensor %s: none of that name publishes, expected one of: %s\n",
             in_quotes(options->sensor).c_str(), others.c_str());
      else
        warn("ifog monitor: nothing heard on %s\n", options->url.c_str());
      throw Failed("nothing heard");
    }
  });
}

}  // namespace ifog::tools
