// SPDX-License-Identifier: Apache-2.0
// Power of a series at the multiples of one over its length, however long it is.
#pragma once

#include <cstddef>
#include <span>

#include "filters/series/samples.h"

namespace ifog {

struct Periodogram {
  // Up to so many samples in one transform in memory, beyond in many short ones (paired_transform.h).
  static constexpr std::size_t kMostInMemory = std::size_t{1} << 22U;

  Samples power;           // of bins 0 … length / 2, not scaled
  std::size_t length = 0;  // of the series, cut to a product of small primes for the transform's sake
  double mean = 0.0;       // of all samples that are there, which is taken out first
};

// Of the samples that are there; 0 for none.
[[nodiscard]] double mean_of_present(std::span<const double> values);

// Missing samples (NaN) count as the mean. At least 16 samples.
Periodogram periodogram(std::span<const double> error, std::size_t in_memory = Periodogram::kMostInMemory);

}  // namespace ifog
