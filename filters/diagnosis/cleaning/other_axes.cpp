// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/steps.h"

#include <algorithm>
#include <utility>

#include "filters/diagnosis/cleaning/reference_delay.h"
#include "filters/diagnosis/cleaning/series_fit.h"

namespace ifog {
namespace {

// Regression of measured rate minus reference on a constant and all moving references, in the given order.
// Empty if not possible.
Eigen::VectorXd shares_of(std::span<const double> measured, std::span<const double> reference,
                          const std::vector<std::span<const double>>& along) {
  std::vector<std::vector<double>> columns(2, std::vector<double>(measured.size(), 1.0));
  for (std::size_t i = 0; i < measured.size(); ++i) columns[0][i] = measured[i] - reference[i];
  for (const std::span<const double> each : along) columns.emplace_back(each.begin(), each.end());
  const SeriesFit fit = least_squares(columns, complete_rows(columns));
  if (fit.rows < 10 * columns.size()) return {};
  return fit.coefficients.tail(static_cast<Eigen::Index>(along.size()));
}

Samples less_its_own(std::span<const double> measured, std::span<const double> reference,
                     const std::vector<std::span<const double>>& along) {
  Samples corrected(measured);
  const Eigen::VectorXd shares = shares_of(measured, reference, along);
  if (shares.size() == 0) return corrected;
  for (std::size_t a = 0; a < along.size(); ++a) {
    const double share = shares[static_cast<Eigen::Index>(a)];
    for (std::size_t i = 0; i < corrected.size(); ++i) corrected[i] -= share * along[a][i];
  }
  return corrected;
}

// The other axes as records, each with its reference aligned.
OwnedRecords aligned_others(const Record& record) {
  std::vector<Record> axes;
  for (std::size_t a = 0; a < record.other_axes.size(); ++a) {
    Record axis;
    axis.name = record.other_axes[a].name;
    axis.time_s = record.time_s;
    axis.rate_radps = record.other_axes[a].values;
    if (a < record.other_references.size()) axis.reference_radps = record.other_references[a];
    axis.origin = record.origin;
    axes.push_back(std::move(axis));
  }
  return align_references(std::move(axes));
}

}  // namespace

OwnedRecords with_other_axes(OwnedRecords given) {
  const auto referenced = [](const Record& record) { return moves(record.reference_radps); };
  if (!std::ranges::all_of(given.records, referenced)) return given;
  for (Record& record : given.records) {
    const OwnedRecords others = aligned_others(record);
    std::vector<std::span<const double>> along{record.reference_radps};
    for (const Record& other : others.records)
      if (moves(other.reference_radps)) along.push_back(other.reference_radps);
    for (const Record& other : others.records) {
      RecordChannel axis{other.name, other.rate_radps};
      if (moves(other.reference_radps))
        axis.values = given.columns.emplace_back(less_its_own(axis.values, other.reference_radps, along));
      record.channels.push_back(axis);
    }
  }
  return given;
}

}  // namespace ifog
