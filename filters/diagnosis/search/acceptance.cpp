#include "filters/diagnosis/search/acceptance.h"

#include <algorithm>

#include "filters/diagnosis/search/fit_to_readings.h"

namespace ifog {

SearchResult without_effect(const BlockData& data, const BlockData& clean, SearchResult found,
                            std::size_t at) {
  found.chosen.erase(found.chosen.begin() + static_cast<std::ptrdiff_t>(at));
  found.clean.erase(found.clean.begin() + static_cast<std::ptrdiff_t>(at));
  std::erase_if(found.alternatives, [&](const Alternative& other) { return other.of == at; });
  for (Alternative& other : found.alternatives) other.of -= other.of > at ? 1 : 0;
  for (std::size_t i = 0; i < found.chosen.size(); ++i) found.chosen[i].candidate = found.clean[i];
  const Columns columns = design(clean, found.clean);
  found.noise = fit_noise(clean.grid, columns);
  found.coefficients = solve(clean.grid, found.noise.shape, columns, &found.covariance);
  found.clean_coefficients = found.coefficients;
  fit_to_readings(data, clean, found);
  return found;
}

}  // namespace ifog
