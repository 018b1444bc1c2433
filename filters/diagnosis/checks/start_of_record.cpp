// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/start_of_record.h"

#include <cmath>

#include "filters/linear/normal_equations.h"

namespace ifog {
namespace {

// Least squares of y on free columns and on columns of unit prior variance; the square that is left.
double square_left(const Eigen::VectorXd& y, const Columns& free, const Columns& doubt, double prior) {
  Eigen::MatrixXd columns(y.size(), free.cols() + doubt.cols());
  columns << free, doubt;
  Eigen::MatrixXd gram = columns.transpose() * columns;
  gram.diagonal().tail(doubt.cols()).array() += prior;
  const Eigen::VectorXd right = columns.transpose() * y;
  return y.squaredNorm() - NormalEquations(gram, right).explained();
}

}  // namespace

double ratio_beside_the_start(const BlockData& data, const std::vector<Candidate>& model, std::size_t at,
                              const NoiseShape& shape) {
  Columns white = design(data, model);
  const Whitening filter(data.grid, shape);
  filter.apply(white);
  const Columns doubt = filter.doubt_at_start();
  const Eigen::Index mine = column_of(data.grid, model, at);
  const Eigen::Index width = model[at].width();
  const Eigen::Index behind = white.cols() - mine - width;
  Columns others(white.rows(), mine - 1 + behind);
  others << white.middleCols(1, mine - 1), white.rightCols(behind);
  const Columns all = white.rightCols(white.cols() - 1);
  const Eigen::VectorXd y = white.col(0);
  // Innovations have that variance in units of the white noise's, in which the doubt is measured.
  const double prior = filter.innovation_variance();
  const double with = square_left(y, all, doubt, prior);
  const double without = square_left(y, others, doubt, prior);
  return static_cast<double>(data.grid.used()) * std::log(without / with);
}

}  // namespace ifog
