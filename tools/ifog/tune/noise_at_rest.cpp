// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/tune/noise_at_rest.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"
#include "filters/allan/stretches.h"
#include "filters/tune/tune.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/console/errors.h"

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

Rest rest_of(const CaptureView& capture, double period_s) {
  std::vector<std::span<const double>> rates(capture.rate_radps.begin(), capture.rate_radps.end()),
      references;
  for (const CaptureView::Channel& channel : capture.channels)
    if (is_other_rate(channel.name)) rates.emplace_back(channel.values);
  for (const std::span<const double> reference : capture.reference_rate_radps)
    if (!reference.empty()) references.emplace_back(reference);
  return find_rest(rates, references, period_s);
}

Rest mostly_at_rest(const CaptureView& capture, double period_s, const std::string& path) {
  Rest rest = rest_of(capture, period_s);
  try {
    require_rest(rest, period_s, capture.shown_time_s(0));
  } catch (const std::invalid_argument& error) {
    const bool referenced = std::ranges::any_of(capture.reference_rate_radps,
                                                [](const auto& reference) { return !reference.empty(); });
    throw refusal("{}: {}{}", path, error.what(),
                  referenced ? "; a sensor turned with a reference is for ifog diagnose" : "");
  }
  return rest;
}

RestColumns rest_columns(const CaptureView& capture, const Rest& rest, double period_s, std::size_t most) {
  RestColumns out;
  out.rate_radps.resize(capture.axes.size());
  const std::size_t rows = std::min(capture.size(), most);
  out.left_out = capture.size() - rows;
  // Longer gaps are shortened, and all gaps together to ten times the rows: missing samples do not help the
  // fit.
  constexpr double kLongestHole = 10000.0;
  std::size_t room = 10 * rows, part = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    const double steps =
        row == 0 ? 1.0 : std::round((capture.time_s[row] - capture.time_s[row - 1]) / period_s);
    const auto hole = static_cast<std::size_t>(std::clamp(steps - 1.0, 0.0, kLongestHole));
    const std::size_t missing = std::min(hole, std::max<std::size_t>(room, 1));
    room -= std::min(room, missing);
    while (part < rest.at_rest.size() && rest.at_rest[part].end <= row) ++part;
    const bool resting = part < rest.at_rest.size() && rest.at_rest[part].begin <= row;
    constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t a = 0; a < out.rate_radps.size(); ++a) {
      std::vector<double>& column = out.rate_radps[a];
      column.resize(column.size() + missing, kMissing);
      column.push_back(resting ? capture.rate_radps[a][row] : kMissing);
    }
  }
  return out;
}

}  // namespace ifog::tools
