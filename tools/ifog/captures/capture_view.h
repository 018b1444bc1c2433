// SPDX-License-Identifier: Apache-2.0
// Views of a capture's columns, in memory or mapped from a file.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"

namespace ifog::tools {

// Members as in Capture.
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

}  // namespace ifog::tools
