// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/prepared_records.h"

#include "filters/diagnosis/record/blocks.h"

namespace ifog {
namespace {

const std::vector<Record>& checked(const std::vector<Record>& captures) {
  check_columns(captures);
  return captures;
}

}  // namespace

// Of a share of each record the rest is what judges, so there records stay whole. An angle's wraps are no
// faults, and differences are of channels without any.
PreparedRecords::PreparedRecords(const std::vector<Record>& captures, const TimeShare& share,
                                 double significance)
    : timed_(with_even_stamps(checked(captures))),
      parted_(share.whole() ? part_at_long_holes(timed_.records) : PartedRecords{timed_.records, {}}),
      unwrapped_(with_unwrapped_angles(parted_.records)),
      repaired_(repair_records(unwrapped_.records)),
      aligned_(align_references(repaired_.records)),
      derived_(with_derived_channels(aligned_.records)),
      resting_(without_turns(derived_.records)),
      fitted_(share.whole() ? resting_.records : fitted_parts(resting_.records, share)),
      without_(take_out_ramps(fitted_, significance)) {}

const std::vector<Record>* PreparedRecords::as_logged() const {
  return repaired_.values.empty() ? nullptr : &unwrapped_.records;
}

std::vector<std::string> PreparedRecords::remarks() const {
  std::vector<std::string> all;
  for (const auto* remarks :
       {&timed_.remarks, &parted_.remarks, &repaired_.remarks, &aligned_.remarks, &resting_.remarks})
    all.insert(all.end(), remarks->begin(), remarks->end());
  return all;
}

}  // namespace ifog
