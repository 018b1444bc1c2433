#include "filters/diagnosis/regression/whitening.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ifog {
namespace {

// Steady-state covariance of the prediction for x+ = diag(f) x + w, z = 1'x + v, var v = 1: the
// structure-preserving doubling algorithm (Chu, Fan, Lin 2005), quadratic where iterating the filter takes as
// long as the slowest state.
Eigen::MatrixXd steady_covariance(const Eigen::VectorXd& f, const Eigen::VectorXd& q) {
  const Eigen::Index m = f.size();
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(m, m);
  Eigen::MatrixXd a = f.asDiagonal();
  Eigen::MatrixXd g = Eigen::MatrixXd::Ones(m, m);
  Eigen::MatrixXd h = q.asDiagonal();
  for (int round = 0; round < 60; ++round) {
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(one + g * h);
    const Eigen::MatrixXd wa = lu.solve(a);
    const Eigen::MatrixXd wg = lu.solve(g);
    const Eigen::MatrixXd step = a.transpose() * h * wa;
    g += a * wg * a.transpose();
    h += step;
    a = (a * wa).eval();
    if (step.norm() <= 1e-13 * h.norm()) break;
  }
  return 0.5 * (h + h.transpose());
}

}  // namespace

Eigen::VectorXd answer_to_step(const BlockGrid& grid, const NoiseShape& shape, const BlockRange& record) {
  Columns answer = Columns::Zero(static_cast<Eigen::Index>(grid.size()), 1);
  answer.col(0).segment(record.row(), record.rows()).setOnes();
  Whitening(grid, shape).apply(answer);
  return answer.col(0).segment(record.row(), record.rows());
}

std::vector<double> flicker_bank(const BlockGrid& grid) {
  std::vector<double> times;
  for (double tau = 2.0; tau < static_cast<double>(grid.longest()); tau *= kFlickerSpacing)
    times.push_back(tau);
  return times;
}

Whitening::Whitening(const BlockGrid& grid, const NoiseShape& shape) : grid_(grid) {
  std::vector<double> drive;
  if (shape.walk > 0.0) {
    factor_.push_back(1.0);
    drive.push_back(shape.walk);
  }
  const auto add_markov = [&](double variance, double blocks) {
    const double f = std::exp(-1.0 / blocks);
    factor_.push_back(f);
    drive.push_back(variance * (1.0 - f * f));
  };
  if (shape.flicker > 0.0) {
    for (const double tau : flicker_bank(grid)) add_markov(shape.flicker, tau);
  }
  if (shape.markov > 0.0) add_markov(shape.markov, shape.markov_s / grid.block_s);
  const auto m = static_cast<Eigen::Index>(factor_.size());
  if (m == 0) return;
  const Eigen::VectorXd f = Eigen::Map<Eigen::VectorXd>(factor_.data(), m);
  const Eigen::MatrixXd p = steady_covariance(f, Eigen::Map<Eigen::VectorXd>(drive.data(), m));
  const Eigen::VectorXd ph = p.rowwise().sum();
  innovation_variance_ = ph.sum() + 1.0;
  gain_.resize(factor_.size());
  for (Eigen::Index i = 0; i < m; ++i)
    gain_[static_cast<std::size_t>(i)] = f[i] * ph[i] / innovation_variance_;
}

// A fixed number of columns at once, so that their states stay in registers.
template <int Width>
void Whitening::apply_some(Columns& columns, Eigen::Index first) const {
  using Lane = Eigen::Array<double, Width, 1>;
  const std::size_t m = factor_.size();
  std::vector<Lane, Eigen::aligned_allocator<Lane>> state(m);
  const Eigen::Index stride = columns.cols();
  for (const BlockRange& record : grid_.records) {
    std::fill(state.begin(), state.end(), Lane::Zero());
    for (std::size_t b = record.first; b < record.end; ++b) {
      Eigen::Map<Lane> row(columns.data() + static_cast<Eigen::Index>(b) * stride + first);
      if (!grid_.valid[b]) {
        for (std::size_t i = 0; i < m; ++i) state[i] *= factor_[i];
        row.setZero();
        continue;
      }
      Lane e = row;
      for (std::size_t i = 0; i < m; ++i) e -= state[i];
      for (std::size_t i = 0; i < m; ++i) state[i] = factor_[i] * state[i] + gain_[i] * e;
      row = e;
    }
  }
}

void Whitening::apply(Columns& columns) const {
  Eigen::Index first = 0;
  for (; first + 8 <= columns.cols(); first += 8) apply_some<8>(columns, first);
  for (; first + 2 <= columns.cols(); first += 2) apply_some<2>(columns, first);
  for (; first < columns.cols(); ++first) apply_some<1>(columns, first);
}

NoiseTerms noise_terms(const NoiseShape& shape, double white, double block_s) {
  NoiseTerms terms;
  terms.N = std::sqrt(white * block_s);
  if (shape.walk > 0.0) terms.K = std::sqrt(shape.walk * white / block_s);
  // One-sided spectrum of the bank between its ends: variance / ln(spacing) / f; IEEE Std 952: B^2 / (pi f).
  if (shape.flicker > 0.0) {
    terms.B = std::sqrt(std::numbers::pi * shape.flicker * white / std::log(kFlickerSpacing));
  }
  return terms;
}

}  // namespace ifog
