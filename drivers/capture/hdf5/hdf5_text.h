// SPDX-License-Identifier: Apache-2.0
// An HDF5 file as the text of a CSV file: comments, names, units, rows, with all digits. So what reads CSV
// reads HDF5 by the same rules.
//
// The library that reads HDF5 was made for files that it can trust: a damaged one can end the program or keep
// it busy for ever. So it runs in a process of its own, with bounded memory and processor time, without the
// right to load code or to open other files by links, and what comes from there is text that is read as any
// other. When it dies the file is refused with one line.
#pragma once

#include <string>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {

// A capture in HDF5: each column a one-dimensional dataset under the name that it has in a CSV file.
// group: path of the group (or table of records) that holds the columns; "" is the root. layout: as of a CSV
// file, its headers being paths of datasets from there; a column without a unit is in that of the dataset's
// attribute `units`. Without a layout every dataset of the group is a column, and one whose attribute
// contradicts its name is refused. What is refused or treated as missing is the same as in a CSV file, and rows
// count from 1. Throws std::runtime_error with one line, possibly after rows were handed on.
RowNotes read_hdf5_rows(InputFile& file, const std::string& group, const CsvLayout& layout, RowSink& sink);

}  // namespace ifog
