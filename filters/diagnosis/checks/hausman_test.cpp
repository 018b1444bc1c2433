// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/hausman_test.h"

#include <cmath>
#include <complex>
#include <numbers>

#include "filters/linear/projection.h"

namespace ifog {
namespace {

// w' V w for the noise model's covariance V over the records' valid blocks, in units of the white variance.
// w is zero elsewhere and sums to zero over each record, so a walk's unknown start does not count.
double quadratic_form(const BlockGrid& grid, const NoiseShape& shape, const Eigen::VectorXd& w) {
  double sum = w.squaredNorm();
  const auto add_markov = [&](double variance, double blocks) {
    const double f = std::exp(-1.0 / blocks);
    for (const BlockRange& record : grid.records) {
      double past = 0.0;  // sum over earlier blocks of f^distance w
      for (std::size_t b = record.first; b < record.end; ++b) {
        const double now = w[static_cast<Eigen::Index>(b)];
        sum += variance * now * (now + 2.0 * past);
        past = f * (past + now);
      }
    }
  };
  if (shape.flicker > 0.0) {
    for (const double tau : flicker_bank(grid)) add_markov(shape.flicker, tau);
  }
  if (shape.markov > 0.0) add_markov(shape.markov, shape.markov_s / grid.block_s);
  for (const DampedHarmonic& each : shape.harmonics) {
    const std::complex<double> step =
        std::polar(std::exp(-1.0 / each.decay), 2.0 * std::numbers::pi * each.cycles);
    for (const BlockRange& record : grid.records) {
      std::complex<double> past = 0.0;
      double before = 0.0;
      for (std::size_t b = record.first; b <= record.end; ++b) {
        // The weight of what lies between two blocks: of what it adds to the one and takes from the other.
        const double here = b < record.end ? w[static_cast<Eigen::Index>(b)] : 0.0;
        const double now = before - each.returned * here;
        sum += each.variance * now * (now + 2.0 * past.real());
        past = step * (past + now);
        before = here;
      }
    }
  }
  for (const BlockRange& record : grid.records) {
    if (!(shape.walk > 0.0)) break;
    double rest = 0.0;  // what a step of the walk adds to w' y
    for (std::size_t b = record.end; b-- > record.first;) {
      rest += w[static_cast<Eigen::Index>(b)];
      sum += shape.walk * rest * rest;
    }
  }
  return sum;
}

}  // namespace

double disagreement(const BlockGrid& grid, const NoiseFit& noise, const Columns& columns,
                    Eigen::Index nuisances, const Eigen::VectorXd& coefficients,
                    const Eigen::MatrixXd& covariance) {
  const Eigen::Index p = columns.cols() - 1 - nuisances;
  Eigen::MatrixXd centred(columns.rows(), p + 1);
  centred << columns.col(0), columns.rightCols(p);
  for (const BlockRange& record : grid.records) {
    Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(p + 1);
    double count = 0.0;
    for (std::size_t b = record.first; b < record.end; ++b) {
      if (!grid.valid[b]) continue;
      mean += centred.row(static_cast<Eigen::Index>(b));
      count += 1.0;
    }
    if (count > 0.0) mean /= count;
    for (std::size_t b = record.first; b < record.end; ++b) {
      const auto row = static_cast<Eigen::Index>(b);
      if (grid.valid[b]) {
        centred.row(row) -= mean;
      } else {
        centred.row(row).setZero();
      }
    }
  }
  const Eigen::MatrixXd x = centred.rightCols(p);
  Eigen::VectorXd last = x.col(p - 1);
  if (p > 1) Projection(x.leftCols(p - 1)).take_out_of(last);
  const double square = last.squaredNorm();
  if (!(square > 1e-12 * x.col(p - 1).squaredNorm())) return 0.0;
  const Eigen::VectorXd w = last / square;
  const double plain = w.dot(centred.col(0));
  const double variance = noise.white_variance * quadratic_form(grid, noise.shape, w);
  const double known = covariance(covariance.rows() - 1, covariance.cols() - 1);
  const double difference = plain - coefficients[coefficients.size() - 1];
  return std::abs(difference) / std::sqrt(std::max(variance - known, 1e-3 * variance));
}

}  // namespace ifog
