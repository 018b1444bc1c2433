// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/whitening.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "filters/linear/general_solver.h"

namespace ifog {
namespace {

// Steady-state covariance of the prediction for x+ = F x + w, z = s'x + v, var w = diag(q), var v = 1, by the
// structure-preserving doubling algorithm (Chu, Fan, Lin 2005). It converges quadratically; filter iteration
// takes as long as the slowest state.
Eigen::MatrixXd steady_covariance(const Eigen::MatrixXd& f, const Eigen::VectorXd& q,
                                  const Eigen::VectorXd& s) {
  const Eigen::Index m = q.size();
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(m, m);
  Eigen::MatrixXd a = f.transpose();
  Eigen::MatrixXd g = s * s.transpose();
  Eigen::MatrixXd h = q.asDiagonal();
  for (int round = 0; round < 60; ++round) {
    Eigen::MatrixXd both(m, 2 * m);
    both << a, g;
    const Eigen::MatrixXd w = solved(one + g * h, both);
    const Eigen::MatrixXd step = a.transpose() * h * w.leftCols(m);
    g += a * w.rightCols(m) * a.transpose();
    h += step;
    a = (a * w.leftCols(m)).eval();
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
  double tau = 2.0;
  while (tau < static_cast<double>(grid.longest())) {
    times.push_back(tau);
    tau *= kFlickerSpacing;
  }
  return times;
}

Whitening::Whitening(const BlockGrid& grid, const NoiseShape& shape) : grid_(grid) {
  if (shape.walk > 0.0) {
    factor_.push_back(1.0);
    drive_.push_back(shape.walk);
  }
  if (shape.flicker > 0.0) {
    for (const double blocks : flicker_bank(grid)) {
      const double f = std::exp(-1.0 / blocks);
      factor_.push_back(f);
      drive_.push_back(shape.flicker * (1.0 - f * f));
    }
  }
  for (const DampedHarmonic& each : shape.harmonics) {
    const double left = std::exp(-1.0 / each.decay);
    const double turn = 2.0 * std::numbers::pi * each.cycles;
    const double before = each.of == DampedHarmonic::Of::kAngle ? -1.0 : 0.0;
    turns_.push_back({left * std::cos(turn), left * std::sin(turn), before});
    const double driven = each.variance * (1.0 - left * left);
    drive_.insert(drive_.end(), {driven, driven, 0.0});
  }
  if (!drive_.empty()) design_gain();
}

Whitening::StateSpace Whitening::state_space() const {
  const auto m = static_cast<Eigen::Index>(drive_.size());
  StateSpace states{Eigen::MatrixXd::Zero(m, m), Eigen::Map<const Eigen::VectorXd>(drive_.data(), m),
                    Eigen::VectorXd::Ones(m)};
  Eigen::Index i = 0;
  for (; i < static_cast<Eigen::Index>(factor_.size()); ++i)
    states.step(i, i) = factor_[static_cast<std::size_t>(i)];
  for (const Turn& turn : turns_) {
    states.step.block<2, 2>(i, i) << turn.cosine, -turn.sine, turn.sine, turn.cosine;
    states.step(i + 2, i) = 1.0;
    states.seen.segment<2>(i + 1) << 0.0, turn.before;
    i += 3;
  }
  return states;
}

void Whitening::design_gain() {
  const StateSpace states = state_space();
  const Eigen::VectorXd ph = steady_covariance(states.step, states.drive, states.seen) * states.seen;
  innovation_variance_ = states.seen.dot(ph) + 1.0;
  const Eigen::VectorXd gain = states.step * ph / innovation_variance_;
  gain_.assign(gain.begin(), gain.end());
}

// A fixed number of columns at a time keeps their states in registers.
template <int Width>
void Whitening::apply_some(Columns& columns, Eigen::Index first) const {
  using Lane = Eigen::Array<double, Width, 1>;
  const std::size_t m = factor_.size();
  std::vector<Lane, Eigen::aligned_allocator<Lane>> state(gain_.size());
  const Eigen::Index stride = columns.cols();
  const Lane unseen = Lane::Zero();
  const auto go_on = [&](const Lane& e) {
    for (std::size_t i = 0; i < m; ++i) state[i] = factor_[i] * state[i] + gain_[i] * e;
    for (std::size_t h = 0, i = m; h < turns_.size(); ++h, i += 3) {
      const Lane x = turns_[h].cosine * state[i] - turns_[h].sine * state[i + 1] + gain_[i] * e;
      state[i + 1] = turns_[h].sine * state[i] + turns_[h].cosine * state[i + 1] + gain_[i + 1] * e;
      state[i + 2] = state[i] + gain_[i + 2] * e;
      state[i] = x;
    }
  };
  for (const BlockRange& record : grid_.records) {
    std::fill(state.begin(), state.end(), Lane::Zero());
    for (std::size_t b = record.first; b < record.end; ++b) {
      Eigen::Map<Lane> row(columns.data() + static_cast<Eigen::Index>(b) * stride + first);
      if (!grid_.valid[b]) {
        go_on(unseen);
        row.setZero();
        continue;
      }
      Lane e = row;
      for (std::size_t i = 0; i < m; ++i) e -= state[i];
      for (std::size_t h = 0, i = m; h < turns_.size(); ++h, i += 3)
        e -= state[i] + turns_[h].before * state[i + 2];
      go_on(e);
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

namespace {

// 1 + 2 sum of r^k cos, for a process with factor r = exp(-1 / decay) per block.
double poisson_kernel(double decay, double cycles) {
  const double r = std::exp(-1.0 / decay);
  return (1.0 - r * r) / (1.0 - 2.0 * r * std::cos(2.0 * std::numbers::pi * cycles) + r * r);
}

}  // namespace

double relative_density(const BlockGrid& grid, const NoiseShape& shape, double cycles) {
  double density = 1.0;
  const auto add = [&](double variance, double decay, double away) {
    density += variance * poisson_kernel(decay, away);
  };
  const double half_step = std::sin(std::numbers::pi * cycles);
  if (half_step != 0.0) density += shape.walk / (4.0 * half_step * half_step);
  if (shape.flicker > 0.0) {
    for (const double tau : flicker_bank(grid)) add(shape.flicker, tau, cycles);
  }
  for (const DampedHarmonic& each : shape.harmonics) {
    const double seen = 0.5 * each.variance * each.seen_at(cycles);
    add(seen, each.decay, cycles - each.cycles);
    add(seen, each.decay, cycles + each.cycles);
  }
  return density;
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
