// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/other_axes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/diagnosis/cleaning/reference_delay.h"
#include "filters/linear/normal_equations.h"

namespace ifog {
namespace {

// Measured rate less reference, on a constant and all references that move, in the order given. Empty where
// there is nothing to tell them by.
Eigen::VectorXd shares_of(std::span<const double> measured, std::span<const double> reference,
                          const std::vector<std::span<const double>>& along) {
  const auto p = static_cast<Eigen::Index>(along.size()) + 1;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(p + 1, p + 1);
  Eigen::VectorXd row(p + 1);
  row[1] = 1.0;
  double rows = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    row[0] = measured[i] - reference[i];
    for (std::size_t a = 0; a < along.size(); ++a) row[2 + static_cast<Eigen::Index>(a)] = along[a][i];
    if (!row.allFinite()) continue;
    gram.selfadjointView<Eigen::Lower>().rankUpdate(row);
    ++rows;
  }
  if (rows < 10.0 * static_cast<double>(p)) return {};
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return NormalEquations::of_measured_first(gram).coefficients().tail(p - 1);
}

Samples less_its_own(std::span<const double> measured, std::span<const double> reference,
                     const std::vector<std::span<const double>>& along) {
  Samples corrected(measured.begin(), measured.end());
  const Eigen::VectorXd shares = shares_of(measured, reference, along);
  if (shares.size() == 0) return corrected;
  for (std::size_t a = 0; a < along.size(); ++a) {
    const double share = shares[static_cast<Eigen::Index>(a)];
    for (std::size_t i = 0; i < corrected.size(); ++i) corrected[i] -= share * along[a][i];
  }
  return corrected;
}

// The other axes as records, each with its reference as if that had not been logged late.
AlignedRecords aligned_others(const Record& record) {
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
  return align_references(axes);
}

}  // namespace

AlongAxes with_other_axes(std::vector<Record> records) {
  AlongAxes out;
  const auto referenced = [](const Record& record) { return moves(record.reference_radps); };
  if (!records.empty() && std::all_of(records.begin(), records.end(), referenced)) {
    for (Record& record : records) {
      const AlignedRecords others = aligned_others(record);
      std::vector<std::span<const double>> along{record.reference_radps};
      for (const Record& other : others.records)
        if (moves(other.reference_radps)) along.push_back(other.reference_radps);
      for (const Record& other : others.records) {
        RecordChannel axis{other.name, other.rate_radps};
        if (moves(other.reference_radps))
          axis.values = out.values.emplace_back(less_its_own(axis.values, other.reference_radps, along));
        record.channels.push_back(axis);
      }
    }
  }
  out.records = std::move(records);
  return out;
}

}  // namespace ifog
