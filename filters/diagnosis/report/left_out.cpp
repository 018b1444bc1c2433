// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/left_out.h"

#include <array>
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
         ", but a few knocks or a change of the noise make it seem so, it is not the same "
         "all along the record, or the error on held-out data would grow: left out";
}

std::string harmful_in_words(const Effect& effect) {
  return "the innovations suggest " + in_words(effect) +
         ", but the daemon's own correction by it would leave a larger error than none: left out";
}

std::string judged_beside(std::size_t harmonics) {
  if (harmonics == 0) return "";
  return "effects were judged in the noise beside " + std::to_string(harmonics) +
         (harmonics == 1 ? " resonance or line that moves" : " resonances or lines that move") +
         ", which the model of the noise knows; nothing of that is subtracted";
}

std::string delay_in_words(const ChannelDelay& delay) {
  std::array<char, 64> by{};
  std::snprintf(by.data(), by.size(), delay.delay_s < 0.0 ? "%.3g s later (+-%.2g)" : "%.3g s late (+-%.2g)",
                std::abs(delay.delay_s), delay.std_error_s);
  if (delay.delay_s < 0.0)
    return "what " + delay.channel + " says acts " + by.data() +
           ", as of a channel that is logged early: the model says so, and the daemon waits as long with it";
  return delay.channel + " logged " + by.data() +
         ": its effects were sought as if it were not. The daemon has it no sooner, so the correction that "
         "is "
         "written and judged is late by as much";
}

}  // namespace ifog
