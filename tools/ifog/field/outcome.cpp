// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/ifog/field/models.h"

namespace ifog::tools {

PromiseVerdict verdict_of(const std::vector<AxisGain>& gain) {
  constexpr std::array kWorstFirst{PromiseVerdict::broken, PromiseVerdict::open, PromiseVerdict::in_part};
  for (const PromiseVerdict each : kWorstFirst)
    if (gain.empty() ? each == PromiseVerdict::open : std::ranges::any_of(gain, [&](const AxisGain& axis) {
          return verdict(axis.kept) == each;
        }))
      return each;
  return PromiseVerdict::kept;
}

std::string outcome(const std::vector<AxisGain>& gain, const std::string& why_not) {
  if (gain.empty()) return "whether the promise came true cannot be judged: " + why_not;
  std::string figures;
  for (const AxisGain& axis : gain) {
    figures += (figures.empty() ? "" : ", ") + (axis.axis.empty() ? "" : axis.axis + ": ") +
               (std::isfinite(axis.kept.share_error)
                    ? fmt::format("{:.0f} ± {:.0f} % of the predicted improvement was achieved",
                                  100.0 * axis.kept.share, 100.0 * axis.kept.share_error)
                    : "the new model's correction did not move");
  }
  if (const std::string errors = gain_text(gain); !errors.empty()) figures += "; " + errors;
  switch (verdict_of(gain)) {
    case PromiseVerdict::kept:
      return "the promise came true: " + figures;
    case PromiseVerdict::in_part:
      return "the promise came true in part: " + figures;
    case PromiseVerdict::broken:
      return "the promise was broken, the model before was better: " + figures;
    case PromiseVerdict::open:
      break;
  }
  return "whether the promise came true cannot be judged yet, too little has changed around the sensor: " +
         figures;
}

}  // namespace ifog::tools
