// SPDX-License-Identifier: Apache-2.0
// The options of `ifog denoise`, and its results as JSON, text and picture.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "filters/settings/filter_settings.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/denoise/denoised_rows.h"
#include "tools/ifog/denoise/offline_chain.h"

namespace ifog::tools {

struct DenoiseOptions {
  std::string capture, output, model, config, sensor, json, picture, noise;
  double nominal_rate_hz = 0.0, start_up_s = 0.0;
  std::optional<std::uint64_t> first_sequence;
  std::optional<double> since_power_up_s;
  TimePart part;
  CaptureInput input;
  FilterChoice filter;
  bool smooth = false;

  // True if an option overrides the settings of a recording.
  [[nodiscard]] bool overrides_recording() const;
};

// --json.
[[nodiscard]] nlohmann::json denoise_json(const DenoiseOptions& options, const DenoisedRows& rows,
                                          const OfflineResult& result);
// Prints it, and warns of what is unusable, not corrected or not as published.
void tell_denoised(const DenoiseOptions& options, const DenoisedRows& rows, const OfflineResult& result);
// Draws the rate before and after, one row per axis and another if a model corrects it, with a common time
// axis. Throws as write_picture does.
void draw_denoised(const std::string& path, DenoisedRows& rows, const OfflineResult& result);

}  // namespace ifog::tools
