// Takes effects back out of a search's result.
#pragma once

#include "filters/diagnosis/search/search.h"

namespace ifog {

// Without effect `at`, everything else fitted anew. clean: the reconstructed channels of `data`.
SearchResult without_effect(const BlockData& data, const BlockData& clean, SearchResult found,
                            std::size_t at);

}  // namespace ifog
