// SPDX-License-Identifier: Apache-2.0
// Allan deviation as a picture: logarithmic axes, confidence bands and the fitted noise terms.
#pragma once

#include <string>
#include <vector>

#include "tools/ifog/allan/allan_record.h"
#include "tools/report/chart.h"

namespace ifog::tools {

report::Chart allan_chart(const std::string& title, const std::vector<AllanRecord>& records);
void draw_allan(const std::string& path, const std::vector<AllanRecord>& records);

}  // namespace ifog::tools
