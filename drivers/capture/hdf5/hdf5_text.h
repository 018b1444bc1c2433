// SPDX-License-Identifier: Apache-2.0
// Converts an HDF5 file to CSV text with all digits (comments, names, units, rows), so that the CSV reader
// handles it.
//
// The HDF5 library trusts its input: a damaged file can crash it or keep it busy forever. So it runs in a
// separate process with limited memory and processor time, which cannot load code or open other files. If
// that process dies the file is rejected with one line.
#pragma once

#include <string>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {

// Reads a capture from HDF5: each column is a one-dimensional dataset with its CSV name. group: path of the
// group (or table of records); "": root. layout: as for CSV, with dataset paths as headers; units default to
// the attribute `units`. Without a layout all datasets of the group are columns, and an attribute that
// contradicts a name is an error. Errors and missing values are as in CSV; rows count from 1. Throws
// std::runtime_error with one line, possibly after rows were passed.
RowNotes read_hdf5_rows(InputFile& file, const std::string& group, const CsvLayout& layout, RowSink& sink);

}  // namespace ifog
