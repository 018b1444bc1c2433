// SPDX-License-Identifier: Apache-2.0
// Screen and keys of the monitor on a terminal.
#include <iterator>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "tools/ifog/monitor/monitor.h"

namespace ifog::tools {

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
