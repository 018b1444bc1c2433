// SPDX-License-Identifier: Apache-2.0
// A warm-up is what a sensor does of itself; what a channel explains as well is the channel's, which the next
// capture has, too.
#pragma once

#include "filters/diagnosis/search/search.h"

namespace ifog {

[[nodiscard]] bool has_warm_up(const SearchResult& result);

// Whether channels alone, sought without a warm-up, say what was found with one, in hardly more words
// (description length: Rissanen, Automatica 14 (1978) 465).
[[nodiscard]] bool channels_explain_it(const BlockGrid& grid, const SearchResult& by_channels,
                                       const SearchResult& found);

}  // namespace ifog
