// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/channels/unused_channels.h"

#include <algorithm>
#include <cmath>

namespace ifog {
namespace {

bool has_a_value(const std::vector<Record>& records, const std::string& name) {
  return std::any_of(records.begin(), records.end(), [&](const Record& record) {
    return std::any_of(record.channels.begin(), record.channels.end(), [&](const RecordChannel& channel) {
      return channel.name == name && std::any_of(channel.values.begin(), channel.values.end(),
                                                 [](double value) { return std::isfinite(value); });
    });
  });
}

void append(std::string& list, const std::string& name) { list += (list.empty() ? "" : ", ") + name; }

}  // namespace

std::string unused_channels(const std::vector<Record>& records, const BlockData& data,
                            const std::vector<std::string>& ramps) {
  std::string missing;
  std::string empty;
  std::string constant;
  std::vector<std::string> seen = ramps;
  for (const Record& record : records) {
    for (const RecordChannel& channel : record.channels) {
      if (std::find(seen.begin(), seen.end(), channel.name) != seen.end()) continue;
      seen.push_back(channel.name);
      const auto used = std::find_if(data.channels.begin(), data.channels.end(),
                                     [&](const FineChannel& each) { return each.name == channel.name; });
      if (used == data.channels.end())
        append(missing, channel.name);
      else if (!has_a_value(records, channel.name))
        append(empty, channel.name);
      else if (!used->varies)
        append(constant, channel.name);
    }
  }
  std::string sentence;
  for (const auto& [names, why] :
       {std::pair{&missing, "not in every capture"}, std::pair{&empty, "without a value"},
        std::pair{&constant, "never changing"}}) {
    if (!names->empty()) sentence += (sentence.empty() ? "" : "; ") + *names + " (" + why + ")";
  }
  return sentence.empty() ? sentence : "channels that say nothing here and were left out: " + sentence;
}

}  // namespace ifog
