// SPDX-License-Identifier: Apache-2.0
// Any text as a capture, with its own header and with selected columns: rejected with one line, or read into
// columns of one length with increasing time.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "tests/unit/capture/read_capture.h"

namespace {

void read(std::string_view text, const ifog::CsvLayout& layout) {
  ifog::Capture capture;
  try {
    capture = ifog::parse_capture(text, "capture", layout);
  } catch (const std::runtime_error&) {
    return;
  }
  if (capture.size() == 0 || capture.axes.empty() || capture.rate_radps.size() != capture.axes.size() ||
      capture.reference_rate_radps.size() != capture.axes.size())
    std::abort();
  for (const auto& rate : capture.rate_radps) {
    if (rate.size() != capture.size()) std::abort();
    for (const double value : rate)
      if (std::abs(value) > 1.0001e4) std::abort();
  }
  for (const auto& channel : capture.channels)
    if (channel.values.size() != capture.size()) std::abort();
  for (std::size_t i = 0; i < capture.size(); ++i)
    if (std::isnan(capture.time_s[i]) || (i != 0 && capture.time_s[i] <= capture.time_s[i - 1])) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  read(text, {});
  ifog::CsvLayout chosen;
  chosen.separator = ';';
  chosen.time = ifog::CsvTime::parse("t:ms");
  chosen.columns = {ifog::CsvColumn::parse("rate_x_radps=g:deg/s"),
                    ifog::CsvColumn::parse("rate_y_radps=a:deg"),
                    ifog::CsvColumn::parse("temperature_degC=T:degF")};
  read(text, chosen);
  return 0;
}
