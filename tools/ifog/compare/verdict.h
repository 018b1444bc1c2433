// SPDX-License-Identifier: Apache-2.0
// Finds the rule with the smallest error, against the reference if there is one, otherwise at rest, and the
// excess of the others, as text and as a picture.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "filters/compare/compare.h"

namespace ifog::tools {

struct Verdict {
  std::string figure;    // as in the JSON: "rmse_radps", "adev_radps 1", "std_radps"
  std::size_t best = 0;  // in the order of the rules
  double best_radps = 0.0, raw_radps = 0.0;
  std::vector<double> above;  // by rule: its figure divided by the best one, minus 1
  std::string text;           // one line
};

Verdict verdict_of(const Comparison& result, int axis);

// For each axis: the rate and its Allan deviation, raw and with the best rule, and the deviations of the
// other rules relative to the best. The title is the verdict. Throws as write_picture does.
void draw_comparison(const std::string& path, const CaptureView& capture, const Comparison& result,
                     const std::vector<std::string>& rules, const std::vector<Verdict>& verdicts);

}  // namespace ifog::tools
