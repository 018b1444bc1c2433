#include "filters/chain/filter_choice.h"

#include <utility>

namespace ifog {
namespace {

template <typename T>
void take(const std::optional<T>& said, T& setting) {
  if (said) setting = *said;
}

}  // namespace

FilterSettings settings_in_force(const FilterChoice& choice, FilterSettings base) {
  take(choice.rule, base.rule);
  take(choice.state, base.state);
  take(choice.weights, base.weights);
  take(choice.process_noise, base.process_noise);
  take(choice.measurement_noise, base.measurement_noise);
  take(choice.floor, base.floor);
  take(choice.state_parameters, base.state_parameters);
  take(choice.window, base.window);
  take(choice.draws, base.draws);
  take(choice.follow_manoeuvres, base.follow_manoeuvres);
  take(choice.conserve_angle, base.conserve_angle);
  take(choice.seed, base.seed);
  return base;
}

}  // namespace ifog
