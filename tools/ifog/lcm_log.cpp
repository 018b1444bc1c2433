#include "tools/ifog/lcm_log.h"

#include <algorithm>
#include <ifog/rate_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <set>
#include <stdexcept>

namespace ifog::tools {
namespace {

bool carries_rates(const std::string& channel) {
  return channel.starts_with("IFOG_") && !channel.ends_with("_STATUS");
}

std::string chosen_channel(const std::string& path) {
  lcm::LogFile log(path, "r");
  std::set<std::string> found;
  while (const lcm::LogEvent* event = log.readNextEvent())
    if (carries_rates(event->channel)) found.insert(event->channel);
  if (found.size() == 1) return *found.begin();
  std::string list;
  for (const std::string& each : found) list += (list.empty() ? "" : ", ") + each;
  throw std::runtime_error(path + (found.empty()
                                       ? ": has no channel IFOG_<NAME>"
                                       : ": has several channels, expected --channel with one of " + list));
}

}  // namespace

Capture read_lcm_log(const std::string& path, const std::string& channel) {
  if (!lcm::LogFile(path, "r").good()) throw std::runtime_error(path + ": cannot open as an LCM log");
  const std::string wanted = channel.empty() ? chosen_channel(path) : channel;
  lcm::LogFile log(path, "r");
  Capture capture;
  std::int64_t start_ns = 0;
  std::size_t number = 0;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    ++number;
    if (event->channel != wanted) continue;
    const auto refuse = [&](const std::string& why) {
      throw std::runtime_error(path + ": message " + std::to_string(number) + " on " + wanted + " " + why);
    };
    rate_t message;
    if (message.decode(event->data, 0, event->datalen) < 0) refuse("is no ifog.rate_t of this version");
    const std::int64_t now_ns = message.sensor_time_ns >= 0 ? message.sensor_time_ns : message.utime * 1000;
    if (capture.time_s.empty()) {
      start_ns = now_ns;
      const auto axes = static_cast<std::size_t>(message.axes);
      // The message carries no names; three axes are x, y, z.
      if (axes == 1) capture.axes = {""};
      if (axes > 1) capture.axes.assign({"x", "y", "z"});
      capture.axes.resize(std::min(capture.axes.size(), axes));
      capture.rate_radps.resize(axes);
      capture.reference_rate_radps.resize(axes);
    }
    if (static_cast<std::size_t>(message.axes) != capture.axes.size()) refuse("has another number of axes");
    const double time_s = static_cast<double>(now_ns - start_ns) / 1e9;
    if (!capture.time_s.empty() && time_s <= capture.time_s.back())
      refuse("is not later than the one before");
    capture.time_s.push_back(time_s);
    for (std::size_t i = 0; i < capture.axes.size(); ++i) capture.rate_radps[i].push_back(message.raw[i]);
  }
  if (capture.time_s.empty()) throw std::runtime_error(path + ": has no message on channel " + wanted);
  return capture;
}

}  // namespace ifog::tools
