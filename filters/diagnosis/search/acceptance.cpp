// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/acceptance.h"

#include <algorithm>

#include "filters/diagnosis/checks/cross_validation.h"

namespace ifog {
std::optional<std::size_t> least_certain(const std::vector<Chosen>& chosen) {
  std::optional<std::size_t> least;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i].candidate.corrected()) continue;
    if (!least || chosen[i].likelihood_ratio < chosen[*least].likelihood_ratio) least = i;
  }
  return least;
}

void subtract_found(const BlockData& data, const SearchResult& found, std::vector<EvenError>& errors) {
  subtract_effects(data, candidates_of(found.chosen), found.noise.shape, found.coefficients, errors);
}

SearchResult without_effect(const BlockData& reconstructed, SearchResult found, std::size_t at) {
  found.chosen.erase(found.chosen.begin() + static_cast<std::ptrdiff_t>(at));
  std::erase_if(found.alternatives, [&](const Alternative& other) { return other.of == at; });
  for (Alternative& other : found.alternatives) other.of -= other.of > at ? 1 : 0;
  const Columns columns = design(reconstructed, candidates_of(found.chosen));
  found.noise = fit_noise(reconstructed.grid, columns, found.noise.shape);
  found.coefficients = solve(reconstructed.grid, found.noise.shape, columns, &found.covariance);
  return found;
}

}  // namespace ifog
