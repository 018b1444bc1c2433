// SPDX-License-Identifier: Apache-2.0
// Records together with the columns that the preparation made for them.
#pragma once

#include <list>
#include <string>
#include <utility>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"
#include "filters/series/samples.h"

namespace ifog {

struct OwnedRecords {
  // The caller keeps the arrays of the given records alive.
  OwnedRecords(std::vector<Record> given) : records(std::move(given)) {}
  // Not copyable: the copy's spans would refer to the columns of the original.
  OwnedRecords(OwnedRecords&&) = default;
  OwnedRecords& operator=(OwnedRecords&&) = default;

  // Suffix that names the record if there are several.
  [[nodiscard]] std::string of_several(const Record& record) const {
    return records.size() > 1 ? " (" + record.name + ")" : "";
  }

  std::vector<Record> records;
  std::list<Samples> columns;          // storage for spans of the records
  std::vector<std::string> remarks;    // one sentence for users per change
  std::vector<ReferenceDelay> delays;  // of references that were shifted
};

}  // namespace ifog
