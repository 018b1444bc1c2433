// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/scan.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/search/search.h"
#include "filters/linear/projection.h"

namespace ifog {
namespace {

constexpr double kDependent = 1e-7;  // relative square below which two columns are equal

std::vector<NoiseShape> spread(const NoiseShape& shape, bool thorough) {
  std::vector<NoiseShape> shapes;
  const std::vector<double> walks =
      thorough ? std::vector<double>{1.0, 0.25, 0.05, 0.01, 1e-3, 0.0} : std::vector<double>{1.0, 0.1, 0.0};
  const std::vector<double> flickers =
      thorough ? std::vector<double>{1.0, 0.2, 0.0} : std::vector<double>{1.0, 0.0};
  for (const double w : walks) {
    for (const double f : flickers) {
      NoiseShape each = shape;
      each.walk *= w;
      each.flicker *= f;
      if (shape.walk == 0.0 && w != 1.0) continue;
      if (shape.flicker == 0.0 && f != 1.0) continue;
      shapes.push_back(each);
    }
  }
  // A harmonic may describe what an oscillating channel causes.
  for (std::size_t i = 0; i < shape.harmonics.size(); ++i) {
    NoiseShape each = shape;
    each.harmonics.erase(each.harmonics.begin() + static_cast<std::ptrdiff_t>(i));
    shapes.push_back(each);
  }
  return shapes;
}

// Reduction of the measurement's squared residual by one or two projected columns.
double gain_of(const Eigen::VectorXd& xy, const Eigen::VectorXd& xx, Eigen::Index j) {
  return xx[j] > 0.0 ? xy[j] * xy[j] / xx[j] : 0.0;
}

double gain_of(const Columns& columns, const Eigen::VectorXd& xy, const Eigen::VectorXd& xx,
               const std::pair<Eigen::Index, Eigen::Index>& pair) {
  const auto [i, j] = pair;
  const double both = columns.col(i).dot(columns.col(j));
  const double determinant = xx[i] * xx[j] - both * both;
  if (determinant <= kDependent * xx[i] * xx[j]) return 0.0;
  return (xy[i] * xy[i] * xx[j] - 2.0 * xy[i] * xy[j] * both + xy[j] * xy[j] * xx[i]) / determinant;
}

}  // namespace

Scan::Scan(const BlockData& data, std::vector<Candidate> candidates)
    : data_(data),
      candidates_(std::move(candidates)),
      columns_(static_cast<Eigen::Index>(data.grid.size()), static_cast<Eigen::Index>(candidates_.size())) {
  for (std::size_t i = 0; i < candidates_.size(); ++i) fill(i);
}

void Scan::add(const std::vector<Candidate>& more) {
  const std::size_t before = candidates_.size();
  for (const Candidate& candidate : more)
    if (!has_shape(candidates_, candidate)) candidates_.push_back(candidate);
  columns_.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(candidates_.size()));
  for (std::size_t i = before; i < candidates_.size(); ++i) fill(i);
}

void Scan::pair(const std::vector<NaturalPair>& pairs) {
  const auto index = [&](const Candidate& wanted) {
    const auto found = std::ranges::find_if(candidates_, [&](const Candidate& each) {
      return each.same_shape(wanted) && each.time_constant_s == wanted.time_constant_s;
    });
    return found == candidates_.end() ? -1 : static_cast<Eigen::Index>(found - candidates_.begin());
  };
  for (const NaturalPair& each : pairs) {
    const Eigen::Index first = index(each.first);
    const Eigen::Index second = index(each.second);
    if (first >= 0 && second >= 0) pairs_.emplace_back(first, second);
  }
}

// Columns of unit norm, as the channels' units differ by many decades.
void Scan::fill(std::size_t candidate) {
  Eigen::VectorXd column = regressor(data_, candidates_[candidate]);
  const double size = std::sqrt(column.squaredNorm() / static_cast<double>(column.size()));
  if (size > 0.0) column /= size;
  columns_.col(static_cast<Eigen::Index>(candidate)) = column;
}

Scan::Projected Scan::project(const std::vector<Candidate>& base, const NoiseShape& shape,
                              const Columns& candidates) const {
  const Columns fixed = design(data_, base);
  Columns all(fixed.rows(), fixed.cols() + candidates.cols());
  all << fixed, candidates;
  Whitening(data_.grid, shape).apply(all);
  const Projection others(all.middleCols(1, fixed.cols() - 1));
  Projected projected;
  projected.y = all.col(0);
  others.take_out_of(projected.y);
  projected.columns = all.rightCols(candidates.cols());
  const Eigen::RowVectorXd before = projected.columns.colwise().squaredNorm();
  others.take_out_of(projected.columns);
  // A column that equals a combination of the others except for rounding is ignored.
  for (Eigen::Index j = 0; j < candidates.cols(); ++j) {
    if (projected.columns.col(j).squaredNorm() < 1e-9 * before[j]) projected.columns.col(j).setZero();
  }
  projected.square = projected.y.squaredNorm();
  return projected;
}

std::vector<Scored> Scan::score(const FittedModel& base, bool thorough, const NoiseShape* further) const {
  std::vector<Scored> scored(candidates_.size() + (thorough ? pairs_.size() : 0));
  for (std::size_t i = 0; i < candidates_.size(); ++i) scored[i].candidate = candidates_[i];
  for (std::size_t i = candidates_.size(); i < scored.size(); ++i) {
    const auto& [first, second] = pairs_[i - candidates_.size()];
    scored[i].candidate = candidates_[static_cast<std::size_t>(first)];
    scored[i].with = candidates_[static_cast<std::size_t>(second)];
  }
  const auto n = static_cast<double>(data_.grid.used());
  std::vector<NoiseShape> shapes = spread(base.noise.shape, thorough);
  if (further) shapes.push_back(*further);
  for (const NoiseShape& shape : shapes) {
    const Projected p = project(base.effects, shape, columns_);
    const Eigen::VectorXd xy = p.columns.transpose() * p.y;
    const Eigen::VectorXd xx = p.columns.colwise().squaredNorm();
    for (std::size_t i = 0; i < scored.size(); ++i) {
      const double gain = i < candidates_.size() ? gain_of(xy, xx, static_cast<Eigen::Index>(i))
                                                 : gain_of(p.columns, xy, xx, pairs_[i - candidates_.size()]);
      if (!(gain > 0.0)) continue;
      const double left = std::max(p.square - gain, 1e-12 * p.square);
      const double ratio = 2.0 * (-0.5 * n * std::log(left / n) - base.noise.log_likelihood);
      if (ratio > scored[i].ratio) {
        scored[i].ratio = ratio;
        scored[i].shape = shape;
      }
    }
  }
  return scored;
}

Eigen::VectorXd Scan::correlations(const std::vector<Candidate>& base, const Candidate& effect,
                                   const NoiseShape& shape) const {
  Columns both(columns_.rows(), columns_.cols() + 1);
  both << columns_, regressor(data_, effect);
  const Columns projected = project(base, shape, both).columns;
  const Eigen::VectorXd size = projected.colwise().norm().cwiseMax(1e-150);
  const Eigen::VectorXd product = projected.transpose() * projected.rightCols(1);
  return (product.array() / size.array() / size[columns_.cols()]).head(columns_.cols());
}

std::vector<Scored> Scan::steps(const FittedModel& base) const {
  const BlockGrid& grid = data_.grid;
  std::vector<Scored> found;
  const auto n = static_cast<double>(grid.used());
  const NoiseShape& shape = base.noise.shape;
  const Projected p = project(base.effects, shape, Columns(static_cast<Eigen::Index>(grid.size()), 0));
  for (std::size_t r = 0; r < grid.records.size(); ++r) {
    const Eigen::Index from = grid.records[r].row();
    const Eigen::Index length = grid.records[r].rows();
    const Eigen::VectorXd h = answer_to_step(grid, shape, grid.records[r]);
    Eigen::VectorXd energy(length);
    double sum = 0.0;
    for (Eigen::Index k = 0; k < length; ++k) energy[k] = sum += h[k] * h[k];
    Scored best;
    for (Eigen::Index at = 4; at + 4 < length; ++at) {
      const Eigen::Index rest = length - at;
      const double xy = h.head(rest).dot(p.y.segment(from + at, rest));
      // The constant is projected out of the measurement but not yet out of the step.
      const double xx =
          energy[rest - 1] * std::max(0.05, shape.walk > 0.0 ? 1.0 : double(at) / double(length));
      const double left = std::max(p.square - xy * xy / xx, 1e-12 * p.square);
      const double ratio = 2.0 * (-0.5 * n * std::log(left / n) - base.noise.log_likelihood);
      if (ratio <= best.ratio) continue;
      best.ratio = ratio;
      best.shape = shape;
      best.candidate.form = Form::kStep;
      best.candidate.record = r;
      best.candidate.time_s = grid.time_s[static_cast<std::size_t>(from + at)] - 0.5 * grid.block_s;
    }
    if (best.ratio > 0.0) found.push_back(best);
  }
  return found;
}

}  // namespace ifog
