// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/flight/sample_remarks.h"

#include "drivers/capture/capture_builder.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {

void say_of_samples(const CaptureBuilder& builder, const std::string& path) {
  if (builder.counts().missing != 0)
    warn("%s: %zu samples are missing by the device's counter or clock\n", path.c_str(),
         builder.counts().missing);
  if (builder.counts().restarts != 0)
    warn("%s: the device's counter or clock jumped back %zu times: was it switched off and on?\n",
         path.c_str(), builder.counts().restarts);
  if (builder.counts().clock_sets != 0)
    warn(
        "%s: the device's clock was set %zu times while it measured on; there its times are by its counter "
        "or its rate\n",
        path.c_str(), builder.counts().clock_sets);
  if (builder.counts().repeated != 0)
    warn("%s: %zu samples came twice or after one that follows, and are dropped\n", path.c_str(),
         builder.counts().repeated);
  if (builder.counts().mixed != 0)
    warn("%s: %zu samples come from two devices, mixed, and are dropped: which of them is wanted?\n",
         path.c_str(), builder.counts().mixed);
  if (builder.impossible() != 0)
    warn("%s: %zu values of channels cannot be, in the unit of their name: dropped\n", path.c_str(),
         builder.impossible());
  for (const std::string& line :
       not_measured_in_words(builder.at_full_scale(), builder.implausible(), builder.counts().untold))
    warn("%s: %s\n", path.c_str(), line.c_str());
}

}  // namespace ifog::tools
