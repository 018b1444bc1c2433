// SPDX-License-Identifier: Apache-2.0
// Names of state models, without the models.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ifog {

// True for one of state_model_names() or a sum of them with " + ", with any parameters.
bool is_state_model(const std::string& name);

// The terms of a sum with " + ".
std::vector<std::string> terms_of(const std::string& name);

// Of "ar(p)", with q = 0, or "arma(p,q)"; nullopt for other terms.
std::optional<std::pair<int, int>> arma_orders(const std::string& term);

}  // namespace ifog
