// SPDX-License-Identifier: Apache-2.0
// What a search chose, put to the proof by what it leaves of the error.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {

// `after` and `held_out` of the errors as the chosen effects leave them.
void subtract_found(const BlockData& data, const SearchResult& found, std::vector<EvenError>& errors);

// Without effect `at`, everything else fitted again.
SearchResult without_effect(const BlockData& reconstructed, SearchResult found, std::size_t at);

// Index of the least certain effect that is corrected online; none when there is no such effect.
std::optional<std::size_t> least_certain(const std::vector<Chosen>& chosen);

}  // namespace ifog
