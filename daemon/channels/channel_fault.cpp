// SPDX-License-Identifier: Apache-2.0
#include "daemon/channels/channel_fault.h"

#include <net/if.h>

#include <system_error>

#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

std::string of_file(const ChannelConfig& channel, const ChannelFault& fault) {
  std::string out = printable(channel.path) + ": ";
  switch (fault.kind) {
    case ChannelFault::Kind::unreadable:
      out += "cannot read: " + std::generic_category().message(fault.error);
      break;
    case ChannelFault::Kind::no_file:
      out += "is no regular file";
      break;
    case ChannelFault::Kind::empty:
      out += "is empty";
      break;
    case ChannelFault::Kind::impossible:
      return out + "holds a number that the channel cannot have";
    case ChannelFault::Kind::no_number:
      out += "holds something else";
      break;
    default:
      out += "nothing was read";
      break;
  }
  return out + ", expected a file that holds one number";
}

std::string of_lcm(const ChannelConfig& channel, const ChannelFault& fault) {
  const std::string from = "LCM channel " + in_quotes(channel.lcm_channel) + ": ";
  const std::string& field = channel.field.empty() ? channel.name : channel.field;
  switch (fault.kind) {
    case ChannelFault::Kind::no_message:
      return from + "what comes is no ifog.channel_t, ifog.rate_t or ifog.status_t";
    case ChannelFault::Kind::late:
      return from + "what comes was measured before what is held, by its utime";
    case ChannelFault::Kind::clock_behind:
      return from + "the clock that dates it is " + std::to_string(fault.error) +
             " s behind this computer's: ages are counted from the newest that has come";
    case ChannelFault::Kind::no_field:
      return from + "its messages have no " + in_quotes(field);
    case ChannelFault::Kind::impossible:
      return from + in_quotes(field) + " is a number that the channel cannot have";
    default:
      return from + "nothing comes";
  }
}

std::string of_can(const ChannelConfig& channel, const ChannelFault& fault) {
  const std::string from = "CAN interface " + in_quotes(channel.interface) + ": ";
  if (if_nametoindex(channel.interface.c_str()) == 0) return from + "is not there";
  if (fault.kind == ChannelFault::Kind::impossible)
    return from + "signal " + in_quotes(channel.signal) + " is a number that the channel cannot have";
  return from + "no frame with the signal " + in_quotes(channel.signal) + " comes";
}

}  // namespace

std::string describe(const ChannelConfig& channel, const ChannelFault& fault) {
  const std::string name = "channel " + in_quotes(channel.name);
  switch (channel.source) {
    case ChannelConfig::Source::file:
      return name + ": " + of_file(channel, fault);
    case ChannelConfig::Source::lcm:
      return name + ": " + of_lcm(channel, fault);
    case ChannelConfig::Source::can:
      return name + ": " + of_can(channel, fault);
    case ChannelConfig::Source::frame:
      break;
  }
  return name + ": the sensor's frames bring none";
}

}  // namespace ifog
