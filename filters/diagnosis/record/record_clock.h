// SPDX-License-Identifier: Apache-2.0
// When the samples of a record were taken: looked at once for all that ask, the axes of a sensor among them.
#pragma once

#include "filters/diagnosis/record.h"

namespace ifog {

// As sample_clock() of its times. Throws as that does.
[[nodiscard]] SampleClock clock_of(const Record& record);
// As usual_step() of its times.
[[nodiscard]] double usual_step_of(const Record& record);

// From now on both are known, of copies with the same times as well.
void look_at_clock(Record& record);

}  // namespace ifog
