// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/left_out.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/record/words.h"

namespace ifog {
namespace {

constexpr double kMuch = 0.12;  // of the error's variance

std::string named(const Effect& effect) {
  return effect.form + (effect.channel.empty() ? "" : " of " + effect.channel) +
         (effect.with_channel.empty() ? "" : " with " + effect.with_channel);
}

}  // namespace

std::string harmful_in_words(const Effect& effect) {
  return "the innovations suggest " + named(effect) +
         ", but by its own error bar it is chance, or the daemon's own correction by it would leave a larger "
         "error than none: left out";
}

std::string denied_in_words(const std::vector<Effect>& effects, const DeniedEffects& denied,
                            const std::vector<Record>& records) {
  std::string words;
  for (const Effect& effect : effects) words += (words.empty() ? "" : " and ") + named(effect);
  words += std::isfinite(denied.share)
               ? printed(": of what the other captures predict %.2g ± %.2g is there in ", denied.share,
                         denied.share_error) +
                     records[denied.record].name
               : ": nothing of it is seen in " + records[denied.record].name + ", where as much moved";
  return words + ", so that is no effect of this channel but of something that ran with it, dropped";
}

std::string unexplained_beside_claims(const Diagnosis& diagnosis, std::size_t captures) {
  const auto traced = [](const FoundEffect& found) { return !found.effect.channel.empty(); };
  if (diagnosis.unexplained.fraction <= kMuch ||
      std::none_of(diagnosis.effects.begin(), diagnosis.effects.end(), traced))
    return "";
  const std::string share = printed(
      "besides what was traced %.0f %% of the error is unexplained: what was not logged may be the cause of "
      "both, and a channel named here only run along with it",
      100.0 * diagnosis.unexplained.fraction);
  return share + (captures < 2 ? ". Take a second capture in which the channels run otherwise, and give both"
                               : ". The coefficients are compared between the captures given");
}

namespace {

bool has_a_value(const std::vector<Record>& records, const std::string& name) {
  return std::ranges::any_of(records, [&](const Record& record) {
    return std::ranges::any_of(values_of(record, name), [](double value) { return std::isfinite(value); });
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
  return sentence.empty() ? sentence : "channels that say nothing here and were dropped: " + sentence;
}

}  // namespace ifog
