// SPDX-License-Identifier: Apache-2.0
#include "filters/model_file/covariance.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "filters/model_file/form.h"

namespace ifog {
namespace {

constexpr double kRounding = 1e-6;  // of a correlation

std::string place(std::size_t row, std::size_t column) {
  return "row " + std::to_string(row + 1) + ", column " + std::to_string(column + 1);
}

}  // namespace

std::string covariance_flaw(const std::vector<double>& values, std::size_t size) {
  if (values.empty()) return "";
  const auto at = [&](std::size_t row, std::size_t column) { return values[row * size + column]; };
  const auto n = static_cast<Eigen::Index>(size);
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(n, n);
  for (std::size_t i = 0; i < size; ++i) {
    if (at(i, i) < 0.0) return "a negative variance in " + place(i, i);
    for (std::size_t j = 0; j < i; ++j) {
      const double scale = std::sqrt(at(i, i)) * std::sqrt(at(j, j));
      // An exactly known parameter has no covariance.
      if (scale == 0.0 ? at(i, j) != 0.0 || at(j, i) != 0.0
                       : !(std::abs(at(i, j)) <= scale * (1.0 + kRounding)))
        return "more than the variances allow in " + place(i, j);
      if (!(std::abs(at(i, j) - at(j, i)) <= kRounding * scale))
        return place(i, j) + " differs from " + place(j, i);
      if (scale > 0.0)
        correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = at(i, j) / scale;
    }
  }
  // Positive semidefinite except for rounding: with this addition to the diagonal a Cholesky factor exists.
  correlation.diagonal().array() += kRounding * static_cast<double>(size);
  return correlation.llt().info() == Eigen::Success ? ""
                                                    : "a combination of parameters has a negative variance";
}

std::vector<std::size_t> rows_in_file(const std::vector<Effect>& effects) {
  std::vector<std::size_t> rows;
  std::size_t row = 0;
  for (const Effect& effect : effects) {
    const std::size_t end = row + effect.parameters.size();
    const std::optional<Form> form = form_named(effect.form);
    for (; row < end; ++row)
      if (form && carries_over(*form)) rows.push_back(row);
  }
  return rows;
}

std::vector<double> of_rows(const std::vector<double>& values, std::size_t size,
                            std::span<const std::size_t> rows) {
  std::vector<double> picked;
  picked.reserve(rows.size() * rows.size());
  for (const std::size_t row : rows)
    for (const std::size_t column : rows) picked.push_back(values[row * size + column]);
  return picked;
}

std::vector<double> of_all_parameters(const std::vector<double>& in_file,
                                      const std::vector<Effect>& effects) {
  std::vector<double> errors;
  for (const Effect& effect : effects)
    for (const ModelParameter& each : effect.parameters) errors.push_back(each.std_error);
  const std::size_t size = errors.size();
  std::vector<double> all(size * size, 0.0);
  for (std::size_t i = 0; i < size; ++i) all[i * size + i] = errors[i] * errors[i];
  if (in_file.empty()) return all;
  const std::vector<std::size_t> rows = rows_in_file(effects);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < rows.size(); ++j)
      all[rows[i] * size + rows[j]] = in_file[i * rows.size() + j];
  return all;
}

}  // namespace ifog
