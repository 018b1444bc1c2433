// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/tune/noise_left.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <span>
#include <utility>
#include <vector>

#include "drivers/ifog/quoted.h"
#include "filters/allan/stretches.h"
#include "filters/tune/tune.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/captures/model_axes.h"
#include "tools/ifog/tune/rest_columns.h"

namespace ifog::tools {
namespace {

constexpr std::size_t kMostRows = 200000;  // default of `ifog tune`

TunedModel fitted(const CaptureView& rates, const std::string& state, const std::string& path) {
  const double period_s = sample_clock(rates.time_s).period_s;
  const Rest rest = mostly_at_rest(rates, period_s, path);
  const RestColumns columns = rest_columns(rates, rest, period_s, rates.size());
  const std::vector<std::span<const double>> axes(columns.rate_radps.begin(), columns.rate_radps.end());
  TuneOptions options;
  options.states = {state};
  options.hold_out = false;
  return tune(axes, period_s, options).models.front();
}

}  // namespace

std::string fit_noise_left(Model& model, const Model& added, const CaptureView& capture,
                           const std::string& path) {
  const bool known =
      model.filter && (model.filter->process_noise > 0.0 || model.filter->measurement_noise > 0.0);
  if (known && added.effects.empty()) return "";
  FilterSettings filter = model.filter.value_or(FilterSettings{});
  CaptureView rates = rows_of(capture, {0, std::min(capture.size(), kMostRows)});
  try {
    std::vector<Samples> left = compensated_rates(rates, added);
    for (std::size_t a = 0; a < left.size(); ++a) {
      const std::span<const double> reference = rates.reference_rate_radps[a];
      for (std::size_t i = 0; i < reference.size(); ++i) left[a][i] -= reference[i];
      rates.rate_radps[a] = left[a];
      rates.reference_rate_radps[a] = {};
    }
    const TunedModel found = fitted(rates, filter.state, path);
    std::string text = fmt::format(
        "noise of the filter, fitted to the corrected rate: process_noise {:.4g} (rad/s)^2/s, "
        "measurement_noise {:.4g} (rad/s)^2",
        found.settings.process_noise, found.settings.measurement_noise);
    filter.process_noise = found.settings.process_noise;
    filter.measurement_noise = found.settings.measurement_noise;
    filter.state_parameters = found.settings.state_parameters;
    model.filter = std::move(filter);
    return text;
  } catch (const std::exception& error) {
    const std::string why = printable(error.what(), kLongestMessage);
    if (!known) return "no noise for the filter: " + why;
    return "noise of the filter stays as the model had it, fitted to the rate before this correction: " + why;
  }
}

}  // namespace ifog::tools
