// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/monitor/web_monitor.h"

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "msgs/axis_name.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/monitor/view_lines.h"

namespace ifog::tools {
namespace {

using nlohmann::ordered_json;

ordered_json of_axis(const SensorView& sensor, std::size_t a) {
  constexpr std::size_t kMostOctaves = 64;
  const std::size_t all = sensor.axis_count();
  ordered_json out{
      {"name", axis_name(a, all)}, {"seconds", ordered_json::array()}, {"allan", ordered_json::array()}};
  if (a < sensor.axes().size()) {
    const AxisView& now = sensor.axes()[a];
    out.update({{"rate_radps", now.rate_radps},
                {"noise_radps", now.noise_radps},
                {"raw_noise_radps", now.raw_noise_radps},
                {"angle_rad", now.angle_rad}});
  }
  for (const SensorView::Second& each : sensor.history(a))
    out["seconds"].push_back({each.raw_low_radps, each.raw_high_radps, each.rate_radps});
  if (const status_t* const status = sensor.live_status();
      status != nullptr && a < status->allan_rate_radps.size()) {
    const auto& allan = status->allan_rate_radps[a];
    out["allan"] = std::vector(
        allan.begin(), allan.begin() + static_cast<std::ptrdiff_t>(std::min(kMostOctaves, allan.size())));
  }
  return out;
}

ordered_json of_sensor(const std::string& name, const SensorView& sensor, const KnownSensor* known) {
  constexpr std::size_t kMostAxes = 3;
  ordered_json lines = ordered_json::array(), axes = ordered_json::array();
  for (const ShownLine& line : view_lines(name, sensor, {}, known))
    if (line.tone != Tone::figure) lines.push_back({tone_name(line.tone), line.text});
  for (std::size_t a = 0; a < std::min(kMostAxes, sensor.axis_count()); ++a)
    axes.push_back(of_axis(sensor, a));
  const double tau0_s = sensor.live_status() != nullptr ? sensor.live_status()->allan_tau0_s : 0.0;
  return {{"lines", lines}, {"allan_tau0_s", tau0_s}, {"axes", axes}};
}

}  // namespace

WebMonitor::WebMonitor(const PageAddress& address, const std::map<std::string, SensorView>& sensors,
                       const KnownHere& known, std::function<std::string()> waiting)
    : sensors_(sensors),
      known_(known),
      waiting_(std::move(waiting)),
      server_(address, [this](const std::string& sensor) { return data(sensor); }) {}

std::string WebMonitor::data(const std::string& wanted) {
  const std::lock_guard held(guard_);
  ordered_json out{{"age_s", std::chrono::duration<double>(Clock::now() - interval_ended_).count()},
                   {"waiting", sensors_.empty() ? waiting_() : ""},
                   {"sensors", ordered_json::array()}};
  const auto asked = sensors_.find(wanted);
  const auto shown = asked != sensors_.end() ? asked : sensors_.begin();
  for (const auto& [name, sensor] : sensors_)
    out["sensors"].push_back({name, tone_name(tone_of(sensor)), printable(name)});
  if (shown != sensors_.end()) {
    out["chosen"] = shown->first;
    out["sensor"] = of_sensor(shown->first, shown->second, known_.of(shown->first));
  }
  return json_text(out, -1);
}

}  // namespace ifog::tools
