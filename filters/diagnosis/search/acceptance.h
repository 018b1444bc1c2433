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

// Without effect `at`, everything else fitted anew. reconstructed: the reconstructed channels of `data`.
SearchResult without_effect(const BlockData& data, const BlockData& reconstructed, SearchResult found,
                            std::size_t at);

// Whether the effects do not make the error larger: what is quick, and what a heading is made of, where
// chance has fewer pieces to average over. errors: as `found` leaves them; `after`: EvenError::held_out or
// written.
bool holds(const BlockData& reconstructed, const SearchResult& found, const std::vector<EvenError>& errors,
           SharedSamples EvenError::*after);

// Index of the least certain effect that is corrected online; none when there is no such effect.
std::optional<std::size_t> least_certain(const std::vector<Chosen>& chosen);

// Takes out of `found` every step that does not persist beside the other effects, then, while the error on
// held-out data does not hold, the least certain of those that are corrected online: effects that make it
// larger are no model, whatever their p-values. `errors` follow. The effects dropped, in that order.
std::vector<Effect> drop_what_does_not_hold(const BlockData& data, const BlockData& reconstructed,
                                            SearchResult& found, std::vector<EvenError>& errors);

}  // namespace ifog
