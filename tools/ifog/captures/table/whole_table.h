// SPDX-License-Identifier: Apache-2.0
// What is there as a whole, for what works on pieces.
#pragma once

#include "drivers/capture/capture.h"
#include "tools/ifog/captures/table/long_table.h"

namespace ifog::tools {

LongTable long_table(Capture capture);

}  // namespace ifog::tools
