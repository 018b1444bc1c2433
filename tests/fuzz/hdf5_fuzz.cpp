// SPDX-License-Identifier: Apache-2.0
// Any bytes as an HDF5 file, read by Debian's library in a separate process: rejected with one line, or
// columns of one length with increasing time. Faults of the library in its own process do not count. Its text
// output is read as in capture_fuzz.cpp.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/capture/hdf5/hdf5_text.h"
#include "tests/unit/capture/read_capture.h"

namespace {

using namespace ifog;

void one_line(const std::exception& error) {
  if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
}

void file(std::string bytes, const CsvLayout& layout) {
  try {
    InputFile input("capture.h5", std::move(bytes));
    const Table table = table_of([&](RowSink& sink) { return read_hdf5_rows(input, "", layout, sink); });
    if (table.time_s.empty()) std::abort();
    for (const CaptureColumn& column : table.columns)
      if (column.values.size() != table.time_s.size()) std::abort();
    for (std::size_t i = 0; i < table.time_s.size(); ++i)
      if (std::isnan(table.time_s[i]) || (i != 0 && table.time_s[i] <= table.time_s[i - 1])) std::abort();
  } catch (const std::runtime_error& error) {
    one_line(error);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  CsvLayout layout;
  if (data[size - 1] % 2 != 0) {
    layout.time = CsvTime::parse("t:ms");
    layout.columns = {CsvColumn::parse("rate_x_radps=g/x:deg"), CsvColumn::parse("temperature_degC=T")};
  }
  file({reinterpret_cast<const char*>(data), size}, layout);
  return 0;
}
