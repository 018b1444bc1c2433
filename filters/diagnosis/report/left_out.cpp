// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/left_out.h"

#include <cmath>
#include <cstdio>

namespace ifog {
namespace {

std::string in_words(const Effect& effect) {
  return effect.form + (effect.channel.empty() ? "" : " of " + effect.channel);
}

}  // namespace

std::string dropped_in_words(const std::vector<Effect>& dropped) {
  std::string names;
  for (const Effect& effect : dropped) names += (names.empty() ? "" : ", ") + in_words(effect);
  return "the innovations suggest " + names +
         ", but a step does not last or the error on held-out data would grow: left out";
}

std::string harmful_in_words(const Effect& effect) {
  return "the innovations suggest " + in_words(effect) +
         ", but by its own error bar it is chance, or the daemon's own correction by it would leave a larger "
         "error than none: left out";
}

std::string judged_beside(std::size_t harmonics) {
  if (harmonics == 0) return "";
  return "effects were judged in the noise beside " + std::to_string(harmonics) +
         (harmonics == 1 ? " resonance or line that moves" : " resonances or lines that move") +
         ", which the model of the noise knows; nothing of that is subtracted";
}

}  // namespace ifog
