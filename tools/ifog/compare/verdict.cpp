// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/compare/verdict.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>

#include "filters/units/field_units.h"

namespace ifog::tools {
namespace {

struct VerdictFigure {
  const char *key, *words;
  std::optional<double> (*of)(const ComparisonRow&);
};
// The first figure that every row has is used.
constexpr std::array kVerdictFigures{
    VerdictFigure{"rmse_radps", "error against the reference",
                  [](const ComparisonRow& row) { return row.rmse_radps; }},
    VerdictFigure{"adev_radps 1", "Allan deviation at 1 s",
                  [](const ComparisonRow& row) { return row.adev_radps[1]; }},
    VerdictFigure{"adev_radps 0.1", "Allan deviation at 0.1 s",
                  [](const ComparisonRow& row) { return row.adev_radps[0]; }},
    VerdictFigure{"std_radps", "standard deviation",
                  [](const ComparisonRow& row) { return std::optional(row.std_radps); }}};

}  // namespace

Verdict verdict_of(const Comparison& result, int axis) {
  constexpr double kAlike = 0.01;
  std::vector<const ComparisonRow*> rows;  // raw first
  for (const ComparisonRow& row : result.rows)
    if (row.axis == axis) rows.push_back(&row);
  const VerdictFigure& figure =
      *std::find_if(kVerdictFigures.begin(), kVerdictFigures.end() - 1, [&](const VerdictFigure& each) {
        return std::all_of(rows.begin(), rows.end(),
                           [&](const ComparisonRow* row) { return each.of(*row).has_value(); });
      });
  Verdict out{figure.key, 0, *figure.of(*rows.at(1)), *figure.of(*rows[0]), {}, {}};
  for (std::size_t r = 1; r < rows.size(); ++r)
    if (const double value = *figure.of(*rows[r]); value < out.best_radps) {
      out.best = r - 1;
      out.best_radps = value;
    }
  std::string alike;
  double most = 0.0;
  std::size_t others = 0;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const double above = out.best_radps > 0.0 ? *figure.of(*rows[r]) / out.best_radps - 1.0 : 0.0;
    out.above.push_back(above);
    most = std::max(most, above);
    if (above > kAlike) ++others;
    if (above <= kAlike && r - 1 != out.best) alike += (alike.empty() ? "" : ", ") + rows[r]->rule;
  }
  out.text = fmt::format("{}: {} {:.4g} °/h, raw {:.4g}", rows[out.best + 1]->rule, figure.words,
                         out.best_radps / kDegreePerHour, out.raw_radps / kDegreePerHour);
  out.text =
      (out.best_radps < out.raw_radps ? "best is " : "none is better than raw, the best rule is ") + out.text;
  if (others == 0)
    out.text += fmt::format("; all rules within {:.2g} % of it", 100.0 * most);
  else
    out.text += (alike.empty() ? "" : "; within 1 % of it " + alike) +
                fmt::format("; others up to {:.3g} % above", 100.0 * most);
  return out;
}

}  // namespace ifog::tools
