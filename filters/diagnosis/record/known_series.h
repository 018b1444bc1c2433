// SPDX-License-Identifier: Apache-2.0
// What was worked out of a long series, for when the same series is asked for again: the steps of a diagnosis
// look at what is left each by itself, and what no effect was found in is before and after the same.
#pragma once

#include <concepts>
#include <cstddef>
#include <list>
#include <span>
#include <type_traits>
#include <utility>

#include "filters/series/series_mark.h"
#include "filters/series/shared_samples.h"

namespace ifog {

// A series to ask for. What is in SharedSamples keeps its mark, so that it is read through for it once; any
// other is each time. Outlived by what it is of.
class AskedSeries {
 public:
  AskedSeries(const SharedSamples& samples) : values_(samples), kept_(&samples) {}
  template <typename Values>
  requires(std::convertible_to<const Values&, std::span<const double>> &&
           !std::same_as<std::remove_cvref_t<Values>, AskedSeries>) AskedSeries(const Values& values)
      : values_(values) {}

  [[nodiscard]] std::span<const double> values() const { return values_; }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] SeriesMark mark() const { return kept_ != nullptr ? kept_->mark() : mark_of(values_); }

 private:
  std::span<const double> values_;
  const SharedSamples* kept_ = nullptr;
};

template <typename Value>
class KnownOfSeries {
 public:
  // most: series that are kept, those asked for last.
  explicit KnownOfSeries(std::size_t most) : most_(most) {}

  // work(series), or what that gave before; valid until the next call.
  template <typename Work>
  const Value& of(const AskedSeries& series, const Work& work) {
    const SeriesMark mark = series.mark();
    for (auto each = known_.begin(); each != known_.end(); ++each)
      if (each->first == mark) {
        known_.splice(known_.begin(), known_, each);
        return each->second;
      }
    if (known_.size() == most_) known_.pop_back();
    return known_.emplace_front(mark, work(series.values())).second;
  }

 private:
  std::size_t most_;
  std::list<std::pair<SeriesMark, Value>> known_;
};

}  // namespace ifog
