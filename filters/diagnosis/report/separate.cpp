// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/separate.h"

#include "filters/diagnosis/record/words.h"
#include "filters/effects/meaning.h"

namespace ifog {
namespace {

std::string seconds(double value) { return printed("%.3g s", value); }

}  // namespace

std::string capture_that_separates(const BlockData& data, const Candidate& one, const Candidate& other) {
  const bool timed = one.channel == Candidate::kNone || other.channel == Candidate::kNone;
  const std::size_t channel = one.channel == Candidate::kNone ? other.channel : one.channel;
  const std::string name = channel == Candidate::kNone ? "" : data.channels[channel].name;
  if (timed && !name.empty()) {
    return "a capture in which " + name +
           " goes up and comes down again, so that it does not run with the time";
  }
  if (timed) return "a longer capture, started from cold";
  if (one.channel != other.channel) {
    return "a capture in which " + data.channels[one.channel].name + " changes while " +
           data.channels[other.channel].name + " stays";
  }
  const bool memory = has_memory(one.form) || has_memory(other.form);
  if (memory) {
    const double tau = std::max(one.time_constant_s, other.time_constant_s);
    return "a capture in which " + name + " changes and then rests for several times " + seconds(tau) +
           ", at different speeds";
  }
  const double reference = reference_of(name);
  return "a capture over a wider range of " + name + ", on both sides of " +
         std::to_string(static_cast<int>(reference)) + " " + unit_of(name);
}

}  // namespace ifog
