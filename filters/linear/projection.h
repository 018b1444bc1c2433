// SPDX-License-Identifier: Apache-2.0
// Removes columns from others: what ordinary least squares on them leaves.
#pragma once

#include "filters/linear/columns.h"

namespace ifog {

class Projection {
 public:
  // columns: independent of each other, no more of them than rows (Householder QR; their span is
  // removed).
  explicit Projection(const Eigen::MatrixXd& columns);

  // In place; as many rows as the columns have.
  void take_out_of(Eigen::VectorXd& values) const;
  void take_out_of(Columns& values) const;

  // What is at right angles to one column of n rows: n × (n - 1), orthonormal.
  static Eigen::MatrixXd beside(const Eigen::VectorXd& column);

 private:
  Eigen::MatrixXd basis_;  // orthonormal
};

}  // namespace ifog
