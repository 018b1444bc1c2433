// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/steps.h"

#include <algorithm>
#include <utility>

#include "filters/linear/columns.h"
#include "filters/linear/normal_equations.h"

namespace ifog {
namespace {

// The measured rate without its regression of measured rate minus reference on all moving references; unchanged if
// there are too few samples.
Samples less_its_own(std::span<const double> measured, std::span<const double> reference,
                     const std::vector<std::span<const double>>& along) {
  const auto vector = [](std::span<const double> values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  };
  const auto axes = static_cast<Eigen::Index>(along.size());
  Columns columns = Columns::Ones(vector(measured).size(), 2 + axes);
  columns.col(0) = vector(measured) - vector(reference);
  for (Eigen::Index a = 0; a < axes; ++a) columns.col(2 + a) = vector(along[static_cast<std::size_t>(a)]);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  Eigen::Index complete = 0;
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    if (!columns.row(i).allFinite()) continue;
    gram.selfadjointView<Eigen::Lower>().rankUpdate(columns.row(i).transpose());
    ++complete;
  }
  if (complete < 10 * columns.cols()) return Samples(measured);
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  const Eigen::VectorXd shares = NormalEquations::of_measured_first(gram).coefficients().tail(axes);
  const Eigen::VectorXd corrected = vector(measured) - columns.rightCols(axes) * shares;
  return Samples(std::span<const double>(corrected.data(), measured.size()));
}

}  // namespace

OwnedRecords with_other_axes(OwnedRecords given) {
  const auto referenced = [](const Record& record) { return moves(record.reference_radps); };
  if (!std::ranges::all_of(given.records, referenced)) return given;
  for (Record& record : given.records) {
    std::vector<std::span<const double>> along{record.reference_radps};
    for (const std::span<const double> reference : record.other_references)
      if (moves(reference)) along.push_back(reference);
    for (std::size_t a = 0; a < record.other_axes.size(); ++a) {
      RecordChannel axis = record.other_axes[a];
      if (a < record.other_references.size() && moves(record.other_references[a]))
        axis.values =
            given.columns.emplace_back(less_its_own(axis.values, record.other_references[a], along));
      record.channels.push_back(axis);
    }
  }
  return given;
}

}  // namespace ifog
