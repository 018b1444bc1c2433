// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/monitor/monitor.h"

#include <ifog/decode.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <iterator>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "drivers/ifog/quoted.h"
#include "msgs/channel_name.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/interrupt.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/monitor/message_json.h"

namespace ifog::tools {

Monitor::Monitor(const MonitorOptions& options)
    : options_(options),
      listener_(options.url, [this](const lcm_recv_buf_t& message,
                                    const std::string& channel) { take(message, channel); }),
      known_(options.field) {
  catch_interrupts();  // before the screen, which would catch them in another way
  // All sensors, so that for an unknown name the publishing ones can be listed.
  listener_.listen_to_sensor("");
  if (!options.json.empty()) json_.emplace(options.json);
  const bool people = isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1;
  if (!options.web.empty()) {
    web_ = std::make_unique<WebMonitor>(*page_address(options.web), sensors_, known_,
                                        [this] { return waiting().front() + " " + waiting().back(); });
    say("http://{}/ shows it; Ctrl-C ends this\n",
        options.web.find(':') == std::string::npos ? "localhost:" + options.web : options.web);
    finish_saying();
  } else if (people && !options.plain && !options.once && options.json.empty()) {
    screen_.emplace();
  }
}

// True if the reader of the JSON output has closed it, also while no message arrives.
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
  last_data_ = Clock::now();
  if (json_) tell(message_json(name, message) + "\n");
  // Increments are for programs; for people the rates are sufficient.
  if constexpr (!std::is_same_v<Message, imu_t>) {
    if (sensors_.size() >= kMostSensors && !sensors_.contains(name)) {
      ++crowded_;
      return;
    }
    sensors_[name].take(std::move(message));
  }
}

void Monitor::take(const lcm_recv_buf_t& buffer, const std::string& channel) {
  const auto [content, sensor] = channel_name(channel);
  const std::string name(sensor);
  if (!wanted(name)) {
    if (content != ChannelContent::foreign && others_.size() < kMostSensors) others_.insert(name);
    return;
  }
  if (content == ChannelContent::rate) take_message<rate_t>(buffer, name);
  if (content == ChannelContent::status) take_message<status_t>(buffer, name);
  if (content == ChannelContent::imu) take_message<imu_t>(buffer, name);
}

bool Monitor::wanted(const std::string& name) const {
  return options_.sensor.empty() || boost::iequals(name, options_.sensor);
}

void Monitor::end_interval(double seconds) {
  constexpr double kBetweenLooks_s = 5.0;
  for (auto& [name, sensor] : sensors_) sensor.end_interval(seconds);
  if (seconds_since(last_look_) > kBetweenLooks_s) {
    known_.look();
    last_look_ = Clock::now();
  }
  if (web_) web_->end_interval();
  if (screen_ || web_ || !options_.json.empty()) return;
  const std::vector<ShownLine> now = lines({});
  redraw(look_.lines_drawn, now);
  look_.lines_drawn = now.size();
}

// Only for output as lines: once, while no message has arrived.
void Monitor::say_what_is_waited_for() {
  constexpr double kPatience_s = 3.0;
  if (screen_ || waiting_reported_ || !sensors_.empty() || seconds_since(start_) < kPatience_s) return;
  waiting_reported_ = true;
  if (const std::string others = who_publishes(); !others.empty()) {
    warn("{}; these publish: {}\n", waiting().front() + " " + waiting().back(), others);
    return;
  }
  warn(
      "{}; is ifogd running, with this lcm_url, and a route for its multicast "
      "(ip route add 224.0.0.0/4 dev lo)?\n",
      waiting().front() + " " + waiting().back());
}

bool Monitor::received_any() const {
  return std::ranges::any_of(
      sensors_, [](const auto& entry) { return entry.second.messages() > 0 || entry.second.status(); });
}

bool Monitor::all_shown() const {
  return !sensors_.empty() &&
         std::ranges::all_of(sensors_, [](const auto& entry) { return entry.second.shown(); });
}

bool Monitor::run() {
  auto shown = start_;
  pollfd wanted[2]{{listener_.descriptor(), POLLIN, 0}, {screen_ ? STDIN_FILENO : -1, POLLIN, 0}};
  const pollfd &messages = wanted[0], &keys = wanted[1];
  if (screen_) draw();
  auto drawn = start_;
  for (bool on = true; on;) {
    const int ready = poll(wanted, 2, 50);
    if (reader_gone()) throw ReaderGone();
    if (interrupted()) break;
    const auto held = web_ ? std::unique_lock(web_->guard()) : std::unique_lock<std::mutex>();
    if (ready > 0 && (messages.revents & POLLIN) != 0) listener_.take();
    const bool pressed = ready > 0 && keys.revents != 0;
    if (seconds_since(shown) >= 1.0) {
      end_interval(seconds_since(shown));
      shown = Clock::now();
      if (options_.once && all_shown()) break;
    }
    say_what_is_waited_for();
    if (options_.seconds > 0.0 && seconds_since(start_) >= options_.seconds) break;
    if (!screen_ || (!pressed && ready >= 0 && seconds_since(drawn) < 0.25)) continue;
    for (int key = screen_->key(); on && key != 0; key = screen_->key()) on = obey(key);
    // A closed terminal is always ready for reading.
    if ((keys.revents & (POLLHUP | POLLERR)) != 0) break;
    draw();
    drawn = Clock::now();
  }
  web_.reset();
  look_.paused.reset();
  if (!options_.once && options_.web.empty() && seconds_since(shown) > 0.2)
    end_interval(seconds_since(shown));
  if (screen_) {
    screen_.reset();
    look_.only.clear();
    redraw(0, lines({}));  // the last state stays on the terminal
  }
  if (json_) json_->finish();
  return received_any();
}

void add_monitor(const Command& program) {
  const Command command = program.add_subcommand("monitor", "Show live what the daemon publishes");
  auto options = std::make_shared<MonitorOptions>();
  command.add_option("--sensor", options->sensor, "Only this sensor");
  command.add_option("--seconds", options->seconds, "Stop after this long", {.range = positive()});
  command.add_flag("--once", options->once, "Stop after one second of data of every sensor");
  command.add_flag("--plain", options->plain, "Lines instead of a screen with keys, at a terminal, too");
  command.add_option(
      "--json", options->json,
      "Instead of the figures every message as a line of JSON to this file; - is standard output",
      kWritesJson);
  command.add_option(
      "--web", options->web,
      "Instead of the figures a page for a browser, at this port of 127.0.0.1 or of another "
      "address of this computer",
      {.type = "[ADDRESS:]PORT", .check = [](const std::string& text) -> std::string {
         return page_address(text)
                    ? ""
                    : "is " + in_quotes(text) +
                          ", expected a port 1 ... 65535, or ADDRESS:PORT with a numeric address";
       }});
  options->field.add_to(command);
  command.add_option("--lcm-url", options->url, "As in the daemon's configuration", {.type = "URL"});
  command.callback([options] {
    if (options->once && !options->web.empty())
      throw WrongUsage("--once", "with --web, whose page is shown until it is ended");
    // Without a time limit, --once gives up like a script, because a daemon may never start.
    constexpr double kPatience_s = 10.0;
    if (options->once && options->seconds == 0.0) options->seconds = kPatience_s;
    Monitor monitor(*options);
    if (!monitor.run()) {
      if (const std::string others = monitor.who_publishes(); !others.empty())
        warn("ifog monitor: --sensor {}: none of that name publishes, expected one of: {}\n",
             in_quotes(options->sensor), others);
      else
        warn("ifog monitor: nothing heard on {}\n", options->url);
      throw Failed("nothing heard");
    }
  });
}

// "": none.
std::string Monitor::who_publishes() const {
  std::string out;
  for (const std::string& name : others_) out += (out.empty() ? "" : ", ") + printable(name);
  return out;
}

// The sensor or network that is waited for, and for how long.
std::vector<std::string> Monitor::waiting() const {
  const std::string wanted =
      options_.sensor.empty() ? "a sensor's messages (IFOG_*)" : in_quotes(options_.sensor);
  return {"waiting for " + wanted + " on " + printable(options_.url) + ",",
          std::to_string(static_cast<int>(seconds_since(last_data_))) + " s: nothing heard"};
}

std::vector<ShownLine> Monitor::lines(const LineStyle& style) const {
  constexpr double kSilent_s = 1.5;
  std::vector<ShownLine> out;
  for (const auto& [name, sensor] : look_.paused ? *look_.paused : sensors_) {
    if (!look_.only.empty() && name != look_.only) continue;
    if (!out.empty() && screen_) out.emplace_back();
    std::vector<ShownLine> of_sensor = view_lines(name, sensor, style, known_.of(name));
    std::move(of_sensor.begin(), of_sensor.end(), std::back_inserter(out));
  }
  if (refused_ > 0)
    out.push_back({std::to_string(refused_) + " messages that are none of ours, or damaged", Tone::warning});
  if (crowded_ > 0)
    out.push_back({std::to_string(crowded_) + " messages of more sensors than " +
                       std::to_string(kMostSensors) + ", which are shown",
                   Tone::warning});
  if (!screen_ || look_.paused || (!sensors_.empty() && seconds_since(last_data_) <= kSilent_s)) return out;
  std::vector<ShownLine> all;
  const auto add = [&](const std::vector<std::string>& parts, Tone tone) {
    for (std::string& line : wrapped(parts, " ", style.width)) all.push_back({std::move(line), tone});
  };
  add(waiting(), Tone::bad);
  std::move(out.begin(), out.end(), std::back_inserter(all));
  if (const std::string others = who_publishes(); sensors_.empty() && !others.empty())
    add({"These publish:", others}, Tone::plain);
  else if (sensors_.empty())
    add({"Is ifogd running, with this lcm_url? Is there a route for its multicast:",
         "ip route add 224.0.0.0/4 dev lo"},
        Tone::plain);
  return all;
}

std::string Monitor::foot() const {
  return std::string(look_.paused ? " PAUSED " : "") +
         " q quit  space pause  d details  u unit  s sensor  r losses from now  ↑↓ scroll";
}

void Monitor::draw() {
  look_.style.width = screen_->width();
  screen_->draw(
      look_.help
          ? std::vector<
                ShownLine>{{"ifog monitor"},
                           {""},
                           {"  q, escape   quit"},
                           {"  space, p    pause: the figures stand still, nothing is lost"},
                           {"  d           details: latency, books, channels, NIS"},
                           {"  u           unit: as it suits, °/h, °/s, rad/s"},
                           {"  s, tab      one sensor after the other, then all"},
                           {"  r           count losses from now on"},
                           {"  ↑ ↓ j k     scroll, page up and down"},
                           {""},
                           {"  noise is the standard deviation within a second; the line at the"},
                           {"  right is the denoised rate, a second a column, and span its height."},
                           {"  Flags are counted in messages of the last second. Any other key goes back."}}
          : lines(look_.style),
      foot());
}

bool Monitor::obey(int key) {
  constexpr int kEscape = 27;
  if (key == 'q' || key == 'Q' || key == kEscape) return false;
  if (std::exchange(look_.help, false)) return true;
  switch (key) {
    case ' ':
    case 'p':
      look_.paused = look_.paused ? std::nullopt : std::optional(sensors_);
      break;
    case 'd':
      look_.style.details = !look_.style.details;
      break;
    case 'u':
      look_.style.unit = static_cast<RateUnit>((static_cast<int>(look_.style.unit) + 1) % 4);
      break;
    case 's':
    case '\t': {
      const auto next = look_.only.empty() ? sensors_.begin() : sensors_.upper_bound(look_.only);
      look_.only = next == sensors_.end() ? "" : next->first;
      break;
    }
    case 'r':
      for (auto& [name, sensor] : sensors_) sensor.forget_losses();
      refused_ = 0;
      break;
    default:
      look_.help = true;
  }
  return true;
}

}  // namespace ifog::tools
