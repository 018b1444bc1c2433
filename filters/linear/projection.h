// SPDX-License-Identifier: Apache-2.0
// Projects columns out of others: residuals of ordinary least squares.
#pragma once

#include "filters/linear/columns.h"

namespace ifog {

class Projection {
 public:
  // columns: linearly independent, at most as many as rows (Householder QR with pivoting).
  explicit Projection(const Eigen::MatrixXd& columns);

  // In place; needs as many rows as the columns have.
  void take_out_of(Eigen::VectorXd& values) const;
  void take_out_of(Columns& values) const;

  // Orthonormal complement of one column of n rows: n × (n - 1).
  static Eigen::MatrixXd complement(const Eigen::VectorXd& column);

 private:
  Eigen::MatrixXd basis_;  // orthonormal
};

}  // namespace ifog
