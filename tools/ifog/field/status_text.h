// SPDX-License-Identifier: Apache-2.0
// Parts of status_t as text, for all commands that show a status.
#pragma once

#include <fmt/core.h>

#include <cstddef>
#include <ifog/status_t.hpp>
#include <string>
#include <vector>

#include "msgs/axis_name.h"

namespace ifog::tools {

// The balances of bytes, frames and samples, in parts between which a line may be broken.
inline std::vector<std::string> books_parts(const status_t& status) {
  const auto n = [](std::int64_t count) { return std::to_string(count); };
  std::vector<std::string> out;
  if (status.frames_read > 0)
    out = {"books: " + n(status.frames_read) + " CAN frames = " + n(status.frames_good) + " decoded",
           "+ " + n(status.frames_format) + " refused", "+ " + n(status.frames_other) + " not the sensor's;"};
  else
    out = {"books: " + n(status.bytes_read) + " bytes = " + n(status.bytes_framed) + " in frames",
           "+ " + n(status.bytes_skipped) + " skipped", "+ " + n(status.bytes_pending) + " pending;"};
  out.insert(out.end(),
             {n(status.samples_in) + " samples = " + n(status.samples_published) + " published",
              "+ " + n(status.samples_merged) + " merged", "+ " + n(status.lcm_failures) + " not sent",
              "+ " + n(status.samples_waiting) + " waiting,", n(status.samples_repeated) + " came twice"});
  return out;
}

// True if all balances of this message are exact.
inline bool books_balance(const status_t& s) {
  const bool of_can = s.frames_read > 0 || s.frames_other > 0;
  return s.bytes_read == s.bytes_framed + s.bytes_skipped + s.bytes_pending &&
         (!of_can || s.frames_read == s.frames_good + s.frames_format + s.frames_other) &&
         s.samples_decoded == s.samples_in + s.samples_repeated &&
         s.samples_in == s.samples_published + s.samples_merged + s.lcm_failures + s.samples_waiting;
}

// "x NIS 0.97, whiteness +0.01; y no value", from nis_mean and whiteness in status_t, or means of them. A
// mean square of exactly 0 means that the axis had no value.
inline std::string axis_health(const std::vector<double>& nis, const std::vector<double>& whiteness) {
  std::string out;
  for (std::size_t a = 0; a < nis.size(); ++a) {
    out += a == 0 ? "" : "; ";
    out += axis_name(a, nis.size());
    out += nis[a] == 0.0 ? " no value" : fmt::format(" NIS {:.3f}, whiteness {:+.3f}", nis[a], whiteness[a]);
  }
  return out;
}

// A rate with one decimal, or with two significant digits below 1 Hz.
inline std::string in_hertz(double rate_hz) {
  return rate_hz > 0.0 && rate_hz < 1.0 ? fmt::format("{:.2g} Hz", rate_hz)
                                        : fmt::format("{:.1f} Hz", rate_hz);
}

}  // namespace ifog::tools
