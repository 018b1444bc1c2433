// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/hidden_causes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "filters/effects/meaning.h"

namespace ifog {
namespace {

constexpr double kMuch = 0.12;  // of the error's variance

template <class... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 400> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  return line.data();
}

std::string named(const Effect& effect) {
  return effect.form + " of " + effect.channel +
         (effect.with_channel.empty() ? "" : " with " + effect.with_channel);
}

}  // namespace

std::string denied_in_words(const std::vector<Effect>& effects, const DeniedEffects& denied,
                            const std::vector<Record>& records) {
  std::string words;
  for (const Effect& effect : effects) words += (words.empty() ? "" : " and ") + named(effect);
  words += std::isfinite(denied.share)
               ? text(": of what the other captures predict %.2g ± %.2g is there in ", denied.share,
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
  const std::string share = text(
      "beside what was traced %.0f %% of the error is unexplained: what was not logged may be the cause of "
      "both, and a channel named here only run along with it",
      100.0 * diagnosis.unexplained.fraction);
  return share + (captures < 2 ? ". Take a second capture in which the channels run otherwise, and give both"
                               : ". The coefficients are compared between the captures given");
}

}  // namespace ifog
