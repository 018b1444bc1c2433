// Any text as a capture: refused with one line, or read with columns of one length and
// time that goes on.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "drivers/capture/capture.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ifog::Capture capture;
  try {
    capture = ifog::parse_capture({reinterpret_cast<const char*>(data), size}, "capture");
  } catch (const std::runtime_error&) {
    return 0;
  }
  if (capture.size() == 0 || capture.axes.empty() || capture.rate_radps.size() != capture.axes.size() ||
      capture.reference_rate_radps.size() != capture.axes.size())
    std::abort();
  for (const auto& rate : capture.rate_radps)
    if (rate.size() != capture.size()) std::abort();
  for (const auto& channel : capture.channels)
    if (channel.values.size() != capture.size()) std::abort();
  for (std::size_t i = 0; i < capture.size(); ++i)
    if (std::isnan(capture.time_s[i]) || (i != 0 && capture.time_s[i] <= capture.time_s[i - 1])) std::abort();
  return 0;
}
