// SPDX-License-Identifier: Apache-2.0
// Faults of logging: a thermometer that says 85 or -127 °C for some seconds (power-on and bus error of the
// DS18B20), a glitch of the logger; and knocks of the rate.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filters/diagnosis/record.h"
#include "filters/series/samples.h"

namespace ifog {

struct RepairedRecords {
  std::vector<Record> records;       // as given, but for the columns repaired
  std::vector<Samples> values;       // which those columns' spans show; keep as long as `records`
  std::vector<std::string> remarks;  // one a fault found, for people
};

// Values that cannot be the channel's, interpolated between those beside them:
// - leaps as the channel never makes, and back within a minute; of channels that do not move slowly only
//   those of twenty spans, for a blow is no fault of an accelerometer;
// - one number but zero, again and again, twenty spans from all that is usual, in a tenth of the record at
//   most: no reading, and missing where it stands for more than a minute.
// Channels of a few values are left alone: a switch may be off for an hour. Missing values stay missing.
// threads: channels looked at at a time; 0: as many as there are processors.
RepairedRecords repair_channels(const std::vector<Record>& records, unsigned threads = 1);

// Of the rate, a sample or two that leap by twenty spans and back become missing.
RepairedRecords leave_out_knocks(const std::vector<Record>& records);

}  // namespace ifog
