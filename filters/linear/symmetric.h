// SPDX-License-Identifier: Apache-2.0
// Decompositions of symmetric matrices, of which the lower half is read. Eigen's: here because each takes a
// compiler seconds, and a dozen files use them.
#pragma once

#include <Eigen/Dense>

namespace ifog {

// A x = b by LDL'. For A that are positive definite, or nearly.
class SymmetricSolver {
 public:
  explicit SymmetricSolver(const Eigen::MatrixXd& a);

  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  [[nodiscard]] Eigen::MatrixXd inverse() const;
  // Whether no pivot is negative.
  [[nodiscard]] bool is_positive() const;
  // D, in the order of the pivoting.
  [[nodiscard]] Eigen::VectorXd pivots() const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> factor_;
};

// A = L L', for what must be positive definite.
class CholeskyFactor {
 public:
  explicit CholeskyFactor(const Eigen::MatrixXd& a);

  // Without it nothing else may be asked.
  [[nodiscard]] bool exists() const;
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  // Log determinant of L, half of A's.
  [[nodiscard]] double log_determinant() const;

 private:
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

struct SymmetricEigen {
  Eigen::VectorXd values;   // ascending
  Eigen::MatrixXd vectors;  // a column each, orthonormal
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a);

}  // namespace ifog
