// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/rest_filter.h"

#include <stdexcept>
#include <string>

#include "filters/estimator/sized_rest_filter.h"

namespace ifog {

// Instantiated in a file of their own, so that they compile on another processor.
extern template class SizedRestFilter<1>;
extern template class SizedRestFilter<2>;
extern template class SizedRestFilter<3>;
extern template class SizedRestFilter<4>;
extern template class SizedRestFilter<5>;
extern template class SizedRestFilter<6>;
extern template class SizedRestFilter<7>;
extern template class SizedRestFilter<8>;

std::unique_ptr<RestFilter> make_rest_filter(std::unique_ptr<StateModel> model, std::unique_ptr<Rule> rule,
                                             double process_noise, double measurement_noise) {
  constexpr std::array kMakers{make_sized_rest_filter<1>, make_sized_rest_filter<2>,
                               make_sized_rest_filter<3>, make_sized_rest_filter<4>,
                               make_sized_rest_filter<5>, make_sized_rest_filter<6>,
                               make_sized_rest_filter<7>, make_sized_rest_filter<8>};
  static_assert(kMakers.size() == kMaxStates);
  const int states = model->states();
  if (states < 1 || states > kMaxStates) {
    throw std::invalid_argument("state: " + std::to_string(states) + " states in all, expected 1 to " +
                                std::to_string(kMaxStates));
  }
  return kMakers[static_cast<std::size_t>(states - 1)](std::move(model), std::move(rule), process_noise,
                                                       measurement_noise);
}

}  // namespace ifog
