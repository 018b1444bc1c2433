// SPDX-License-Identifier: Apache-2.0
// How well the filter does by its own innovations, and what is done when it is lost.
#include <algorithm>
#include <cmath>

#include "filters/estimator/engine.h"

namespace ifog {
namespace {

// Average of what is graded, in samples.
constexpr double kHealthMemory = 512.0;
// Lost: more than half of the innovations in that memory beyond three of the sigmas the rule gives them,
// which no rule that has adapted and no outlier brings about. Well again: fewer than a tenth.
constexpr double kBeyond = 3.0;
constexpr double kLost = 0.5;
constexpr double kWell = 0.1;

}  // namespace

// Divergence: a covariance that is no longer one, a state that is no number, or a filter that for long has
// been further from the measurements than it believes possible, its rule having had all the time to adapt.
// Either way it starts again from this measurement. If that does not help, the noise it was told is wrong,
// and starting again and again would not mend it: it is then left alone until it has been well.
void Engine::guard(const Measurement& m, EstimatorOutput& out) noexcept {
  bool lost = false, well = true, sound = rest_->sound();
  for (std::size_t a = 0; a < axes_; ++a) {
    sound = sound && std::isfinite(published_.rate[a]);
    lost = lost || grades_[a].beyond > kLost;
    well = well && grades_[a].beyond < kWell;
  }
  if (well) lost_ = false;
  const bool newly_lost = lost && !lost_;
  lost_ = lost_ || lost;
  if (sound && !newly_lost) return;
  ++health_.divergences;
  ++health_.restarts;
  out.flags |= kRestarted;
  // As a new filter takes over an old one's debt: no lag returns it any more.
  const Axes debt = owed();
  ledger_.forget();
  restart();
  owe(debt);
  begin_axes(m.in.rate_radps, m.valid);
  update_rest(m, false);
  publish_rest();
}

// Normalised innovation squared and lag-1 autocorrelation, over the last kHealthMemory samples or so.
void Engine::grade(std::size_t axis, double normalised) noexcept {
  Grade& grade = grades_[axis];
  grade.count = std::min(grade.count + 1.0, kHealthMemory);
  grade.square += (normalised * normalised - grade.square) / grade.count;
  grade.product += (normalised * grade.last - grade.product) / grade.count;
  grade.last = normalised;
  health_.nis_mean[axis] = grade.square;
  health_.whiteness[axis] = grade.square > 0.0 ? grade.product / grade.square : 0.0;
}

// From zero, so that it takes most of the memory to be lost: not the start-up of an adaptive rule.
void Engine::doubt(std::size_t axis, double normalised) noexcept {
  double& beyond = grades_[axis].beyond;
  beyond += ((normalised * normalised > kBeyond * kBeyond ? 1.0 : 0.0) - beyond) / kHealthMemory;
}

}  // namespace ifog
