// SPDX-License-Identifier: Apache-2.0
// Driver `capture`: a CSV capture as a sensor; each row is a sample with the row's time as device time. For
// trying the daemon with a recording, by the file transport.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/plugins/capture/rows.h"
#include "ifog/byte_driver.h"
#include "ifog/driver.h"
#include "ifog/options.h"

namespace ifog::capture_rows {
namespace {

constexpr std::array kOptions{
    ifog_option{"columns", "rate_radps or rate_AXIS_radps, then channels; comma separated", "rate_radps",
                "columns of the capture to take, by their names in its header"},
    ifog_option{"rate_hz", "a number >= 0", "0", "samples a second; 0: unknown"},
    ifog_option{nullptr, nullptr, nullptr, nullptr}};

struct SetUp {
  std::vector<std::string> axes;      // "x", …, or one ""
  std::vector<std::string> channels;  // environment columns
  double rate_hz = 0.0;

  // Columns in the order of samples: rates, then channels.
  [[nodiscard]] std::vector<std::string> columns() const {
    std::vector<std::string> all;
    for (const std::string& axis : axes)
      all.push_back(axis.empty() ? "rate_radps" : "rate_" + axis + "_radps");
    all.insert(all.end(), channels.begin(), channels.end());
    return all;
  }
};

SetUp read_set_up(const plugin::Options& options) {
  constexpr std::string_view kPrefix = "rate_", kUnit = "_radps";
  SetUp s;
  s.rate_hz = options.number("rate_hz", 0.0, 1e6, "a number from 0 to 1000000");
  std::string_view rest = options.text("columns");
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    std::string_view name = rest.substr(0, comma);
    more = comma != std::string_view::npos;
    rest.remove_prefix(more ? comma + 1 : rest.size());
    while (!name.empty() && name.front() == ' ') name.remove_prefix(1);
    while (!name.empty() && name.back() == ' ') name.remove_suffix(1);
    if (name.empty() || name.size() >= IFOG_NAME_LENGTH || name == "time_s")
      options.fail("columns", "names of 1 to 47 letters between commas, without time_s");
    const std::string_view axis =
        name.starts_with(kPrefix) && name.ends_with(kUnit) && name.size() > 11
            ? name.substr(kPrefix.size(), name.size() - kPrefix.size() - kUnit.size())
            : std::string_view{};
    if (name == "rate_radps" || (!axis.empty() && axis.find('_') == std::string_view::npos))
      s.axes.emplace_back(axis);
    else
      s.channels.emplace_back(name);
  }
  const std::vector<std::string> all = s.columns();
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (all[i] == all[k]) options.fail("columns", "each name once");
  if (s.axes.empty() || s.axes.size() > IFOG_MAX_AXES)
    options.fail("columns",
                 "1 to " + std::to_string(IFOG_MAX_AXES) + " rate columns, rate_radps or rate_x_radps, …");
  if (s.channels.size() > IFOG_MAX_ENVIRONMENT)
    options.fail("columns", "at most " + std::to_string(IFOG_MAX_ENVIRONMENT) + " channels");
  return s;
}

class Driver {
 public:
  explicit Driver(const plugin::Options& options) : Driver(read_set_up(options)) {}
  explicit Driver(SetUp set_up) : set_up_(std::move(set_up)), rows_(set_up_.columns()) { forget(); }

  void describe(ifog_description& out) const {
    out = {};
    out.kind = IFOG_RATE;
    out.axes = static_cast<std::uint32_t>(set_up_.axes.size());
    for (std::size_t i = 0; i < set_up_.axes.size(); ++i) plugin::set_name(out.axis[i], set_up_.axes[i]);
    out.has_device_time = 1;
    out.nominal_rate_hz = set_up_.rate_hz;
    out.environments = static_cast<std::uint32_t>(set_up_.channels.size());
    for (std::size_t i = 0; i < set_up_.channels.size(); ++i)
      plugin::set_name(out.environment[i], set_up_.channels[i]);
  }

  void decode(std::span<const std::uint8_t> bytes, std::int64_t arrival_ns, ifog_emit_sample emit,
              void* sink) noexcept {
    rows_.feed(bytes, [&](std::int64_t time_ns, std::span<const double> values) {
      const std::size_t axes = set_up_.axes.size();
      sample_.arrival_ns = arrival_ns;
      sample_.device_time_ns = time_ns;
      sample_.flags = IFOG_SAMPLE_DEVICE_TIME;
      sample_.valid_axes = sample_.environment_fresh = 0;
      for (std::size_t i = 0; i < axes; ++i) {
        sample_.value[i] = values[i];
        if (std::isfinite(values[i])) sample_.valid_axes |= 1U << i;
      }
      for (std::size_t i = 0; i < set_up_.channels.size(); ++i) {
        if (!std::isfinite(values[axes + i])) continue;  // the last value stays
        sample_.environment[i] = values[axes + i];
        sample_.environment_fresh |= 1U << i;
      }
      emit(sink, &sample_);
    });
  }

  void reset() noexcept {
    rows_.restart();
    forget();
  }

  void counters(ifog_driver_counters& out) const { out = rows_.counters(); }

 private:
  void forget() noexcept {
    sample_ = {};
    for (double& value : sample_.environment) value = std::numeric_limits<double>::quiet_NaN();
  }

  SetUp set_up_;
  Rows rows_;
  ifog_sample sample_{};
};

constexpr ifog_driver kTable =
    plugin::byte_driver<Driver>("capture", "1", "a CSV capture as a sensor, row by row", kOptions.data());

}  // namespace
}  // namespace ifog::capture_rows

const ifog_driver* ifog_driver_entry(void) { return &ifog::capture_rows::kTable; }
