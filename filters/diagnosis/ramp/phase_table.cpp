// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/phase_table.h"

#include <Eigen/Dense>
#include <array>

#include "filters/linear/symmetric.h"

namespace ifog {
namespace {

constexpr double kSamplesAStep = 100.0;  // fewest samples per step of the table

struct Sums {
  Eigen::MatrixXd gram;
  Eigen::VectorXd moment;
  double square = 0.0, samples = 0.0;

  explicit Sums(Eigen::Index steps)
      : gram(Eigen::MatrixXd::Zero(steps, steps)), moment(Eigen::VectorXd::Zero(steps)) {}
};

// Weights of the table's steps next to the phases now and before. The first step is zero and has no column.
struct StepWeights {
  std::array<std::pair<Eigen::Index, double>, 4> entry{};
  std::size_t count = 0;

  void add(double cycles, Eigen::Index steps, double sign) {
    const double position = cycles * static_cast<double>(steps);
    const auto low = static_cast<Eigen::Index>(std::floor(position));
    const double share = position - std::floor(position);
    if (low > 0) entry[count++] = {low - 1, sign * (1.0 - share)};
    if (low < steps) entry[count++] = {low, sign * share};
  }
};

Sums sums_of(const std::vector<PhasedRecord>& records, Eigen::Index steps) {
  Sums sums(steps);
  for (const PhasedRecord& record : records) {
    each_phase_step(record, [&](std::size_t, const PhaseStep& step) {
      StepWeights weights;
      weights.add(step.now, steps, 1.0 / step.dt_s);
      weights.add(step.before, steps, -1.0 / step.dt_s);
      for (std::size_t a = 0; a < weights.count; ++a) {
        const auto& [row, weight] = weights.entry[a];
        sums.moment[row] += weight * step.error_radps;
        for (std::size_t b = 0; b < weights.count; ++b)
          sums.gram(row, weights.entry[b].first) += weight * weights.entry[b].second;
      }
      sums.square += step.error_radps * step.error_radps;
      sums.samples += 1.0;
    });
  }
  return sums;
}

SymmetricSolver solver_of(const Sums& sums) {
  Eigen::MatrixXd gram = sums.gram;
  gram.diagonal().array() += 1e-9 * gram.trace() / static_cast<double>(gram.rows());
  return SymmetricSolver(gram);
}

double explained(const Sums& sums, const Eigen::VectorXd& table) {
  return 2.0 * table.dot(sums.moment) - table.dot(sums.gram * table);
}

std::optional<PhaseTable> table_of(const std::vector<PhasedRecord>& records, Eigen::Index steps) {
  const Sums all = sums_of(records, steps);
  if (all.samples < kSamplesAStep * static_cast<double>(steps)) return std::nullopt;
  const SymmetricSolver solver = solver_of(all);
  PhaseTable table;
  table.angle_rad = solver.solve(all.moment);
  table.samples = all.samples;
  table.square = all.square;
  table.explained = explained(all, table.angle_rad);
  table.angle_error = std::sqrt(table.left() / table.samples * solver.inverse().diagonal().mean());
  return table;
}

}  // namespace

double angle_at(const Eigen::VectorXd& angle_rad, double cycles) {
  const double position = cycles * static_cast<double>(angle_rad.size());
  const auto low = std::min(static_cast<Eigen::Index>(position), angle_rad.size() - 1);
  const double from = low > 0 ? angle_rad[low - 1] : 0.0;
  return from + (position - static_cast<double>(low)) * (angle_rad[low] - from);
}

std::optional<PhaseTable> fit_phase_table(const std::vector<PhasedRecord>& records) {
  std::optional<PhaseTable> best;
  for (const Eigen::Index steps : {8, 16, 32, 64, 128}) {
    std::optional<PhaseTable> table = table_of(records, steps);
    if (!table) break;
    if (!best || table->score() > best->score()) best = std::move(table);
  }
  return best;
}

double explained_by_table(const std::vector<PhasedRecord>& records, Eigen::Index steps) {
  const Sums all = sums_of(records, steps);
  return explained(all, solver_of(all).solve(all.moment));
}

}  // namespace ifog
