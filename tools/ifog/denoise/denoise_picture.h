// SPDX-License-Identifier: Apache-2.0
// Picture of a denoised capture.
#pragma once

#include <string>

#include "tools/ifog/denoise/denoised_rows.h"
#include "tools/ifog/denoise/offline_chain.h"

namespace ifog::tools {

// The rate before and after, one row per axis and another if a model corrects it, with a common time axis.
// Throws as write_picture does.
void draw_denoised(const std::string& path, DenoisedRows& rows, const OfflineResult& result);

}  // namespace ifog::tools
