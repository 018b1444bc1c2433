// SPDX-License-Identifier: Apache-2.0
// A capture: recorded data of a sensor as columns. CSV with optional `#` lines, and a header: first time_s,
// then rate_radps or rate_x_radps … per axis, optionally reference_rate_radps per axis, and environment
// channels NAME_UNIT. Empty or `nan` means missing. `.gz` is read and written through zlib.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/times/row_sink.h"
#include "drivers/capture/times/time_stamps.h"

namespace ifog {

struct CaptureColumn {
  std::string name;            // as in the header
  std::vector<double> values;  // NaN: missing
};

struct Capture {
  std::vector<std::string> comments;                      // without the '#'
  std::vector<double> time_s;                             // strictly increasing, never NaN
  std::vector<std::string> axes;                          // "x", "y", "z", or one "" for a single-axis sensor
  std::vector<std::vector<double>> rate_radps;            // by axis
  std::vector<std::vector<double>> reference_rate_radps;  // by axis; empty vectors if there is none
  std::vector<CaptureColumn> channels;                    // all other columns
  std::vector<std::string> dead_axes;  // axes of the sensor that were dropped because they never have a value
  std::vector<std::string> notices;    // of the reader, about ambiguous content
  std::vector<std::string> faults;     // cells read as missing, one line per column
  std::optional<double> since_power_up_s;  // of the sensor at the first row, if known
  TimeOrigin origin;                       // of time_s

  [[nodiscard]] std::size_t size() const { return time_s.size(); }
};

// Views of a capture's columns, in memory or mapped from a file. Members as in Capture.
struct CaptureView {
  struct Channel {
    std::string name;
    std::span<const double> values;
  };

  std::vector<std::string> comments;
  TimeOrigin origin;  // of time_s
  std::span<const double> time_s;
  std::vector<std::string> axes, dead_axes;
  std::vector<std::span<const double>> rate_radps;
  std::vector<std::span<const double>> reference_rate_radps;  // by axis; empty if there is none
  std::vector<Channel> channels;
  std::vector<std::string> faults;
  std::optional<double> since_power_up_s;

  CaptureView() = default;
  CaptureView(const Capture& capture);  // must outlive this

  // Time of a row as shown to the user.
  [[nodiscard]] double shown_time_s(std::size_t row) const { return origin.in_s(time_s[row]); }
  [[nodiscard]] std::size_t size() const { return time_s.size(); }
};

// Roles of the columns with these names in a capture.
struct CaptureShape {
  struct Place {
    enum class Kind { rate, reference, channel } kind;
    std::size_t at;  // axis, or channel
  };
  std::vector<std::string> axes;
  std::vector<Place> places;  // by column
  std::size_t channels = 0;
};
// notes: for messages. Throws std::runtime_error with one line: no rate, a reference without its rate.
CaptureShape capture_shape(const std::vector<std::string>& names, const std::string& path,
                           const RowNotes& notes);

}  // namespace ifog
