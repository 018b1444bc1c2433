// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/diagnose/sensor_diagnosis.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <exception>
#include <filesystem>
#include <list>
#include <numeric>
#include <stdexcept>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/utc_now.h"
#include "filters/diagnosis/channels/derived_channels.h"
#include "filters/diagnosis/cleaning/steps.h"
#include "filters/diagnosis/report/prediction.h"
#include "filters/model_file/channel_names.h"
#include "filters/model_file/form.h"
#include "filters/model_file/sha256.h"
#include "filters/series/finite_sum.h"
#include "filters/threads/share_out.h"
#include "filters/units/field_units.h"
#include "filters/units/told_time.h"
#include "tools/ifog/captures/usable_axes.h"
#include "tools/ifog/console/command_line.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/progress.h"
#include "tools/report/pages/diagnosis_page.h"

namespace ifog::tools {
namespace {

// A model reads such a name as the difference of two columns.
bool reads_as_difference(const std::string& name) { return !names_in(name).less.empty(); }

Record record_of(const CaptureView& capture, const std::string& name, std::size_t axis) {
  Record record;
  record.name = name;
  record.time_s = capture.time_s;
  record.origin = {static_cast<double>(capture.origin.s), static_cast<double>(capture.origin.ns) / 1e9};
  record.since_power_up_s = capture.since_power_up_s.value_or(0.0);
  record.rate_radps = capture.rate_radps[axis];
  if (!capture.reference_rate_radps[axis].empty())
    record.reference_radps = capture.reference_rate_radps[axis];
  record.reference_name = of_axis("reference_rate", capture.axes[axis]) + "_radps";
  for (const CaptureView::Channel& column : capture.channels)
    if (!reads_as_difference(column.name)) record.channels.push_back({column.name, column.values});
  for (std::size_t other = 0; other < capture.axes.size(); ++other) {
    if (other == axis) continue;
    record.other_axes.push_back({rate_of_axis(capture.axes[other]), capture.rate_radps[other]});
    record.other_references.emplace_back(capture.reference_rate_radps[other]);
  }
  return record;
}

// Bits are compared because NaN is not equal to itself.
std::uint64_t bits(double rate) { return std::bit_cast<std::uint64_t>(rate); }

bool same_row(const CaptureView& a, std::size_t i, const CaptureView& b, std::size_t j) {
  for (std::size_t axis = 0; axis < a.rate_radps.size(); ++axis)
    if (bits(a.rate_radps[axis][i]) != bits(b.rate_radps[axis][j])) return false;
  return true;
}

struct Common {
  std::size_t rows = 0;
  double from_s = 0.0, to_s = 0.0;
};

// Rows with equal times if the rates are equal in all of them: two parts of one record. None if a row
// differs, as in records that both begin at 0.
Common common_rows(const CaptureView& a, const CaptureView& b) {
  if (a.size() == 0 || b.size() == 0 || a.rate_radps.size() != b.rate_radps.size()) return {};
  const double later_s = b.origin.later_than(a.origin);  // origin of b's times
  const auto first = [](const CaptureView& of, double from_s) {
    return static_cast<std::size_t>(std::ranges::lower_bound(of.time_s, from_s) - of.time_s.begin());
  };
  // With different origins, equal times differ by rounding.
  const double room_s = later_s == 0.0 ? 0.0 : 0.5e-9;
  Common found;
  for (std::size_t i = first(a, b.time_s.front() + later_s - room_s),
                   j = first(b, a.time_s.front() - later_s - room_s);
       i < a.size() && j < b.size();) {
    const double apart_s = a.time_s[i] - (b.time_s[j] + later_s);
    if (std::abs(apart_s) > room_s) {
      ++(apart_s < 0.0 ? i : j);
      continue;
    }
    if (!same_row(a, i, b, j)) return {};
    if (found.rows++ == 0) found.from_s = a.shown_time_s(i);
    found.to_s = a.shown_time_s(i);
    ++i;
    ++j;
  }
  return found;
}

// A record that is given twice, as a copy, in another format or in overlapping parts, would count as twice
// the evidence.
void require_each_once(const std::vector<CaptureView>& captures, const std::vector<std::string>& names) {
  constexpr std::size_t kByChance = 100;  // rows of a coarse sensor at rest
  for (std::size_t later = 1; later < captures.size(); ++later)
    for (std::size_t c = 0; c < later; ++c) {
      const Common common = common_rows(captures[c], captures[later]);
      const bool whole = common.rows == captures[c].size() && common.rows == captures[later].size();
      if (!whole && common.rows <= kByChance) continue;
      const std::string where =
          whole ? "" : " from " + told_time(common.from_s) + " to " + told_time(common.to_s) + " s";
      throw refusal("{}: holds the same samples as {}{}, expected each record once", names[later], names[c],
                    where);
    }
}

// Mean of the finite values; 0 if there are none.
double mean_of(std::span<const double> values) {
  const FiniteSum finite = finite_sum(values);
  return finite.count > 0.0 ? finite.sum / finite.count : 0.0;
}

// Earth's rate in a triad at rest: the mean rate along the mean specific force is its vertical component, for
// any mounting. "" unless there are three gyros and three accelerometers, and the mean is known to a latitude of
// six degrees.
std::string vertical_rate(const CaptureView& capture, const std::vector<AxisDiagnosis>& found) {
  if (capture.axes != std::vector<std::string>{"x", "y", "z"}) return "";
  std::array<std::span<const double>, 6> columns;  // rates, then accelerations
  for (std::size_t a = 0; a < 3; ++a) {
    columns[a] = capture.rate_radps[a];
    const auto accel = std::ranges::find(capture.channels, "accel_" + capture.axes[a] + "_mps2",
                                         &CaptureView::Channel::name);
    if (accel == capture.channels.end()) return "";
    columns[3 + a] = accel->values;
  }
  std::array<double, 6> means{};
  std::ranges::transform(columns, means.begin(), mean_of);
  const std::span<const double> rate = std::span(means).first(3), force = std::span(means).last(3);
  const double g = std::sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]);
  if (g < 9.0 || g > 10.5) return "";
  constexpr double kEarth = 7.292115e-5;  // rad/s, WGS 84
  const double up = (rate[0] * force[0] + rate[1] * force[1] + rate[2] * force[2]) / g;
  const std::vector<double> span_s{capture.time_s.back() - capture.time_s.front()};
  double variance = 0.0;  // of the noisiest axis
  for (const AxisDiagnosis& each : found)
    variance = std::max(variance, mean_variance(each.diagnosis.noise_posterior, span_s));
  if (std::abs(up) > kEarth || variance > std::pow(0.1 * kEarth, 2)) return "";
  return fmt::format(
      "the rate along the mean specific force is {:.3f} °/h; if the sensor stood still, that is the "
      "Earth's rate at latitude {:.2f}°",
      up / kDegreePerHour, std::asin(up / kEarth) / kDegree);
}

}  // namespace

void AxesToDiagnose::add_earth_to(const Command& command) {
  command.add_flag("--earth", options.subtract_earth_rate,
                   "subtract what is the Earth's rate by its size in a gyro that tilts or is turned; "
                   "otherwise it is shown");
  command.add_taken<double>(
      "--latitude", [this](double degrees) { options.latitude_rad = degrees * kDegree; },
      "of the captures, degrees: bounds what can be the Earth's rate", {.range = within(-90.0, 90.0)});
}

std::vector<Record> records_of(const std::vector<CaptureView>& captures,
                               const std::vector<std::string>& names, std::size_t axis) {
  std::vector<Record> records;
  for (std::size_t c = 0; c < captures.size(); ++c) {
    if (captures[c].axes != captures.front().axes)
      throw refusal("{}: has other axes than {}", names[c], names[0]);
    records.push_back(record_of(captures[c], names[c], axis));
  }
  return records;
}

namespace {

// Calls work(); its errors become one line that names a capture.
template <typename Work>
auto naming_a_capture(const std::vector<std::string>& names, const Work& work) {
  try {
    return work();
  } catch (const std::invalid_argument& error) {
    // The diagnosis names one of several captures itself.
    const std::string what = error.what();
    const bool named =
        std::ranges::any_of(names, [&](const std::string& name) { return what.starts_with(name + ": "); });
    throw std::runtime_error(named ? what : names.front() + ": " + what);
  }
}

std::vector<AxisDiagnosis> diagnose_each(const std::vector<CaptureView>& captures,
                                         const std::vector<std::string>& names,
                                         const std::vector<std::size_t>& axes, const AxesToDiagnose& wanted) {
  if (axes.empty()) return {};
  Progress progress("diagnose", axes.size() * (wanted.options.most_effects + 1));
  std::vector<std::atomic<std::size_t>> steps(axes.size());  // done, by axis
  std::vector<AxisDiagnosis> found(axes.size());
  std::vector<std::exception_ptr> failed(axes.size());
  // One thread per axis: with two processors and two threads, the third axis would leave one idle.
  const auto threads = wanted.threads == 0 ? static_cast<unsigned>(axes.size()) : wanted.threads;
  share_out(axes.size(), threads, [&](std::size_t i) {
    DiagnoseOptions own = wanted.options;
    own.axis = found[i].axis = captures.front().axes[axes[i]];
    own.progress = [&, i](std::size_t done, std::size_t) {
      steps[i] = done;
      progress.at(std::accumulate(steps.begin(), steps.end(), std::size_t{0}));
    };
    try {
      const std::vector<Record> records = records_of(captures, names, axes[i]);
      found[i].diagnosis = naming_a_capture(names, [&] { return diagnose(records, own); });
    } catch (...) {
      failed[i] = std::current_exception();
    }
  });
  // Reports the failure of the first axis, independent of which failed first.
  for (const std::exception_ptr& failure : failed)
    if (failure) std::rethrow_exception(failure);
  return found;
}

}  // namespace

std::vector<AxisDiagnosis> diagnose_axes(const std::vector<CaptureView>& captures,
                                         const std::vector<std::string>& names,
                                         const AxesToDiagnose& wanted) {
  const std::vector<std::string>& axes = captures.front().axes;
  for (const std::string& axis : wanted.axes)
    if (std::ranges::find(axes, axis) == axes.end())
      throw refusal("{}: --axis is {}, expected {}", names[0], in_quotes(axis), expected_axes(axes));
  require_each_once(captures, names);
  std::vector<std::size_t> chosen;
  for (std::size_t axis = 0; axis < axes.size(); ++axis)
    if (wanted.axes.empty() || std::ranges::find(wanted.axes, axes[axis]) != wanted.axes.end())
      chosen.push_back(axis);
  std::vector<AxisDiagnosis> found = diagnose_each(captures, names, chosen, wanted);
  if (!found.empty())
    for (const CaptureView& capture : captures) {
      auto& remarks = found.front().diagnosis.remarks;
      remarks.insert(remarks.begin(), capture.faults.begin(), capture.faults.end());
      for (const CaptureView::Channel& column : capture.channels)
        if (reads_as_difference(column.name))
          remarks.push_back(
              in_quotes(column.name) +
              " was dropped: \" - \" in a name stands for a difference of two columns; another name "
              "(--column) makes it a channel");
    }
  const std::string earth = captures.size() == 1 ? vertical_rate(captures.front(), found) : "";
  if (!found.empty() && !earth.empty()) found.front().diagnosis.remarks.push_back(earth);
  return found;
}

Model model_with(Model model, const std::vector<AxisDiagnosis>& found, const std::vector<std::string>& names,
                 const std::vector<std::string>& hashes) {
  for (const AxisDiagnosis& each : found) {
    add_to_model(each.diagnosis, each.axis, model);
    const std::string prefix = each.axis.empty() ? "" : each.axis + ".";
    for (const auto& [name, value] : each.diagnosis.before) model.source.before[prefix + name] = value;
    for (const auto& [name, value] : each.diagnosis.after) model.source.after[prefix + name] = value;
  }
  model.source.capture.clear();
  for (const std::string& path : names)
    model.source.capture += (model.source.capture.empty() ? "" : ", ") + printable(path, kLongestMessage);
  std::string all;
  for (const std::string& hash : hashes) all += hash;
  model.source.sha256 = hashes.size() == 1 ? all : sha256_hex(all);
  model.source.date = utc_now();
  return model;
}

std::string diagnosis_report(const std::vector<CaptureView>& captures,
                             const std::vector<AxisDiagnosis>& found, const std::vector<std::string>& names,
                             const std::vector<std::string>& hashes, const std::string& model_path,
                             const std::string& read_with) {
  report::Page page;
  page.captures = names;
  page.sensor = std::filesystem::path(names.front()).filename().string();
  page.model_path = model_path;
  page.read_with = read_with;
  page.made = utc_now() + " by ifog " IFOG_VERSION;
  page.command = typed_command();
  for (std::size_t c = 0; c < captures.size(); ++c)
    page.inputs.push_back({names[c], hashes[c], captures[c].comments});
  const std::vector<std::string>& axes = captures.front().axes;
  std::list<OwnedRecords> drawn;
  for (const AxisDiagnosis& each : found) {
    report::PageAxis axis{each.axis, &each.diagnosis, {}};
    const auto index = static_cast<std::size_t>(std::ranges::find(axes, each.axis) - axes.begin());
    const std::vector<Record> records = records_of(captures, names, index);
    OwnedRecords derived = with_differences(records);
    // Drawn without the correction of the other references.
    for (Record& record : derived.records) record.other_references.clear();
    drawn.push_back(with_other_axes(std::move(derived)));
    axis.records = drawn.back().records;
    page.axes.push_back(std::move(axis));
  }
  return report::diagnosis_page(page);
}

}  // namespace ifog::tools
