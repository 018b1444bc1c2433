// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/monitor/sensor_view.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "filters/units/field_units.h"
#include "msgs/axis_name.h"
#include "msgs/counters.h"
#include "msgs/state_name.h"
#include "tools/ifog/field/status_text.h"
#include "tools/report/text.h"

namespace ifog::tools {
namespace {

double deviation(const Moments& of) {
  return of.count() < 2.0 ? std::numeric_limits<double>::quiet_NaN() : of.deviation();
}

constexpr std::size_t kLeastWidth = 40;

// A line of block characters with eight heights, scaled from the least to the greatest value.
struct SparkLine {
  std::string text;
  double span;  // greatest minus least value; NaN without values
};

// The last `width` of `values`; a blank for NaN.
SparkLine spark_line(const std::vector<double>& values, std::size_t width) {
  constexpr std::array<const char*, 8> kHeights{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const std::size_t skip = values.size() > width ? values.size() - width : 0;
  double least = std::numeric_limits<double>::quiet_NaN(), greatest = least;
  for (std::size_t i = skip; i < values.size(); ++i)
    if (std::isfinite(values[i])) {
      least = std::fmin(least, values[i]);
      greatest = std::fmax(greatest, values[i]);
    }
  std::string out;
  for (std::size_t i = skip; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      out += ' ';
      continue;
    }
    const double part = greatest > least ? (values[i] - least) / (greatest - least) : 0.5;
    out += kHeights[std::min<std::size_t>(7, static_cast<std::size_t>(part * 8.0))];
  }
  return {out, greatest - least};
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

// An error above 10 % is not the clock's: a recording is played at another speed.
std::string clock_text(double offset_ppm) {
  return std::abs(offset_ppm) > 1e5 ? "not in real time" : fmt::format("{:+.0f} ppm", offset_ppm);
}

std::string axis_line(const SensorView& sensor, std::size_t a, const LineStyle& style) {
  const AxisView& axis = sensor.axes()[a];
  const Unit unit = unit_for(axis.rate_radps, style.unit);
  const auto number = [&](double radps) -> std::string {
    return std::isfinite(radps) ? fmt::format("{:.{}f}", radps / unit.radps, unit.decimals) : "-";
  };
  const auto with_sign = [&](double radps) -> std::string {
    return std::isfinite(radps) ? fmt::format("{:+.{}f}", radps / unit.radps, unit.decimals) : "-";
  };
  const std::string rate = "  " + std::string(axis_name(a, sensor.axes().size())) + "  " +
                           with_sign(axis.rate_radps) + " " + unit.name,
                    noise = "  noise " + number(axis.noise_radps),
                    raw = " (raw " + number(axis.raw_noise_radps) + ")",
                    angle = fmt::format("  angle {:+.6f}°", axis.angle_rad / kDegree);
  if (!std::isfinite(axis.rate_radps) && axis.angle_rad == 0.0)
    return "  " + std::string(axis_name(a, sensor.axes().size())) + "  not measured";
  // If there is not enough space, the least important parts are dropped first.
  std::string out = rate + noise + raw + angle;
  if (style.width != 0 && report::characters_in(out) > style.width) out = rate + noise + angle;
  if (style.width != 0 && report::characters_in(out) > style.width) out = rate + angle;
  constexpr std::size_t kMostSpark = 60, kLeastSpark = 4;
  if (style.width == 0) return out;
  // Height of the line in the rate's unit.
  const auto scale = [&](const SparkLine& line) { return "  span " + number(line.span); };
  const std::size_t used = report::characters_in(out) + 2;
  if (used + kLeastSpark > style.width) return out;
  const std::size_t room = std::min(kMostSpark, style.width - used);
  std::vector<double> rates;
  for (const SensorView::Second& each : sensor.history(a)) rates.push_back(each.rate_radps);
  const SparkLine whole = spark_line(rates, room);
  const std::size_t for_scale = report::characters_in(scale(whole));
  if (!std::isfinite(whole.span) || used + for_scale + kLeastSpark > style.width)
    return out + "  " + whole.text;
  const SparkLine line = spark_line(rates, std::min(room, style.width - used - for_scale));
  return out + "  " + line.text + scale(line);
}

// By name and date if its file is here, otherwise by its identity.
std::string model_text(const std::string& identity, const KnownSensor* known) {
  if (identity.empty()) return "";
  if (known != nullptr && known->identity == identity) return "  model " + known->model;
  return "  model " + printable(identity) +
         (known != nullptr && !known->identity.empty() ? ", not what " + known->model + " holds" : "");
}

std::string head_line(std::string_view name, const SensorView& sensor, const KnownSensor* known) {
  std::string out = printable(name);
  if (sensor.silent())
    out += fmt::format("  no message for {:.0f} s: has ifogd ended?", sensor.silent_s());
  else if (sensor.live_status() != nullptr)
    out += std::string("  ") + state_name(sensor.live_status()->state);
  else if (sensor.status_age_s() > SensorView::kStale_s)
    out += fmt::format("  no status for {:.0f} s", sensor.status_age_s());
  if (sensor.judged()) out += "  " + in_hertz(sensor.message_rate_hz());
  out += fmt::format("  {} messages", sensor.messages());
  return out + (sensor.silent() ? "" : model_text(sensor.model(), known));
}

// Environment channels by name; with age if not fresh. Omits those of the driver that never had a value.
std::vector<std::string> channels(const status_t& status, const KnownSensor* known) {
  constexpr double kFresh_s = 2.0;
  std::vector<std::string> out;
  for (std::size_t i = 0; i < status.channel_name.size(); ++i) {
    const double age_s = status.channel_age_s[i];
    if (!std::isfinite(age_s) && (known == nullptr || !known->channels.contains(status.channel_name[i])))
      continue;
    std::string value = !std::isfinite(age_s) ? "no value" : fmt::format("{:.6g}", status.channel_value[i]);
    if (std::isfinite(age_s) && age_s > kFresh_s) value += fmt::format(" ({:.0f} s old)", age_s);
    out.push_back(printable(status.channel_name[i]) + " " + value);
  }
  return out;
}

std::vector<std::string> health(const status_t& status) {
  std::vector<std::string> out;
  // Samples from a file have no latency, and an axis without values has no mean square.
  if (status.latency_max_us > 0.0)
    out.push_back(fmt::format("latency p50 {:.0f} p99 {:.0f} max {:.0f} us", status.latency_p50_us,
                              status.latency_p99_us, status.latency_max_us));
  out.push_back("clock " + clock_text(status.clock_offset_ppm));
  const std::size_t axes = std::min(status.nis_mean.size(), status.whiteness.size());
  for (std::size_t a = 0; a < axes; ++a)
    if (status.nis_mean[a] != 0.0)
      out.push_back(std::string(axis_name(a, axes)) +
                    fmt::format(" NIS {:.2f} whiteness {:+.2f}", status.nis_mean[a], status.whiteness[a]));
  return out;
}

// Empty if there are none.
std::vector<std::string> counted(const std::string& when, const std::vector<SensorView::Count>& counts) {
  std::vector<std::string> out;
  out.reserve(counts.size());
  for (const SensorView::Count& each : counts)
    out.push_back((out.empty() ? when + " " : "") + std::string(each.name) + " " + n(each.count));
  return out;
}

}  // namespace

void SensorView::take(const rate_t& message) {
  ++messages_;
  ++in_interval_;
  received_ = true;
  model_ = message.model;
  way_.take(message);
  for (std::size_t i = 0; i < kFlagNames.size(); ++i)
    if ((message.flags & kFlagNames[i].flag) != 0) ++flagged_[i];
  sums_.resize(static_cast<std::size_t>(message.axes));
  history_.resize(sums_.size());
  if (axes_.size() > sums_.size()) axes_.clear();
  for (std::size_t a = 0; a < sums_.size(); ++a) {
    Sums& sums = sums_[a];
    sums.denoised.add(message.denoised[a]);
    sums.raw.add(message.raw[a]);
    sums.raw_low = std::fmin(sums.raw_low, message.raw[a]);  // ignores NaN
    sums.raw_high = std::fmax(sums.raw_high, message.raw[a]);
    sums.angle = message.angle[a];
  }
}

void SensorView::take(status_t message) {
  status_.message = std::move(message);
  received_ = status_.received = true;
  status_.age_s = 0.0;
}

void SensorView::end_interval(double seconds) {
  rate_hz_ = static_cast<double>(in_interval_) / seconds;
  judged_ = true;
  shown_ = shown_ || in_interval_ > 0 || status_.message;
  silent_s_ = std::exchange(received_, false) ? 0.0 : silent_s_ + seconds;
  status_.age_s = std::exchange(status_.received, false) ? 0.0 : status_.age_s + seconds;
  flagged_before_ = std::exchange(flagged_, {});
  axes_.clear();
  for (std::size_t a = 0; a < sums_.size(); ++a) {
    const Sums sums = std::exchange(sums_[a], {});
    const double rate_radps = sums.denoised.mean();
    if (in_interval_ > 0)
      axes_.push_back({rate_radps, deviation(sums.denoised), deviation(sums.raw), sums.angle});
    history_[a].push_back({sums.raw_low, sums.raw_high, rate_radps});
    if (history_[a].size() > kRemembered) history_[a].pop_front();
  }
  in_interval_ = 0;
}

std::vector<SensorView::Count> SensorView::flags() const {
  std::vector<Count> out;
  for (std::size_t i = 0; i < kFlagNames.size(); ++i)
    if (flagged_before_[i] > 0) out.push_back({kFlagNames[i].name, flagged_before_[i]});
  return out;
}

std::vector<SensorView::Count> SensorView::all_losses() const {
  const status_t s = status_.message.value_or(status_t{});
  std::vector<Count> out{{"lost on LCM", way_.lost()}};
  for (const StatusCounter& each : kStatusCounters)
    if (*each.loss != '\0') out.push_back({each.loss, s.*each.count});
  return out;
}

std::vector<SensorView::Count> SensorView::losses() const {
  std::vector<Count> out = all_losses();
  for (std::size_t i = 0; i < forgotten_.size(); ++i) {
    // A restarted daemon counts from 0.
    if (out[i].count >= forgotten_[i]) out[i].count -= forgotten_[i];
  }
  std::erase_if(out, [](const Count& each) { return each.count == 0; });
  return out;
}

void SensorView::forget_losses() {
  forgotten_.clear();
  for (const Count& each : all_losses()) forgotten_.push_back(each.count);
}

std::vector<std::string> wrapped(const std::vector<std::string>& parts, std::string_view separator,
                                 std::size_t width) {
  std::vector<std::string> out;
  for (const std::string& part : parts) {
    if (out.empty())
      out.push_back("  " + part);
    else if (width == 0 ||
             report::characters_in(out.back()) + separator.size() + report::characters_in(part) <= width)
      out.back() += std::string(separator) + part;
    else
      out.push_back("    " + part);
  }
  return out;
}

const char* tone_name(Tone tone) {
  constexpr std::array kNames{"plain", "figure", "good", "warning", "bad"};
  return kNames[static_cast<std::size_t>(tone)];
}

Tone tone_of(const SensorView& sensor) {
  const status_t* const status = sensor.live_status();
  if (sensor.silent() || sensor.two_publishers()) return Tone::bad;
  if (status == nullptr) return sensor.judged() ? Tone::warning : Tone::plain;
  if (status->state == status_t::STATE_RUNNING) return status->fault.empty() ? Tone::good : Tone::warning;
  return status->state == status_t::STATE_FAILED ? Tone::bad : Tone::warning;
}

std::vector<ShownLine> view_lines(std::string_view name, const SensorView& sensor, const LineStyle& style,
                                  const KnownSensor* known) {
  const std::size_t width = style.width == 0 ? 0 : std::max(style.width, kLeastWidth);
  const status_t* const status = sensor.live_status();
  std::vector<ShownLine> out{{head_line(name, sensor, known), tone_of(sensor)}};
  const auto add = [&](const std::vector<std::string>& parts, Tone tone = Tone::plain,
                       std::string_view separator = "  ") {
    for (std::string& line : wrapped(parts, separator, width)) out.push_back({std::move(line), tone});
  };
  if (!sensor.judged())
    out.push_back({"  its first second is not over"});
  else if (sensor.axes().empty())
    out.push_back({"  no samples in the last second" +
                       (status != nullptr ? std::string(": ") + state_name(status->state) : ""),
                   Tone::warning});
  for (std::size_t a = 0; a < sensor.axes().size(); ++a)
    out.push_back({axis_line(sensor, a, style), Tone::figure});
  // The same kind of fault may be in both lines; each line names its time.
  add(counted("in the last second:", sensor.flags()));
  if (sensor.two_publishers())
    add({"two publishers send on this channel: two daemons, or a log that is played?"}, Tone::bad);
  if (sensor.silent()) return out;
  const auto losses = counted("so far:", sensor.losses());
  // Without a recent status, zero losses are not certain.
  if (!losses.empty() || status != nullptr || sensor.status_age_s() <= SensorView::kStale_s)
    add(losses.empty() ? std::vector<std::string>{"nothing lost"} : losses,
        losses.empty() ? Tone::good : Tone::warning);
  if (known != nullptr && !known->proposal.empty()) add({known->proposal}, Tone::warning);
  if (known != nullptr && style.details) add({"driver " + known->driver});
  if (status == nullptr) return out;
  if (!status->fault.empty()) add({"fault: " + printable(status->fault, kLongestMessage)}, Tone::bad);
  if (!status->notice.empty()) add({"noticed: " + printable(status->notice, kLongestMessage)}, Tone::warning);
  if (!style.details) return out;
  add(health(*status));
  add(books_parts(*status), Tone::plain, " ");
  add(channels(*status, known));
  return out;
}

}  // namespace ifog::tools
