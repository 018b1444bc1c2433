// SPDX-License-Identifier: Apache-2.0
#include "daemon/channels/channel_watch.h"

#include <net/if.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <system_error>
#include <utility>

#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

using Kind = ChannelFault::Kind;
using Source = ChannelConfig::Source;

// Delays before a faulty file is reported, for any allowed age; shorter before the first value, because the
// name may be wrong.
constexpr double kLasting_s = 10.0, kFirst_s = 2.0;

bool is_absent_bus(const ChannelConfig& channel) {
  return channel.source == Source::can && if_nametoindex(channel.interface.c_str()) == 0;
}

std::string source_in_words(const ChannelConfig& channel) {
  if (channel.source == Source::file) return printable(channel.path, kLongestMessage);
  if (channel.source == Source::lcm) return "LCM channel " + in_quotes(channel.lcm_channel);
  return "CAN interface " + in_quotes(channel.interface);
}

std::string fault_in_words(const ChannelConfig& channel, const ChannelFault& fault) {
  const std::string expected = ", expected a file that holds one number";
  const std::string value = channel.source == Source::can
                                ? "signal " + in_quotes(channel.signal)
                                : in_quotes(channel.field.empty() ? channel.name : channel.field);
  if (is_absent_bus(channel)) return "is not there";
  switch (fault.kind) {
    case Kind::unreadable:
      return "cannot read: " + std::generic_category().message(fault.error) + expected;
    case Kind::no_file:
      return "is no regular file" + expected;
    case Kind::empty:
      return "is empty" + expected;
    case Kind::no_number:
      return "holds something else" + expected;
    case Kind::no_message:
      return "what comes is no ifog.channel_t, ifog.rate_t or ifog.status_t";
    case Kind::no_field:
      return "its messages have no " + value;
    case Kind::late:
      return "what comes was measured before what is held, by its utime";
    case Kind::clock_behind:
      return "the clock that dates it is " + std::to_string(fault.error) +
             " s behind this computer's: ages are counted from the newest that has come";
    case Kind::impossible:
      return (channel.source == Source::file ? "holds" : value + " is") +
             " a number that the channel cannot have";
    case Kind::silent:
      break;
  }
  if (channel.source == Source::file) return "nothing was read" + expected;
  return channel.source == Source::lcm ? "nothing comes" : "no frame with the " + value + " comes";
}

}  // namespace

std::string describe(const ChannelConfig& channel, const ChannelFault& fault) {
  const std::string name = "channel " + in_quotes(channel.name) + ": ";
  if (channel.source == Source::frame) return name + "the sensor's frames bring none";
  return name + source_in_words(channel) + ": " + fault_in_words(channel, fault);
}

ChannelWatch::ChannelWatch(const SensorConfig& sensor, const std::vector<std::string>& channels) {
  for (const std::string& name : channels) {
    Watched& watched = channels_.emplace_back();
    watched.config.name = name;
    for (const ChannelConfig& each : sensor.channels)
      if (each.name == name) watched = {.config = each, .configured = true};
  }
}

std::vector<std::string> ChannelWatch::absent() {
  std::vector<std::string> out;
  for (Watched& watched : channels_) {
    ChannelFault fault;
    struct stat info {};
    if (watched.config.source == Source::file) {
      if (stat(watched.config.path.c_str(), &info) != 0)
        fault = {.kind = Kind::unreadable, .error = errno};
      else if (!S_ISREG(info.st_mode))
        fault.kind = Kind::no_file;
    }
    watched.reported = fault != ChannelFault{} || is_absent_bus(watched.config);
    if (watched.reported)
      out.push_back(describe(watched.config, fault) + "; the channel has no value until it comes");
  }
  return out;
}

std::vector<ChannelWatch::News> ChannelWatch::look(const status_t& status, const ChannelTable& outside) {
  std::vector<News> out;
  // Nothing is known before the sensor's first sample.
  if (status.samples_in == 0 || status.state != status_t::STATE_RUNNING) return out;
  int place = 0;  // among those from outside
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    Watched& seen = channels_[c];
    const ChannelConfig& channel = seen.config;
    const ChannelFault fault = channel.source == Source::frame ? ChannelFault{} : outside.fault(place++);
    if (fault.kind == Kind::clock_behind && !std::exchange(seen.behind_reported, true))
      out.push_back({false, describe(channel, fault)});
    seen.looked_s += 1.0;
    const bool faulty = fault.kind != Kind::silent && fault.kind != Kind::clock_behind;
    seen.faulty_s = faulty ? seen.faulty_s + 1.0 : 0.0;
    const double age_s = status.channel_age_s[c];
    const bool never = std::isinf(age_s);
    const bool old = !never && channel.max_age_s > 0.0 && age_s > channel.max_age_s;
    // A channel that the driver's frames may contain but do not is reported only if it is configured or a
    // correction needs it.
    const bool wanted = seen.configured || status.channel_stale > 0;
    const bool awaited =
        never && wanted && seen.looked_s > (channel.max_age_s > 0.0 ? channel.max_age_s : kLasting_s);
    const bool gone =
        never ? seen.faulty_s >= kFirst_s
              : channel.source == Source::file && seen.faulty_s >= kLasting_s && age_s > kLasting_s;
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
