// SPDX-License-Identifier: Apache-2.0
// Decompositions of symmetric matrices, whose lower half is used. Wraps Eigen's, which compile slowly.
#pragma once

#include <Eigen/Dense>

namespace ifog {

// A x = b by LDL', for A that is (nearly) positive definite.
class SymmetricSolver {
 public:
  explicit SymmetricSolver(const Eigen::MatrixXd& a);

  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  [[nodiscard]] Eigen::MatrixXd inverse() const;
  // True if no pivot is negative.
  [[nodiscard]] bool is_positive() const;
  // D, in the order of the pivoting.
  [[nodiscard]] Eigen::VectorXd pivots() const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> factor_;
};

// A = L L' for positive definite A.
class CholeskyFactor {
 public:
  explicit CholeskyFactor(const Eigen::MatrixXd& a);

  // False if A is not positive definite; then nothing else may be called.
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
  Eigen::MatrixXd vectors;  // one per column, orthonormal
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a);

}  // namespace ifog
