// SPDX-License-Identifier: Apache-2.0
#include "daemon/channels/channel_watch.h"

#include <net/if.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <utility>

#include "daemon/sensor/sensor_parts.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

// Delays before a faulty file is reported, for any allowed age; shorter before the first value, because the
// name may be wrong.
constexpr double kLasting_s = 10.0, kFirst_s = 2.0;

// Channels of the sensor's frames have no entry if the default age applies.
ChannelConfig of_frame(const std::string& name, const std::vector<ChannelConfig>& configured) {
  const auto found =
      std::ranges::find_if(configured, [&](const ChannelConfig& channel) { return channel.name == name; });
  if (found != configured.end()) return *found;
  ChannelConfig out;
  out.name = name;
  return out;
}

}  // namespace

ChannelWatch::ChannelWatch(const SensorConfig& sensor)
    : configured_(sensor.channels), outside_(outside_channels(sensor)), absent_(outside_.size()) {}

std::vector<std::string> ChannelWatch::absent() {
  std::vector<std::string> out;
  for (std::size_t place = 0; place < outside_.size(); ++place) {
    const ChannelConfig& channel = outside_[place];
    ChannelFault fault;
    struct stat info {};
    if (channel.source == ChannelConfig::Source::file) {
      if (stat(channel.path.c_str(), &info) != 0)
        fault = {.kind = ChannelFault::Kind::unreadable, .error = errno};
      else if (!S_ISREG(info.st_mode))
        fault.kind = ChannelFault::Kind::no_file;
    }
    absent_[place] = fault != ChannelFault{} || (channel.source == ChannelConfig::Source::can &&
                                                 if_nametoindex(channel.interface.c_str()) == 0);
    if (absent_[place]) out.push_back(describe(channel, fault) + "; the channel has no value until it comes");
  }
  return out;
}

bool ChannelWatch::is_configured(const std::string& name) const {
  return std::ranges::any_of(configured_, [&](const ChannelConfig& channel) { return channel.name == name; });
}

std::vector<ChannelWatch::News> ChannelWatch::look(const status_t& status, const ChannelTable& outside) {
  std::vector<News> out;
  // Nothing is known before the sensor's first sample.
  if (status.samples_in == 0 || status.state != status_t::STATE_RUNNING) return out;
  const std::size_t all = status.channel_name.size();
  if (seen_.empty()) {
    seen_.resize(all);
    for (std::size_t place = 0; place < outside_.size(); ++place)
      seen_[all - outside_.size() + place].reported = absent_[place];
  }
  for (std::size_t c = 0; c < all; ++c) {
    const bool from_frame = c + outside_.size() < all;
    const std::size_t place = from_frame ? 0 : c - (all - outside_.size());
    const ChannelConfig channel =
        from_frame ? of_frame(status.channel_name[c], configured_) : outside_[place];
    const ChannelFault fault = from_frame ? ChannelFault{} : outside.fault(static_cast<int>(place));
    Seen& seen = seen_[c];
    if (fault.kind == ChannelFault::Kind::clock_behind && !std::exchange(seen.behind_reported, true))
      out.push_back({false, describe(channel, fault)});
    seen.looked_s += 1.0;
    const bool faulty =
        fault.kind != ChannelFault::Kind::silent && fault.kind != ChannelFault::Kind::clock_behind;
    seen.faulty_s = faulty ? seen.faulty_s + 1.0 : 0.0;
    const double age_s = status.channel_age_s[c];
    const bool never = std::isinf(age_s);
    const bool old = !never && channel.max_age_s > 0.0 && age_s > channel.max_age_s;
    // A channel that the driver's frames may contain but do not is reported only if it is configured or a
    // correction needs it.
    const bool wanted = !from_frame || is_configured(channel.name) || status.channel_stale > 0;
    const bool awaited =
        never && wanted && seen.looked_s > (channel.max_age_s > 0.0 ? channel.max_age_s : kLasting_s);
    const bool gone = never ? seen.faulty_s >= kFirst_s
                            : channel.source == ChannelConfig::Source::file && seen.faulty_s >= kLasting_s &&
                                  age_s > kLasting_s;
    // A report is valid until a value arrives.
    const bool missing = old || awaited || gone || (never && seen.reported);
    if (missing == seen.reported) continue;
    seen.reported = missing;
    if (missing)
      out.push_back({false, describe(channel, fault) +
                                (never ? "; the channel has no value yet" : "; the last value is held")});
    else
      out.push_back({true, "channel " + in_quotes(channel.name) + " has new values"});
  }
  return out;
}

}  // namespace ifog
