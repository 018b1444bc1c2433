// SPDX-License-Identifier: Apache-2.0
// Any bytes as what comes through the barrier from the process that reads HDF5 ('s' and the stream), and any
// bytes as an HDF5 file, read by Debian's library behind that barrier: refused with one line, or columns of
// one length and time that goes on. What the library does to its own process must not be seen here.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "drivers/capture/hdf5/column_stream.h"
#include "drivers/capture/hdf5/hdf5_rows.h"

namespace {

using namespace ifog;

void one_line(const std::exception& error) {
  if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
}

void stream(std::span<const char> bytes) {
  const auto receive = [&](std::span<char> to) {
    if (bytes.size() < to.size()) return false;
    std::memcpy(to.data(), bytes.data(), to.size());
    bytes = bytes.subspan(to.size());
    return true;
  };
  try {
    ColumnStream columns(receive);
    std::vector<std::vector<double>> block;
    std::uint64_t rows = 0;
    while (columns.next(block)) {
      if (block.size() != columns.header().names.size()) std::abort();
      for (const auto& column : block)
        if (column.empty() || column.size() != block.front().size()) std::abort();
      rows += block.front().size();
    }
    if (rows != columns.header().rows) std::abort();
  } catch (const std::length_error&) {
  } catch (const std::runtime_error& error) {
    one_line(error);
  }
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
  const std::span<const char> text(reinterpret_cast<const char*>(data), size);
  if (data[0] == 's') {
    stream(text.subspan(1));
    return 0;
  }
  CsvLayout layout;
  if (data[size - 1] % 2 != 0) {
    layout.time = CsvTime::parse("t:ms");
    layout.columns = {CsvColumn::parse("rate_x_radps=g/x:deg"), CsvColumn::parse("temperature_degC=T")};
  }
  file({text.begin(), text.end()}, layout);
  return 0;
}
