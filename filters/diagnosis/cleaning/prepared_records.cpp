// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/prepared_records.h"

namespace ifog {

// Differences are of channels without faults.
PreparedRecords::PreparedRecords(const std::vector<Record>& captures, const TimeShare& share,
                                 double significance, const PreparedChannels* channels)
    : channels_(channels != nullptr ? *channels : own_.emplace(captures)),
      quiet_(leave_out_knocks(channels_.of_axis(captures))),
      aligned_(align_references(quiet_.records)),
      derived_(with_other_axes(aligned_.records)),
      resting_(without_turns(derived_.records)),
      fitted_(share.whole() ? resting_.records : fitted_parts(resting_.records, share)),
      without_(take_out_ramps(fitted_, significance)) {
  if (channels_.has_faults() || !quiet_.values.empty()) logged_ = channels_.as_logged(captures);
}

const std::vector<Record>* PreparedRecords::as_logged() const { return logged_.empty() ? nullptr : &logged_; }

std::vector<std::string> PreparedRecords::remarks() const {
  std::vector<std::string> all = channels_.remarks_of_times();
  for (const auto* remarks : {&quiet_.remarks, &channels_.remarks(), &aligned_.remarks, &resting_.remarks})
    all.insert(all.end(), remarks->begin(), remarks->end());
  return all;
}

}  // namespace ifog
