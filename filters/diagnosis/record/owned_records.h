// SPDX-License-Identifier: Apache-2.0
// Records with the columns that were made for them, as each step of the preparation takes and returns them.
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
  // Captures as they are given: the caller keeps their arrays.
  OwnedRecords(std::vector<Record> given) : records(std::move(given)) {}
  // A copy's records would show the columns of the first one.
  OwnedRecords(const OwnedRecords&) = delete;
  OwnedRecords& operator=(const OwnedRecords&) = delete;
  OwnedRecords(OwnedRecords&&) = default;
  OwnedRecords& operator=(OwnedRecords&&) = default;
  ~OwnedRecords() = default;

  // Which of them is meant, where there are several.
  [[nodiscard]] std::string of_several(const Record& record) const {
    return records.size() > 1 ? " (" + record.name + ")" : "";
  }

  std::vector<Record> records;
  std::list<Samples> columns;          // that the records' spans show
  std::vector<std::string> remarks;    // a sentence for each change, for people
  std::vector<ReferenceDelay> delays;  // of references that were shifted
};

}  // namespace ifog
