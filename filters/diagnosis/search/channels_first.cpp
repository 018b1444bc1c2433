// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/channels_first.h"

#include <algorithm>
#include <cmath>

namespace ifog {
namespace {

constexpr double kChannelsFirst = 10.0;  // twice the description that channels may be longer than a warm-up

// Twice the length in which the data are described: three channels that together happen to settle are dearer
// than one that does.
double description(const BlockGrid& grid, const SearchResult& result) {
  double parameters = 0.0;
  for (const Chosen& each : result.chosen)
    parameters += static_cast<double>(each.candidate.width()) + (each.candidate.searched() ? 1.0 : 0.0) +
                  (each.candidate.second_time_constant_s > 0.0 || each.candidate.is_transition() ? 1.0 : 0.0);
  return parameters * std::log(static_cast<double>(grid.used())) - score_of(result);
}

// Whether a channel explains what another search had left to something else.
bool explains_by_channel(const SearchResult& result, const SearchResult& other) {
  return std::any_of(result.chosen.begin(), result.chosen.end(), [&](const Chosen& each) {
    return each.candidate.channel != Candidate::kNone &&
           std::none_of(other.chosen.begin(), other.chosen.end(),
                        [&](const Chosen& also) { return also.candidate.same_shape(each.candidate); });
  });
}

}  // namespace

bool has_warm_up(const SearchResult& result) {
  return std::any_of(result.chosen.begin(), result.chosen.end(),
                     [](const Chosen& each) { return each.candidate.form == Form::kWarmUp; });
}

bool channels_explain_it(const BlockGrid& grid, const SearchResult& by_channels, const SearchResult& found) {
  return explains_by_channel(by_channels, found) &&
         description(grid, by_channels) < description(grid, found) + kChannelsFirst;
}

}  // namespace ifog
