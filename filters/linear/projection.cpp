// SPDX-License-Identifier: Apache-2.0
#include "filters/linear/projection.h"

namespace ifog {

Projection::Projection(const Eigen::MatrixXd& columns)
    : basis_(Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(columns).householderQ() *
             Eigen::MatrixXd::Identity(columns.rows(), columns.cols())) {}

void Projection::take_out_of(Eigen::VectorXd& values) const {
  values -= basis_ * (basis_.transpose() * values);
}

void Projection::take_out_of(Columns& values) const {
  const Eigen::MatrixXd shadow = basis_.transpose() * values;
  values.noalias() -= basis_ * shadow;
}

Eigen::MatrixXd Projection::complement(const Eigen::VectorXd& column) {
  const Eigen::MatrixXd whole = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(column).householderQ();
  return whole.rightCols(column.size() - 1);
}

}  // namespace ifog
