// SPDX-License-Identifier: Apache-2.0
// Tables that were merged from sensors of different rates: a gyro in every fourth row, empty cells between.
#pragma once

#include <string>

#include "tools/ifog/captures/table/long_table.h"

namespace ifog::tools {

// Where rows with a rate mostly stand apart, only they are kept, each with the channels' latest values since
// the one before: a rate's clock is of its own samples. Nothing where rates stand in neighbouring rows, be
// there holes. Adds a notice. name: of the capture.
void keep_rate_rows(LongTable& table, const std::string& name);

}  // namespace ifog::tools
