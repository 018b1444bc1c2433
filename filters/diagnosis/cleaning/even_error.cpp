// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/even_error.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "filters/series/finite_sum.h"

namespace ifog {

std::vector<EvenError> even_errors(const std::vector<Record>& records, double sample_s) {
  std::vector<EvenError> errors;
  errors.reserve(records.size());
  for (const Record& record : records) {
    EvenError error;
    error.origin = record.origin;
    error.start_s = record.time_s.front();
    error.rest = error.before =
        std::make_shared<const Samples>(on_even_grid(record, sample_s, error_of(record)));
    errors.push_back(std::move(error));
  }
  return errors;
}

void take_out(std::span<const double> part, std::size_t record, BlockGrid& grid, EvenError& error) {
  const BlockRange& blocks = grid.records[record];
  std::vector<FiniteSum> sums(blocks.size());
  Samples rest = *error.rest;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const auto step =
        static_cast<std::size_t>(std::floor(static_cast<double>(i) * grid.sample_s / grid.fine_s + 0.5));
    FiniteSum& block = sums[std::min(step / grid.fine, blocks.size() - 1)];
    if (std::isfinite(rest[i])) block.sum += part[i], block.count += 1.0;
    rest[i] -= part[i];
  }
  error.rest = std::make_shared<const Samples>(std::move(rest));
  for (std::size_t b = 0; b < blocks.size(); ++b)
    if (grid.valid[blocks.first + b] && sums[b].count > 0.0)
      grid.error[blocks.row() + static_cast<Eigen::Index>(b)] -= sums[b].sum / sums[b].count;
}

void refuse_constant(const std::vector<Record>& records) {
  for (const Record& record : records) {
    for (std::size_t i = 0; i < record.rate_radps.size(); ++i)
      if (!(record.error(i) == record.error(0))) return;
  }
  throw std::invalid_argument(
      "the rate, less the reference if there is one, never changes; expected measurements");
}

}  // namespace ifog
