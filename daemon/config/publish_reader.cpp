// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <string>

#include "daemon/config/reading_context.h"
#include "drivers/ifog/quoted.h"
#include "msgs/channel_name.h"

namespace ifog {
namespace {

constexpr std::size_t kLongest = 63;  // LCM_MAX_CHANNEL_NAME_LENGTH

}  // namespace

PublishedType read_publish(const toml::table& table, ReadingContext& context) {
  TableReader in(table, "sensor.publish", context.file, context.errors);
  PublishedType out;
  take(in.required_choice("type", {kInsType.data(), kMicrostrainType.data(), kKvhBatchType.data(),
                                   kInertialType.data(), kImuType.data()}),
       out.type);
  out.channel = in.required_text("channel", "the name of an LCM channel");
  if (out.channel.size() > kLongest || out.channel != printable(out.channel))
    in.complain("channel", " = " + in_quotes(out.channel) + ": expected at most " + std::to_string(kLongest) +
                               " printable characters");
  else if (out.channel.starts_with(kChannelPrefix))
    in.complain("channel",
                " = " + in_quotes(out.channel) +
                    ": expected a name that does not begin with IFOG_, which is for the daemon's own");
  in.refuse_the_rest();
  return out;
}

}  // namespace ifog
