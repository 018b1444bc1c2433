// SPDX-License-Identifier: Apache-2.0
// A capture's columns wherever they are, for what looks at all of a column and keeps none.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"

namespace ifog::tools {

// As Capture, whose words these are.
struct CaptureView {
  struct Channel {
    std::string name;
    std::span<const double> values;
  };

  std::vector<std::string> comments;
  TimeOrigin origin;  // that time_s is counted from
  std::span<const double> time_s;
  std::vector<std::string> axes, dead_axes;
  std::vector<std::span<const double>> rate_radps;
  std::vector<std::span<const double>> reference_rate_radps;  // by axis, empty where there is none
  std::vector<Channel> channels;
  std::vector<std::string> faults;
  std::optional<double> since_power_up_s;

  CaptureView() = default;
  CaptureView(const Capture& capture);  // which has to outlive this

  // Time of a row as shown to the user.
  [[nodiscard]] double told_time_s(std::size_t row) const { return origin.in_s(time_s[row]); }
  [[nodiscard]] std::size_t size() const { return time_s.size(); }
};

}  // namespace ifog::tools
