// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/monitor/view_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "drivers/ifog/quoted.h"
#include "filters/units/field_units.h"
#include "msgs/axis_name.h"
#include "msgs/state_name.h"
#include "tools/ifog/console/hertz.h"
#include "tools/ifog/field/books.h"
#include "tools/ifog/monitor/spark_line.h"

namespace ifog::tools {
namespace {

constexpr std::size_t kLeastWidth = 40;
constexpr double kStale_s = 2.5;  // two statuses have not come

template <typename... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 160> out{};
  std::snprintf(out.data(), out.size(), format, values...);
  return out.data();
}

std::string n(std::int64_t count) { return std::to_string(count); }

struct Unit {
  double radps;
  const char* name;
  int decimals;
};

Unit unit_for(double rate_radps, RateUnit wanted) {
  constexpr Unit kHourly{kDegreePerHour, "°/h", 4}, kSecondly{kDegree, "°/s", 5}, kSi{1.0, "rad/s", 9};
  switch (wanted) {
    case RateUnit::degree_per_hour:
      return kHourly;
    case RateUnit::degree_per_second:
      return kSecondly;
    case RateUnit::radian_per_second:
      return kSi;
    case RateUnit::automatic:
      break;
  }
  return std::abs(rate_radps) / kDegree < 0.1 ? kHourly : kSecondly;
}

// Beyond a tenth no crystal is off: a recording is played faster or slower than it was made.
std::string clock_text(double offset_ppm) {
  return std::abs(offset_ppm) > 1e5 ? "not in real time" : text("%+.0f ppm", offset_ppm);
}

std::string axis_line(const SensorView& sensor, std::size_t a, const LineStyle& style) {
  const AxisView& axis = sensor.axes()[a];
  const Unit unit = unit_for(axis.rate_radps, style.unit);
  const auto number = [&](const char* sign, double radps) -> std::string {
    if (!std::isfinite(radps)) return "-";
    const std::string format = std::string("%") + sign + "." + std::to_string(unit.decimals) + "f";
    std::array<char, 48> out{};
    std::snprintf(out.data(), out.size(), format.c_str(), radps / unit.radps);
    return std::string(out.data());
  };
  const std::string rate = "  " + std::string(axis_name(a, sensor.axes().size())) + "  " +
                           number("+", axis.rate_radps) + " " + unit.name,
                    noise = "  noise " + number("", axis.noise_radps),
                    raw = " (raw " + number("", axis.raw_noise_radps) + ")",
                    angle = text("  angle %+.6f°", axis.angle_rad / kDegree);
  if (!std::isfinite(axis.rate_radps) && axis.angle_rad == 0.0)
    return "  " + std::string(axis_name(a, sensor.axes().size())) + "  not measured";
  // What there is no room for goes, the least needed first.
  std::string out = rate + noise + raw + angle;
  if (style.width != 0 && columns_of(out) > style.width) out = rate + noise + angle;
  if (style.width != 0 && columns_of(out) > style.width) out = rate + angle;
  constexpr std::size_t kMostSpark = 60, kLeastSpark = 4;
  if (style.width == 0) return out;
  const std::size_t taken = columns_of(out) + 2;
  if (taken + kLeastSpark <= style.width)
    out += "  " + spark_line(sensor.history(a), std::min(kMostSpark, style.width - taken));
  return out;
}

std::string head_line(std::string_view name, const SensorView& sensor) {
  std::string out = printable(name);
  // A status comes each second: a daemon that was killed says nothing of its end.
  if (sensor.silent_s() > kStale_s)
    out += text("  no message for %.0f s: has ifogd ended?", sensor.silent_s());
  else if (sensor.status())
    out += std::string("  ") + state_name(sensor.status()->state);
  if (sensor.judged()) out += "  " + in_hertz(sensor.message_rate_hz());
  out += text("  %lld messages", static_cast<long long>(sensor.messages()));
  if (!sensor.model().empty()) out += "  model " + printable(sensor.model());
  return out;
}

// Environment channels by name; the age of one that is not fresh.
std::vector<std::string> channels(const status_t& status) {
  constexpr double kFresh_s = 2.0;
  std::vector<std::string> out;
  for (std::size_t i = 0; i < status.channel_name.size(); ++i) {
    const double age_s = status.channel_age_s[i];
    std::string value = !std::isfinite(age_s) ? "not heard of" : text("%.6g", status.channel_value[i]);
    if (std::isfinite(age_s) && age_s > kFresh_s) value += text(" (%.0f s old)", age_s);
    out.push_back(printable(status.channel_name[i]) + " " + value);
  }
  return out;
}

std::vector<std::string> health(const status_t& status) {
  std::vector<std::string> out{text("latency p50 %.0f p99 %.0f max %.0f us", status.latency_p50_us,
                                    status.latency_p99_us, status.latency_max_us),
                               "clock " + clock_text(status.clock_offset_ppm)};
  const std::size_t axes = std::min(status.nis_mean.size(), status.whiteness.size());
  for (std::size_t a = 0; a < axes; ++a)
    out.push_back(std::string(axis_name(a, axes)) +
                  text(" NIS %.2f whiteness %+.2f", status.nis_mean[a], status.whiteness[a]));
  return out;
}

// Empty without any.
std::vector<std::string> counted(const std::string& when, const std::vector<SensorView::Count>& counts) {
  std::vector<std::string> out;
  out.reserve(counts.size());
  for (const SensorView::Count& each : counts)
    out.push_back((out.empty() ? when + " " : "") + std::string(each.name) + " " + n(each.count));
  return out;
}

}  // namespace

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::vector<std::string> wrapped(const std::vector<std::string>& parts, std::string_view separator,
                                 std::size_t width) {
  std::vector<std::string> out;
  for (const std::string& part : parts) {
    if (out.empty())
      out.push_back("  " + part);
    else if (width == 0 || columns_of(out.back()) + separator.size() + columns_of(part) <= width)
      out.back() += std::string(separator) + part;
    else
      out.push_back("    " + part);
  }
  return out;
}

std::vector<std::string> view_lines(std::string_view name, const SensorView& sensor, const LineStyle& style) {
  const std::size_t width = style.width == 0 ? 0 : std::max(style.width, kLeastWidth);
  std::vector<std::string> out{head_line(name, sensor)};
  const auto add = [&](const std::vector<std::string>& parts, std::string_view separator = "  ") {
    for (std::string& line : wrapped(parts, separator, width)) out.push_back(std::move(line));
  };
  if (!sensor.judged())
    out.push_back("  its first second is not over");
  else if (sensor.axes().empty())
    out.push_back("  no samples in the last second" +
                  (sensor.status() && sensor.silent_s() <= kStale_s
                       ? std::string(": ") + state_name(sensor.status()->state)
                       : ""));
  for (std::size_t a = 0; a < sensor.axes().size(); ++a) out.push_back(axis_line(sensor, a, style));
  // Each line says of when its counts are: a kind of fault may stand in both.
  add(counted("in the last second:", sensor.flags()));
  if (sensor.two_publishers())
    add({"two publishers send on this channel: two daemons, or a log that is played?"});
  if (sensor.silent_s() > kStale_s) return out;
  const auto losses = counted("so far:", sensor.losses());
  add(losses.empty() ? std::vector<std::string>{"nothing lost"} : losses);
  if (sensor.status()) {
    const status_t& status = *sensor.status();
    if (!status.fault.empty()) add({"fault: " + printable(status.fault)});
    if (!status.notice.empty()) add({"noticed: " + printable(status.notice, kLongestMessage)});
    if (style.details) {
      add(health(status));
      add(books_parts(status), " ");
      add(channels(status));
    }
  }
  return out;
}

}  // namespace ifog::tools
