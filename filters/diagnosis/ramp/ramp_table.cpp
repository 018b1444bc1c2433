// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/ramp_table.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "filters/diagnosis/ramp/ramp_comb.h"
#include "filters/linear/symmetric.h"

namespace ifog {
namespace {

using Complex = std::complex<double>;

constexpr Eigen::Index kRows = 512;  // summed at a time
constexpr std::size_t kStep = 4;     // harmonics more at each trial
constexpr std::size_t kPhasePieces = 32;
constexpr Eigen::Index kFirstHarmonics = 8;  // harmonics that any table has
constexpr double kWalkSeen = 0.1;            // of the phase that blurs the table: a smaller walk is not told

struct TableSums {
  Eigen::MatrixXd gram;
  Eigen::VectorXd moment;
};

// Rates that cosine and sine of each harmonic of one radian make, one sample.
template <class Row>
void fill(Row&& row, double k, double before_rad, double now_rad, double sample_s) {
  const Complex before = carrier_of(k * before_rad);
  const Complex now = carrier_of(k * now_rad);
  Complex power_before = 1.0;
  Complex power_now = 1.0;
  for (Eigen::Index h = 0; 2 * h < row.size(); ++h) {
    power_before *= before;
    power_now *= now;
    const Complex rate = (power_now - power_before) / sample_s;
    row[2 * h] = rate.real();
    row[2 * h + 1] = rate.imag();
  }
}

std::array<TableSums, kRampParts> sums_by_part(const UnbrokenPart& part, double k, Eigen::Index columns) {
  std::array<TableSums, kRampParts> sums;
  for (TableSums& each : sums)
    each = {Eigen::MatrixXd::Zero(columns, columns), Eigen::VectorXd::Zero(columns)};
  Eigen::MatrixXd rows(columns, kRows);
  Eigen::VectorXd error(kRows);
  Eigen::Index filled = 0;
  const auto add_to = [&](TableSums& into) {
    if (filled == 0) return;
    into.gram.selfadjointView<Eigen::Lower>().rankUpdate(rows.leftCols(filled));
    into.moment += rows.leftCols(filled) * error.head(filled);
    filled = 0;
  };
  for (std::size_t i = 1; i < part.size(); ++i) {
    fill(rows.col(filled), k, part.angle_rad[i - 1], part.angle_rad[i], part.sample_s);
    error[filled++] = part.error_radps[i];
    const std::size_t now = ramp_part(i, part.size());
    const bool last = i + 1 == part.size() || ramp_part(i + 1, part.size()) != now;
    if (last || filled == kRows) add_to(sums[now]);
  }
  for (TableSums& each : sums) {
    each.gram = each.gram.selfadjointView<Eigen::Lower>();
    for (Eigen::Index i = 0; i < columns; ++i) {
      if (!part.stroboscopic(k, static_cast<std::size_t>(i / 2 + 1))) continue;
      each.gram.row(i).setZero();
      each.gram.col(i).setZero();
      each.moment[i] = 0.0;
    }
  }
  return sums;
}

// Of a column: each harmonic has two, its cosine and its sine.
double order_of(Eigen::Index column) {
  const Eigen::Index order = column / 2 + 1;
  return static_cast<double>(order);
}

// Variance of a sample over that of the harmonics' angles times their squared order, which is much the same
// for all harmonics of anything with an edge. At a constant rate a harmonic may stand still from sample to
// sample: without this its angle is anything, and at another rate a large error.
double stiffness(const TableSums& sums, double variance) {
  const Eigen::Index columns = std::min<Eigen::Index>(sums.moment.size(), 2 * kFirstHarmonics);
  const Eigen::VectorXd first =
      SymmetricSolver(sums.gram.topLeftCorner(columns, columns)).solve(sums.moment.head(columns));
  double square = 0.0;
  for (Eigen::Index i = 0; i < columns; ++i) {
    const double order = order_of(i);
    square += order * order * first[i] * first[i] / static_cast<double>(columns);
  }
  return variance / std::max(square, 1e-300);
}

Eigen::VectorXd solved(const TableSums& sums, Eigen::Index columns, double stiff) {
  Eigen::MatrixXd gram = sums.gram.topLeftCorner(columns, columns);
  for (Eigen::Index i = 0; i < columns; ++i) {
    const double order = order_of(i);
    gram(i, i) += stiff * order * order;
    // A stroboscopic one has no column of its own.
    if (!(sums.gram(i, i) > 0.0)) gram(i, i) = 1.0;
  }
  return SymmetricSolver(gram).solve(sums.moment.head(columns));
}

double explained(const TableSums& sums, const Eigen::VectorXd& table) {
  const Eigen::Index n = table.size();
  return table.dot(2.0 * sums.moment.head(n) - sums.gram.topLeftCorner(n, n) * table);
}

// What tables without each part explain of that part, all together.
double held_out_gain(const std::array<TableSums, kRampParts>& parts, const TableSums& all,
                     Eigen::Index columns, double stiff, std::array<Eigen::VectorXd, kRampParts>& without) {
  double gain = 0.0;
  for (std::size_t p = 0; p < kRampParts; ++p) {
    const TableSums others{all.gram - parts[p].gram, all.moment - parts[p].moment};
    without[p] = solved(others, columns, stiff);
    gain += explained(parts[p], without[p]);
  }
  return gain;
}

// The phase against k times the angle, piece by piece, to first order; and what k leaves uncertain.
void measure_phase(const UnbrokenPart& part, double square_left, RampTable& table) {
  const auto samples = static_cast<double>(part.size());
  const double variance = square_left / samples;
  std::vector<double> phase;
  std::vector<double> error;
  double information = 0.0;
  const double middle = 0.5 * (part.angle_rad.back() + part.angle_rad.front());
  Eigen::VectorXd row(table.harmonics.size());
  Eigen::VectorXd slopes(table.harmonics.size());
  for (Eigen::Index h = 0; 2 * h < slopes.size(); ++h) {
    const double order = 2.0 * std::numbers::pi * static_cast<double>(h + 1);
    slopes[2 * h] = order * table.harmonics[2 * h + 1];
    slopes[2 * h + 1] = -order * table.harmonics[2 * h];
  }
  for (std::size_t p = 0; p < kPhasePieces; ++p) {
    double along = 0.0;
    double square = 0.0;
    for (std::size_t i = 1 + p * (part.size() - 1) / kPhasePieces;
         i < 1 + (p + 1) * (part.size() - 1) / kPhasePieces; ++i) {
      fill(row, table.cycles_per_rad, part.angle_rad[i - 1], part.angle_rad[i], part.sample_s);
      const double slope = row.dot(slopes);
      along += slope * (part.error_radps[i] - row.dot(table.harmonics));
      square += slope * slope;
      const double away = slope * (part.angle_rad[i] - middle);
      information += away * away;
    }
    phase.push_back(square > 0.0 ? along / square : 0.0);
    error.push_back(square > 0.0 ? variance / square : 0.0);
  }
  const double piece_s = samples * part.sample_s / static_cast<double>(kPhasePieces);
  // Means over two neighbouring pieces of a walk differ by two thirds of what it makes in one.
  double walk = 0.0;
  for (std::size_t p = 1; p < kPhasePieces; ++p) {
    const double step = phase[p] - phase[p - 1];
    walk += (step * step - error[p] - error[p - 1]) / (2.0 / 3.0 * piece_s * (kPhasePieces - 1));
  }
  const double span_s = samples * part.sample_s;
  const double least = kWalkSeen / (2.0 * std::numbers::pi * order_of(table.harmonics.size() - 1));
  table.phase_walk = std::sqrt(std::max(walk, least * least / span_s));
  table.walk_error = table.phase_walk / std::sqrt(2.0 * static_cast<double>(kPhasePieces - 1));
  const double turned = std::abs(part.angle_rad.back() - part.angle_rad.front());
  const double by_walk = 1.2 * table.phase_walk * table.phase_walk * span_s / (turned * turned);
  table.cycles_error = std::sqrt(variance / std::max(information, 1e-300) + by_walk);
}

}  // namespace

std::vector<double> RampTable::one_cycle() const {
  const Eigen::Index values = 2 * harmonics.size();
  std::vector<double> cycle(static_cast<std::size_t>(values), 0.0);
  for (Eigen::Index i = 0; i < values; ++i) {
    const Complex turn = carrier_of(static_cast<double>(i) / static_cast<double>(values));
    Complex carrier = 1.0;
    for (Eigen::Index h = 0; 2 * h < harmonics.size(); ++h) {
      carrier *= turn;
      cycle[static_cast<std::size_t>(i)] +=
          harmonics[2 * h] * carrier.real() + harmonics[2 * h + 1] * carrier.imag();
    }
  }
  return cycle;
}

RampSettings RampTable::settings() const { return {cycles_per_rad, one_cycle(), noise_density, phase_walk}; }

RampTable RampTable::without(std::size_t part) const {
  RampTable other = *this;
  other.harmonics = harmonics_without[part];
  return other;
}

std::optional<RampTable> fit_ramp_table(const UnbrokenPart& part, const RampComb& comb) {
  const std::size_t most = std::min(
      {kMostHarmonics, comb.harmonics + comb.harmonics / 4 + 2 * kStep, part.size() / (40 * kRampParts)});
  const std::array<TableSums, kRampParts> parts =
      sums_by_part(part, comb.cycles_per_rad, static_cast<Eigen::Index>(2 * most));
  TableSums all = parts[0];
  for (std::size_t p = 1; p < kRampParts; ++p) {
    all.gram += parts[p].gram;
    all.moment += parts[p].moment;
  }
  double square = 0.0;
  for (const double error : part.error_radps) square += error * error;
  const double stiff = stiffness(all, square / static_cast<double>(part.size()));
  RampTable table;
  table.cycles_per_rad = comb.cycles_per_rad;
  double best = 0.0;
  for (std::size_t harmonics = std::min<std::size_t>(2, most); harmonics <= most;
       harmonics += harmonics < kStep ? 1 : kStep) {
    const auto columns = static_cast<Eigen::Index>(2 * harmonics);
    std::array<Eigen::VectorXd, kRampParts> without;
    const double gain = held_out_gain(parts, all, columns, stiff, without);
    if (gain <= best) continue;
    best = gain;
    table.harmonics = solved(all, columns, stiff);
    table.harmonics_without = std::move(without);
  }
  if (best <= 0.0) return std::nullopt;
  square -= explained(all, table.harmonics);
  table.noise_density = std::sqrt(square / static_cast<double>(part.size()) * part.sample_s);
  table.noise_error = table.noise_density / std::sqrt(2.0 * static_cast<double>(part.size()));
  const Eigen::Index columns = table.harmonics.size();
  Eigen::MatrixXd gram = all.gram.topLeftCorner(columns, columns);
  for (Eigen::Index i = 0; i < columns; ++i)
    gram(i, i) += gram(i, i) > 0.0 ? stiff * std::pow(order_of(i), 2.0) : 1e300;
  table.angle_error =
      std::sqrt(0.5 * square / static_cast<double>(part.size()) * SymmetricSolver(gram).inverse().trace());
  measure_phase(part, square, table);
  return table;
}

}  // namespace ifog
