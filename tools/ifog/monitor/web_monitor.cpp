// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/monitor/web_monitor.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "msgs/axis_name.h"
#include "tools/ifog/monitor/view_lines.h"

namespace ifog::tools {
namespace {

using nlohmann::ordered_json;

// In nine digits, more than a screen shows: a minute of three axes is some 40 kB. What is no number is null.
double short_number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return std::strtod(text.data(), nullptr);
}

}  // namespace

void AxisTrace::take(double now_s, double raw, double denoised) {
  const auto number = static_cast<std::int64_t>(now_s / kBin_s);
  Bin& bin = bins_[static_cast<std::size_t>(number % kBins)];
  if (bin.number != number) bin = {number, raw, raw, denoised};
  // A NaN among numbers is passed over.
  bin.low = std::fmin(bin.low, raw);
  bin.high = std::fmax(bin.high, raw);
  bin.denoised = denoised;
}

std::vector<AxisTrace::Bin> AxisTrace::last_minute(double now_s) const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto now = static_cast<std::int64_t>(now_s / kBin_s);
  std::vector<Bin> out;
  for (std::int64_t number = now - kBins + 1; number < now; ++number) {
    const Bin& bin = bins_[static_cast<std::size_t>((number + kBins) % kBins)];
    out.push_back(number >= 0 && bin.number == number ? bin : Bin{number, kNone, kNone, kNone});
  }
  return out;
}

WebMonitor::WebMonitor(const PageAddress& address, const std::map<std::string, SensorView>& sensors,
                       const KnownHere& known, std::function<std::string()> waiting)
    : sensors_(sensors),
      known_(known),
      waiting_(std::move(waiting)),
      server_(address, [this](const std::string& sensor) { return data(sensor); }) {}

void WebMonitor::take(const std::string& sensor, const rate_t& message) {
  auto& traces = traces_[sensor];
  for (std::size_t a = 0; a < std::min(kMostAxes, message.raw.size()); ++a)
    traces[a].take(now_s(), message.raw[a], message.denoised[a]);
}

ordered_json WebMonitor::of_sensor(const std::string& name, const SensorView& sensor) const {
  ordered_json lines = ordered_json::array(), axes = ordered_json::array();
  for (const ShownLine& line : view_lines(name, sensor, {}, known_.of(name)))
    if (line.tone != Tone::figure) lines.push_back({tone_name(line.tone), line.text});
  const status_t* const status = sensor.live_status();
  const auto traces = traces_.find(name);
  for (std::size_t a = 0; a < std::min(kMostAxes, sensor.axis_count()); ++a) {
    ordered_json axis{{"name", axis_name(a, sensor.axis_count())}};
    if (a < sensor.axes().size()) {
      const AxisView& now = sensor.axes()[a];
      axis.update({{"rate_radps", now.rate_radps},
                   {"noise_radps", now.noise_radps},
                   {"raw_noise_radps", now.raw_noise_radps},
                   {"angle_rad", now.angle_rad}});
    }
    for (const char* const part : {"low", "high", "denoised", "allan"}) axis[part] = ordered_json::array();
    if (traces != traces_.end())
      for (const AxisTrace::Bin& bin : traces->second[a].last_minute(now_s())) {
        axis["low"].push_back(short_number(bin.low));
        axis["high"].push_back(short_number(bin.high));
        axis["denoised"].push_back(short_number(bin.denoised));
      }
    constexpr std::size_t kMostOctaves = 64;
    if (status != nullptr && a < status->allan_rate_radps.size()) {
      const std::vector<double>& allan = status->allan_rate_radps[a];
      for (std::size_t k = 0; k < std::min(kMostOctaves, allan.size()); ++k)
        axis["allan"].push_back(short_number(allan[k]));
    }
    axes.push_back(std::move(axis));
  }
  return {{"name", printable(name)},
          {"lines", lines},
          {"bin_s", AxisTrace::kBin_s},
          {"allan_tau0_s", status != nullptr ? status->allan_tau0_s : 0.0},
          {"axes", axes}};
}

std::string WebMonitor::data(const std::string& wanted) {
  const std::lock_guard held(guard_);
  ordered_json out{{"age_s", std::chrono::duration<double>(Clock::now() - interval_ended_).count()},
                   {"waiting", sensors_.empty() ? waiting_() : ""},
                   {"sensors", ordered_json::array()},
                   {"sensor", nullptr}};
  const auto asked = sensors_.find(wanted);
  const auto shown = asked != sensors_.end() ? asked : sensors_.begin();
  for (const auto& [name, sensor] : sensors_) out["sensors"].push_back({name, tone_name(tone_of(sensor))});
  if (shown != sensors_.end()) {
    out["chosen"] = shown->first;
    out["sensor"] = of_sensor(shown->first, shown->second);
  }
  return out.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace ifog::tools
