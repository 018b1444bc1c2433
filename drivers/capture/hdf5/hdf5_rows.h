// SPDX-License-Identifier: Apache-2.0
// A capture in HDF5: each column a one-dimensional dataset under the name that it has in a CSV file.
#pragma once

#include <string>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {

// group: "" or the path of the group (or table of records) that holds the columns. layout: as of a CSV file,
// its headers being paths of datasets from there; a column whose unit it leaves out is in the one that the
// dataset's attribute `units` says. Without a layout every dataset of the group is a column, and one whose
// attribute contradicts its name is refused. Refused and taken for missing is what is in a CSV file; rows are
// counted from 1. As there, what is wrong further down may be found when rows were taken, and an angle that
// is to become a rate makes one block of all. Throws std::runtime_error with one line.
RowNotes read_hdf5_rows(InputFile& file, const std::string& group, const CsvLayout& layout, RowSink& sink);

}  // namespace ifog
