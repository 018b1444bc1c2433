// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filters/state_models/spectral_radius.h"
#include "filters/state_models/state_model.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

// Dickey and Fuller's 1 % point of n (1 - rho) with unknown mean: an autoregression of a random walk is below
// it in 99 of 100 records (W. Fuller, "Introduction to Statistical Time Series", 1976, table 8.5.1).
constexpr double kDistinctFromWalk = 20.7;
// Small, since both filters' mean squares contain the same noise.
constexpr double kWorse = 1.01;

// Reason against the model, or empty.
std::string reason_against(const TunedModel& model, const TunedModel& walk, double period_s, double samples) {
  if (const double n = memories_in_record(model.settings, period_s, samples); n < kDistinctFromWalk)
    return formatted(
        "its colour lasts %.2g of the record, too long to be distinguished from a walk or a line", 1.0 / n);
  if (!model.held_out || !walk.held_out) return "";
  const double worse = prediction_against(*model.held_out, *walk.held_out);
  if (worse <= kWorse) return "";
  return formatted(
      "its published rate predicts the second half worse than the random walk's: %.3g times the "
      "mean square error",
      worse);
}

}  // namespace

double prediction_against(const Outcome& model, const Outcome& walk) {
  double sum = 0.0, count = 0.0;
  for (std::size_t a = 0; a < model.ahead.size(); ++a)
    for (std::size_t h = 0; h < std::min(model.ahead[a].size(), walk.ahead[a].size()); ++h) {
      if (!(model.ahead[a][h] > 0.0 && walk.ahead[a][h] > 0.0)) continue;
      sum += std::log(model.ahead[a][h] / walk.ahead[a][h]);
      count += 1.0;
    }
  return count > 0.0 ? std::exp(sum / count) : 1.0;
}

double memories_in_record(const FilterSettings& settings, double period_s, double samples) {
  const auto model = make_state_model(settings.state, settings.state_parameters, period_s);
  const Eigen::Index n = model->states();
  if (n < 2) return std::numeric_limits<double>::infinity();
  Eigen::MatrixXd transition(n, n), driving(n, n);
  model->discretise(period_s, transition, driving);
  // The level is the first block.
  return (1.0 - spectral_radius(transition.bottomRightCorner(n - 1, n - 1))) * samples;
}

std::size_t choose(std::vector<TunedModel>& models, double period_s, double samples) {
  const auto walk =
      std::ranges::find_if(models, [](const TunedModel& m) { return m.settings.state == "random-walk"; });
  if (walk == models.end()) return 0;
  auto chosen = models.begin();
  for (; chosen != walk; ++chosen) {
    chosen->passed_over = reason_against(*chosen, *walk, period_s, samples);
    if (chosen->passed_over.empty()) break;
  }
  return static_cast<std::size_t>(chosen - models.begin());
}

}  // namespace ifog
