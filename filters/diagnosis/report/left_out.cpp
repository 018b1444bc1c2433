// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/report.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/effects/meaning.h"
#include "filters/model_file/form.h"
#include "filters/rest/rest.h"
#include "filters/units/field_units.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr double kMuch = 0.12;  // of the error's variance

bool has_a_value(const std::vector<Record>& records, const std::string& name) {
  return std::ranges::any_of(records, [&](const Record& record) {
    return std::ranges::any_of(values_of(record, name), [](double value) { return std::isfinite(value); });
  });
}

}  // namespace

std::string harmful_in_words(const Effect& effect, bool by_chance) {
  return "the innovations suggest " + name_of(effect) +
         (by_chance
              ? ", but by its own error bar it is chance: not used"
              : ", but the daemon's own correction by it would leave a larger error than none: not used");
}

std::string denied_in_words(const std::vector<Effect>& effects, const DeniedEffects& denied,
                            const std::vector<Record>& records) {
  std::string words;
  for (const Effect& effect : effects) words += (words.empty() ? "" : " and ") + name_of(effect);
  words += std::isfinite(denied.share)
               ? formatted(": of what the other captures predict %.2g ± %.2g is there in ", denied.share,
                           denied.share_error) +
                     records[denied.record].name
               : ": nothing of it is seen in " + records[denied.record].name + ", where as much moved";
  return words + ", so that is no effect of this channel but of something that ran with it, dropped";
}

std::string unexplained_despite_claims(const Diagnosis& diagnosis, std::size_t captures) {
  const auto traced = [](const FoundEffect& found) { return !found.effect.channel.empty(); };
  if (diagnosis.unexplained.fraction <= kMuch || std::ranges::none_of(diagnosis.effects, traced)) return "";
  const std::string share = formatted(
      "besides what was traced %.0f %% of the error is unexplained: what was not logged may be the cause of "
      "both, and a channel named here only run along with it",
      100.0 * diagnosis.unexplained.fraction);
  return share + (captures < 2 ? ". Take a second capture in which the channels run otherwise, and give both"
                               : ". The coefficients are compared between the captures given");
}

std::string far_zeros_in_words(const Diagnosis& diagnosis) {
  if (!diagnosis.bias) return "";
  std::string list;
  for (const ChannelRange& range : diagnosis.ranges) {
    const double zero = reference_of(range.channel);
    const bool counts_from_it = std::ranges::any_of(diagnosis.effects, [&](const FoundEffect& found) {
      const Form form = form_named(found.effect.form).value_or(Form::kLine);
      return (found.effect.channel == range.channel || found.effect.with_channel == range.channel) &&
             (power_of(form) > 0 || form == Form::kLagged || form == Form::kProduct);
    });
    if (!counts_from_it || is_reference_rate(range.channel) || (range.low <= zero && zero <= range.high))
      continue;
    list += (list.empty() ? "" : " and ") +
            formatted("%s = %g (here %.4g to %.4g)", range.channel.c_str(), zero, range.low, range.high);
  }
  return list.empty() ? ""
                      : "bias and scale factor are those at " + list +
                            ": with the terms of that channel they are right here, alone they are not";
}

void refuse_other_unit(const Diagnosis& diagnosis) {
  constexpr double kNear = 0.1;
  for (const FoundEffect& found : diagnosis.effects) {
    if (found.effect.form != "linear" || !is_reference_rate(found.effect.channel)) continue;
    const double times = 1.0 + found.effect.parameters.front().value;
    for (const auto& [expected, why] : std::initializer_list<std::pair<double, const char*>>{
             {-1.0, "is of reversed sign (--column NAME=HEADER:-1UNIT turns it)"},
             {kDegree, "is in degrees"},
             {1.0 / kDegree, "is in radians"}})
      if (std::abs(times / expected - 1.0) < kNear)
        throw std::invalid_argument(formatted("the rate is %.4g times %s, expected about 1: the reference %s",
                                              times, found.effect.channel.c_str(), why));
  }
}

std::string unlike_reference_in_words(const std::vector<Record>& records,
                                      const std::vector<EvenError>& errors, double sample_s) {
  constexpr double kMost = 0.05, kMeans_s = 1.0;
  const auto many = std::max<std::size_t>(1, static_cast<std::size_t>(kMeans_s / sample_s));
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Record& record = records[r];
    if (record.reference_radps.empty()) continue;
    const Samples rate = on_even_grid(record, sample_s, record.rate_radps);
    const double share =
        variance_of(means_over(*errors[r].after, many)) / variance_of(means_over(rate, many));
    const auto turns = [&](std::span<const double> signal) {
      return find_rest(std::span(&signal, 1), {}, sample_s).turned > 0;
    };
    if (share > kMost && (turns(rate) || turns(on_even_grid(record, sample_s, record.reference_radps))))
      return formatted(
          "%s: %.0f %% of the variance of the rate's 1 s means is not the reference's: is it of this axis, "
          "and of the same time?",
          record.name.c_str(), 100.0 * share);
  }
  return "";
}

std::string unused_channels(const std::vector<Record>& records, const BlockData& data,
                            const std::vector<FoundEffect>& ramps) {
  std::map<std::string, std::string> names;  // by reason
  std::set<std::string> seen;
  for (const FoundEffect& ramp : ramps) seen.insert(ramp.effect.channel);
  for (const Record& record : records) {
    for (const RecordChannel& channel : record.channels) {
      if (!seen.insert(channel.name).second) continue;
      const auto used = std::ranges::find(data.channels, channel.name, &FineChannel::name);
      const char* why = used == data.channels.end()           ? "not in every capture"
                        : !has_a_value(records, channel.name) ? "without a value"
                                                              : "never changing";
      if (used != data.channels.end() && used->varies) continue;
      std::string& list = names[why];
      list += (list.empty() ? "" : ", ") + channel.name;
    }
  }
  std::string sentence;
  for (const auto& [why, list] : names) sentence += (sentence.empty() ? "" : "; ") + list + " (" + why + ")";
  return sentence.empty() ? sentence : "channels that say nothing here and were dropped: " + sentence;
}

}  // namespace ifog
