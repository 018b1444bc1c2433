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

std::string dropped_in_words(const std::vector<Effect>& dropped) {
  std::string names;
  for (const Effect& effect : dropped) names += (names.empty() ? "" : ", ") + named(effect);
  return "the innovations suggest " + names + ", but a step does not last: left out";
}

std::string harmful_in_words(const Effect& effect) {
  return "the innovations suggest " + named(effect) +
         ", but by its own error bar it is chance, or the daemon's own correction by it would leave a larger "
         "error than none: left out";
}

std::string judged_beside(std::size_t harmonics) {
  if (harmonics == 0) return "";
  return "effects were judged in the noise beside " + std::to_string(harmonics) +
         (harmonics == 1 ? " resonance or line that moves" : " resonances or lines that move") +
         ", which the model of the noise knows; nothing of that is subtracted";
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
  return words + ", so that is no effect of this channel but of something that ran beside it, left out";
}

std::string unexplained_beside_claims(const Diagnosis& diagnosis, std::size_t captures) {
  const auto traced = [](const FoundEffect& found) { return !found.effect.channel.empty(); };
  if (diagnosis.unexplained.fraction <= kMuch ||
      std::none_of(diagnosis.effects.begin(), diagnosis.effects.end(), traced))
    return "";
  const std::string share = printed(
      "beside what was traced %.0f %% of the error is unexplained: what was not logged may be the cause of "
      "both, and a channel named here only run along with it",
      100.0 * diagnosis.unexplained.fraction);
  return share + (captures < 2 ? ". Take a second capture in which the channels run otherwise, and give both"
                               : ". The coefficients are compared between the captures given");
}

}  // namespace ifog
