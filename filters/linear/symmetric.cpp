// SPDX-License-Identifier: Apache-2.0
#include "filters/linear/symmetric.h"

namespace ifog {

SymmetricSolver::SymmetricSolver(const Eigen::MatrixXd& a) : factor_(a) {}

Eigen::VectorXd SymmetricSolver::solve(const Eigen::VectorXd& b) const { return factor_.solve(b); }

Eigen::MatrixXd SymmetricSolver::inverse() const {
  return factor_.solve(Eigen::MatrixXd::Identity(factor_.rows(), factor_.rows()));
}

bool SymmetricSolver::is_positive() const { return factor_.isPositive(); }

Eigen::VectorXd SymmetricSolver::pivots() const { return factor_.vectorD(); }

CholeskyFactor::CholeskyFactor(const Eigen::MatrixXd& a) : factor_(a) {}

bool CholeskyFactor::exists() const { return factor_.info() == Eigen::Success; }

Eigen::VectorXd CholeskyFactor::solve(const Eigen::VectorXd& b) const { return factor_.solve(b); }

Eigen::MatrixXd CholeskyFactor::solve(const Eigen::MatrixXd& b) const { return factor_.solve(b); }

double CholeskyFactor::log_determinant() const { return factor_.matrixLLT().diagonal().array().log().sum(); }

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace ifog
