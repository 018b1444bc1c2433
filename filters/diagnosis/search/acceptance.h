// SPDX-License-Identifier: Apache-2.0
// What a search chose, put to the proof by what it leaves of the error.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/record/even_error.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {

// `after` and `held_out` of the errors as the chosen effects leave them.
void subtract_found(const BlockData& data, const SearchResult& found, std::vector<EvenError>& errors);

// Without effect `at`, everything else fitted anew. reconstructed: the reconstructed channels of `data`.
SearchResult without_effect(const BlockData& data, const BlockData& reconstructed, SearchResult found,
                            std::size_t at);

// What `found` would score on the blocks of `grid`, of which some may have been left out since. channels:
// those of its fit, on the blocks it had.
double score_on(const BlockGrid& grid, const BlockData& channels, const SearchResult& found);

// Whether effect `at` is more than a few outliers, a change of the noise or one part of the record make up.
bool stands(const BlockData& reconstructed, const SearchResult& found, std::size_t at, double significance);

// Whether the effects do not make the error larger: what is quick, and what a heading is made of, where
// chance has fewer pieces to average over. errors: as `found` leaves them; `after`: EvenError::held_out or
// written.
bool holds(const BlockData& reconstructed, const SearchResult& found, const std::vector<EvenError>& errors,
           SharedSamples EvenError::*after);

// Index of the least certain effect that is corrected online; none when there is no such effect.
std::optional<std::size_t> least_certain(const std::vector<Chosen>& chosen);

// Of two effects of one shape whose time constants came to lie within a tenth of each other the less certain
// one; none when there are no such two. They are one, and their coefficients would grow against each other
// without bound.
std::optional<std::size_t> standing_twice(const std::vector<Chosen>& chosen);

// Of two band powers of one channel that nearly cancel the less certain one; none when there are no such two.
// Their difference is the change of one with its bandwidth or its average, a likeness of it in one capture
// and not in the next, which has another spectrum.
std::optional<std::size_t> cancelling(const BlockData& data, const SearchResult& found);

// Takes out of `found` every effect of a channel that does not stand and every step that does not persist,
// then, while the error on held-out data does not hold, the least certain of those that are corrected online:
// effects that make it larger are no model, whatever their p-values. `errors` follow. The effects dropped, in
// that order.
std::vector<Effect> drop_what_does_not_hold(const BlockData& data, const BlockData& reconstructed,
                                            double significance, SearchResult& found,
                                            std::vector<EvenError>& errors);

}  // namespace ifog
