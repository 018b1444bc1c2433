// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/even_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "filters/series/finite_sum.h"

namespace ifog {

Samples on_even_grid(const Record& record, double sample_s, std::span<const double> values) {
  const double span = record.time_s.back() - record.time_s.front();
  const double steps = std::floor(span / sample_s + 0.5) + 1.0;
  if (steps > 100.0 * static_cast<double>(values.size())) {
    throw std::invalid_argument(
        record.name + ": gaps are a hundred times the samples; give the parts as captures of their own");
  }
  Samples even(static_cast<std::size_t>(steps), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto k =
        static_cast<std::size_t>(std::floor((record.time_s[i] - record.time_s.front()) / sample_s + 0.5));
    even[std::min(k, even.size() - 1)] = values[i];
  }
  return even;
}

Samples error_of(const Record& record) {
  Samples error(record.rate_radps.size());
  for (std::size_t i = 0; i < error.size(); ++i) error[i] = record.error(i);
  return error;
}

void bridge(std::span<double> values, std::size_t most) {
  std::size_t last = values.size();  // known value
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    if (last < i && i - last <= most + 1)
      for (std::size_t k = last + 1; k < i; ++k)
        values[k] = values[last] + (values[i] - values[last]) * static_cast<double>(k - last) /
                                       static_cast<double>(i - last);
    last = i;
  }
}

double variance_of(std::span<const double> values, double of_fewer) {
  const auto [sum, n] = finite_sum(values);
  if (n < 2.0) return of_fewer;
  double square = 0.0;
  const double mean = sum / n;
  for (const double v : values)
    if (std::isfinite(v)) square += (v - mean) * (v - mean);
  return square / n;
}

}  // namespace ifog
