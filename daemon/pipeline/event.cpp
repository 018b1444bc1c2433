// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/event.h"

#include <spdlog/fmt/fmt.h>

#include "drivers/ifog/quoted.h"
#include "drivers/units/units.h"

namespace ifog {

std::string describe(const Event& event) {
  switch (event.kind) {
    case EventKind::gap:
      return fmt::format("gap: {} sample(s) missing before number {}", event.count, event.sequence);
    case EventKind::device_restart:
      return fmt::format(
          "the device's counter or clock jumped back before number {}: was it switched off and on?",
          event.sequence);
    case EventKind::reopened:
      return "device open again";
    case EventKind::overflow:
      return fmt::format("ring full at number {}: increments are merged until the filter catches up",
                         event.sequence);
    case EventKind::noise_learned:
      return fmt::format(
          "noise learned at rest: process_noise = {:.4g} (rad/s)^2/s, measurement_noise = {:.4g} (rad/s)^2",
          event.a, event.b);
    case EventKind::model_in_use:
      return fmt::format("new model active from sample {}", event.sequence);
    case EventKind::divergence:
      return fmt::format("estimator diverged and started again at number {}", event.sequence);
    case EventKind::clock_step:
      return fmt::format(
          "the wall clock was set, now {:+.3f} s against start-up: times of day follow from number {} on, "
          "intervals and angles do not",
          event.a, event.sequence);
    case EventKind::sensor_clock_set:
      return fmt::format(
          "the device's clock was set before number {}: sensor_time_ns moved, times of day, intervals and "
          "angles did not",
          event.sequence);
    case EventKind::clock_refused:
      return fmt::format(
          "the device's clock {} by arrivals and number of samples: not used from number {} on; "
          "intervals and angles before have its error",
          clock_speed(event.a, kRightButJumps), event.sequence);
    case EventKind::label_moved:
      return fmt::format(
          "the device stood still for a while, or its deliveries take longer or shorter than before: times "
          "of day follow from number {} on, intervals and angles do not",
          event.sequence);
    case EventKind::beyond_stated:
      return fmt::format(
          "{} is {:g}, beyond the {:g} that the file states: kept, counted and flagged; only range_radps, "
          "minimum and maximum of the configuration make a value invalid",
          printable(event.name.data()), event.a, event.b);
    case EventKind::publish_failed:
      return fmt::format("LCM did not take number {}", event.sequence);
  }
  return "unknown event";
}

}  // namespace ifog
