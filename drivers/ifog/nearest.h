// SPDX-License-Identifier: Apache-2.0
// Suggestions "did you mean" for misspelt names.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ifog {

// Edit distance: insertions, deletions, replacements and swaps of neighbours (Damerau; restricted form).
inline std::size_t edits_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last, last(b.size() + 1), now(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = std::min(now[j], before_last[j - 2] + 1);
    }
    before_last = std::exchange(last, now);
  }
  return last[b.size()];
}

// ", did you mean 'allan'?" with the first of the nearest names, or "".
template <typename Names>
std::string did_you_mean(std::string_view written, const Names& names) {
  constexpr std::size_t kLongest = 64;  // longer names are no misspellings
  const std::size_t most = std::min<std::size_t>(2, written.size() / 3);
  std::size_t fewest = most + 1;
  std::string_view nearest;
  if (written.size() <= kLongest)
    for (const auto& name : names)
      if (const std::size_t edits = edits_between(written, name); edits < fewest) {
        fewest = edits;
        nearest = name;
      }
  return nearest.empty() ? "" : ", did you mean '" + std::string(nearest) + "'?";
}

// The same with all names: ", did you mean 'allan'? Known here: allan, tune", or ", expected one of: allan,
// tune".
template <typename Names>
std::string meant_or_known(std::string_view written, const Names& names) {
  std::string known;
  for (const auto& name : names) (known += known.empty() ? "" : ", ") += name;
  const std::string meant = did_you_mean(written, names);
  return meant.empty() ? ", expected one of: " + known : meant + " Known here: " + known;
}

// Expected values: "one of allan, tune; did you mean 'allan'?". also: text after the list, for further
// possibilities.
template <typename Names>
std::string one_of(std::string_view written, const Names& names, std::string_view also = "") {
  std::string out = "one of ";
  bool first = true;
  for (const auto& name : names) {
    if (!std::exchange(first, false)) out += ", ";
    out += name;
  }
  out += also;
  const std::string meant = did_you_mean(written, names);
  return meant.empty() ? out : out + ";" + meant.substr(1);
}

}  // namespace ifog
