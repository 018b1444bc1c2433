// SPDX-License-Identifier: Apache-2.0
// Picture of a denoised capture.
#pragma once

#include <string>

#include "filters/units/told_time.h"
#include "tools/ifog/denoise/denoised_rows.h"
#include "tools/ifog/denoise/offline_chain.h"

namespace ifog::tools {

// The rate before and after, a row an axis and one more where a model corrects it, with one time axis below
// all of them. Throws as write_picture does.
void draw_denoised(const std::string& path, const DenoisedColumns& columns, const TimeOrigin& origin,
                   const OfflineResult& result);

}  // namespace ifog::tools
