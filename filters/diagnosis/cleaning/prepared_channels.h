// SPDX-License-Identifier: Apache-2.0
// What the diagnoses of all axes of a sensor begin with: stamps that scatter set even, angles without their
// wraps, channels' faults repaired, differences of channels beside, the clock looked at. Nothing of it is of
// a rate, so it is done once. Each step's records show columns that the step before owns, so all of it stays
// together.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/channels/derived_channels.h"
#include "filters/diagnosis/cleaning/channel_faults.h"
#include "filters/diagnosis/record.h"
#include "filters/diagnosis/record/fitted_part.h"
#include "filters/series/samples.h"

namespace ifog {

// Records whose time stamps scatter, by the even clock that their samples were taken by: on their stamps they
// would fall on the same step of a grid twice and on the next one not at all.
struct TimedRecords {
  std::vector<Record> records;
  std::vector<Samples> times;        // owned, for the records
  std::vector<std::string> remarks;  // a sentence for each record whose stamps were not taken
};

// The dwells of a rate table, and steps that are uneven in themselves, stay as they are stamped.
TimedRecords with_even_stamps(const std::vector<Record>& records);

class PreparedChannels {
 public:
  // captures: of any one axis; their arrays outlive this. threads: channels looked at at a time, 0: as many
  // as there are processors. Throws std::invalid_argument as check_columns() does.
  explicit PreparedChannels(const std::vector<Record>& captures, unsigned threads = 1);
  PreparedChannels(const PreparedChannels&) = delete;
  PreparedChannels& operator=(const PreparedChannels&) = delete;

  // The same captures as records of an axis: its rates, with these times and channels. Throws
  // std::invalid_argument as check_columns() does.
  [[nodiscard]] std::vector<Record> of_axis(const std::vector<Record>& captures) const;
  // Likewise, with channels before their faults were repaired.
  [[nodiscard]] std::vector<Record> as_logged(const std::vector<Record>& captures) const;
  [[nodiscard]] bool has_faults() const { return !repaired_.values.empty(); }
  // In the order of the steps: of times, and of channels.
  [[nodiscard]] std::vector<std::string> remarks_of_times() const;
  [[nodiscard]] const std::vector<std::string>& remarks() const { return repaired_.remarks; }

 private:
  [[nodiscard]] std::vector<Record> with_rates_of(const std::vector<Record>& captures,
                                                  const std::vector<Record>& channels) const;

  TimedRecords timed_;
  DerivedRecords unwrapped_;
  RepairedRecords repaired_;
  DerivedRecords whole_;  // of them, with differences
};

}  // namespace ifog
