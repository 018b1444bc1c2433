// SPDX-License-Identifier: Apache-2.0
// How a compensator begins, begins anew, and goes on with what one before it has held.

#include "filters/effects/compensator.h"

namespace ifog {

void Compensator::begin(double since_power_up_s) noexcept {
  for (Term& term : terms_)
    for (Factor& factor : term.factors) factor.shape.begin(since_power_up_s);
}

void Compensator::restart() noexcept {
  for (Held& held : held_) held = {};
  for (Term& term : terms_) {
    for (Factor& factor : term.factors) {
      factor.shape.restart();
      factor.readings = {};
      factor.difference.reset();
    }
  }
  for (Ramp& ramp : ramps_) ramp.tracker.restart();
}

void Compensator::take_over(const Compensator& previous) noexcept {
  for (Ramp& ramp : ramps_) {
    for (const Ramp& other : previous.ramps_)
      if (ramp.axis == other.axis && ramp.tracker.take_over(other.tracker)) break;
  }
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    for (std::size_t j = 0; j < previous.channels_.size(); ++j) {
      if (channels_[i] != previous.channels_[j] || !previous.held_[j].seen) continue;
      held_[i].seen = true;
      held_[i].value = previous.held_[j].value;
      held_[i].readings = previous.held_[j].readings;
      held_[i].reach = reach_of(held_[i].value, ranges_[i]);
    }
  }
  const auto same = [&](std::size_t mine, std::size_t other) {
    if (mine == kNone || other == kNone) return mine == other;
    return channels_[mine] == previous.channels_[other];
  };
  for (Term& term : terms_) {
    for (Factor& factor : term.factors) {
      for (const Term& old : previous.terms_) {
        for (const Factor& other : old.factors) {
          if (!same(factor.channel, other.channel) || !same(factor.less, other.less)) continue;
          factor.shape.take_over(other.shape);
          if (factor.less == kNone) continue;
          factor.readings = other.readings;
          factor.difference = other.difference;
        }
      }
    }
  }
}

}  // namespace ifog
