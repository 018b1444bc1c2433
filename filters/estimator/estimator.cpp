// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/estimator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "filters/estimator/engine.h"
#include "filters/settings/filter_table.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

template <class Value>
void require(bool good, const char* setting, Value value, const char* expected) {
  if (!good)
    throw std::invalid_argument(
        formatted("%s: %.9g, expected %s", setting, static_cast<double>(value), expected));
}

void check(const FilterSettings& settings, int axes, double nominal_period_s) {
  require(axes >= 1 && axes <= kMaxAxes, "axes", axes, "1 to 3");
  require(std::isfinite(nominal_period_s) && nominal_period_s > 0, "nominal period", nominal_period_s,
          "a positive time in s");
  require(std::isfinite(settings.process_noise) && settings.process_noise > 0, "process_noise",
          settings.process_noise, "a positive spectral density in (rad/s)^2/s");
  require(std::isfinite(settings.measurement_noise) && settings.measurement_noise > 0, "measurement_noise",
          settings.measurement_noise, "a positive variance in (rad/s)^2");
  require_in_range(settings);
}

// Window in innovations: random weights scatter the gain by 3 %. Noise of skewness g biases the rate by g / N
// standard deviations; for g = 2, N = 20 / (q dt / R)^(1/4) that is 10 % of the filter's noise.
constexpr double kSteadyWindow = 1000.0, kSkewed = 20.0, kLongestWindow = 5 * kSteadyWindow;  // 120 kB

FilterSettings in_force(FilterSettings settings, double period_s) {
  if (!settings.plain) {
    const double leaves = std::pow(settings.process_noise * period_s / settings.measurement_noise, 0.25);
    if (settings.steady_gain && settings.follow_manoeuvres)
      settings.window = std::max(
          settings.window, static_cast<int>(std::clamp(kSkewed / leaves, kSteadyWindow, kLongestWindow)));
    return settings;
  }
  settings.follow_manoeuvres = settings.conserve_angle = settings.steady_gain = settings.guard = false;
  settings.floor = 0.0;
  return settings;
}

}  // namespace

Estimator::Estimator(const FilterSettings& given, int axes, double nominal_period_s,
                     const KnownNoise& known) {
  check(given, axes, nominal_period_s);
  const FilterSettings settings = in_force(given, nominal_period_s);
  auto rest = std::make_unique<RestFilter>(
      make_state_model(settings.state, settings.state_parameters, nominal_period_s), make_rule(settings),
      settings.process_noise, settings.measurement_noise);
  engine_ = std::make_unique<Engine>(settings, known, std::move(rest), axes, nominal_period_s);
}

Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;
Estimator& Estimator::operator=(Estimator&&) noexcept = default;

void Estimator::step(const EstimatorInput& in, EstimatorOutput& out) noexcept { engine_->step(in, out); }
Axes Estimator::owed() const noexcept { return engine_->owed(); }
void Estimator::owe(const Axes& angle_rad) noexcept { engine_->owe(angle_rad); }
LearnedNoise Estimator::learned() const noexcept { return engine_->learned(); }
const EstimatorHealth& Estimator::health() const noexcept { return engine_->health(); }

}  // namespace ifog
