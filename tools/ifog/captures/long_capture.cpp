// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/long_capture.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "drivers/capture/csv/text_cells.h"
#include "drivers/ifog/quoted.h"
#include "filters/effects/compensate_series.h"
#include "filters/model_file/channel_names.h"
#include "filters/model_file/covariance.h"
#include "filters/model_file/form.h"
#include "filters/units/told_time.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

// Line of the first effect of this channel, if the model was read from a file.
std::string place_of(const Model& model, const std::string& channel) {
  for (const Effect& effect : model.effects)
    for (const std::string& used : {effect.channel, effect.with_channel})
      if (const ChannelNames names = names_in(used);
          effect.line > 0 && (names.of == channel || names.less == channel))
        return " in line " + std::to_string(effect.line);
  return "";
}

}  // namespace

void TimePart::add_to(const Command& command, const std::string& of_from, const std::string& of_to) {
  const auto add = [&command](const char* name, Bound& bound, const std::string& help) {
    const auto take = [name, &bound](const std::string& text) {
      const std::optional<SaidTime> said = SaidTime::parse(text);
      if (!said)
        throw WrongUsage(
            name, "is " + in_quotes(text) + ", expected a number of seconds or a date, 2026-05-01T12:00:00Z");
      static_cast<SaidTime&>(bound) = *said;
      bound.text = text;
    };
    command.add_taken<std::string>(name, take, help, {.type = "TIME"});
  };
  add("--from", from, of_from);
  add("--to", to, of_to);
}

TimePart::Rows TimePart::rows(std::span<const double> time_s, const TimeOrigin& origin,
                              const std::string& name) const {
  const auto first_from = [&](const SaidTime& wanted) {
    const auto at =
        std::ranges::partition_point(time_s, [&](double time) { return wanted.is_after(origin, time); });
    return static_cast<std::size_t>(at - time_s.begin());
  };
  const std::size_t begin = first_from(from), end = std::max(begin, first_from(to));
  if (begin == end && !time_s.empty())
    refuse_empty(origin.in_s(time_s.front()), origin.in_s(time_s.back()), name);
  return {begin, end};
}

void TimePart::refuse_empty(double first_s, double last_s, const std::string& name) const {
  throw refusal("{}: nothing between --from{} and --to{}, expected times within {} … {} s", name,
                from.text.empty() ? "" : " " + from.text, to.text.empty() ? "" : " " + to.text,
                told_time(first_s), told_time(last_s));
}

CaptureView view_of(const LongTable& table, const std::string& path) {
  const CaptureShape shape = capture_shape(table.header, path, table);
  CaptureView view;
  view.comments = lines_of(table.comments);
  view.faults = table.faults;
  view.since_power_up_s = table.since_power_up_s;
  view.origin = table.origin;
  view.time_s = table.time_s;
  view.axes = shape.axes;
  view.dead_axes = table.dead_axes;
  view.rate_radps.resize(shape.axes.size());
  view.reference_rate_radps.resize(shape.axes.size());
  using Kind = CaptureShape::Place::Kind;
  for (std::size_t h = 0, c = 0; h < table.header.size() && c < table.columns.size(); ++h) {
    const LongColumn& column = table.columns[c];
    if (column.name != table.header[h]) continue;  // not read
    ++c;
    const CaptureShape::Place& place = shape.places[h];
    if (place.kind == Kind::rate)
      view.rate_radps[place.at] = column.values;
    else if (place.kind == Kind::reference)
      view.reference_rate_radps[place.at] = column.values;
    else
      view.channels.push_back({column.name, column.values});
  }
  return view;
}

CaptureView rows_of(CaptureView view, const TimePart::Rows& rows) {
  const auto keep = [&](std::span<const double>& values) {
    if (!values.empty()) values = rows.of(values);
  };
  if (view.since_power_up_s && rows.begin < view.size())
    *view.since_power_up_s += view.time_s[rows.begin] - view.time_s.front();
  keep(view.time_s);
  for (std::span<const double>& rate : view.rate_radps) keep(rate);
  for (std::span<const double>& reference : view.reference_rate_radps) keep(reference);
  for (CaptureView::Channel& channel : view.channels) keep(channel.values);
  return view;
}

void tell_model_of_one_axis(const Model& model, const std::string& path,
                            const std::vector<std::string>& axes) {
  if (const std::string remark = effects_of_no_axis(model, axes); !remark.empty())
    warn("{}: {}\n", path, remark);
}

Model without_axes(Model model, const std::vector<std::string>& axes) {
  const auto is_out = [&](const std::string& axis) {
    return !axis.empty() && std::ranges::find(axes, axis) != axes.end();
  };
  std::vector<Effect> effects;
  std::vector<std::size_t> rows;  // rows of the covariance that remain
  std::size_t all = 0;
  for (Effect& effect : model.effects) {
    const std::size_t first = all;
    all += effect.parameters.size();
    if (is_out(effect.axis)) continue;
    const bool of_rate = is_out(axis_of_rate(effect.channel));
    if (of_rate || is_out(axis_of_rate(effect.with_channel))) {
      warn("not corrected: {} of {}{}: that axis was dropped\n", effect.form,
           printable(of_rate ? effect.channel : effect.with_channel),
           effect.axis.empty() ? "" : " in " + effect.axis);
      continue;
    }
    for (std::size_t row = first; row < all; ++row) rows.push_back(row);
    effects.push_back(std::move(effect));
  }
  model.effects = std::move(effects);
  if (model.covariance.size() != all * all || rows.size() == all) return model;
  model.covariance = of_rows(model.covariance, all, rows);
  return model;
}

std::vector<Samples> compensated_rates(const CaptureView& capture, const Model& model) {
  Compensator compensator(without_axes(model, capture.dead_axes), capture.axes,
                          std::numeric_limits<double>::infinity(), capture.since_power_up_s);
  SeriesToCompensate series{capture.time_s, capture.rate_radps, {}};
  for (const std::string& name : compensator.channels()) {
    const CaptureView::Channel* found = nullptr;
    for (const CaptureView::Channel& channel : capture.channels)
      if (channel.name == name) found = &channel;
    if (!found)
      throw refusal("the model wants channel {}{}, which the capture does not have", in_quotes(name),
                    place_of(model, name));
    series.channels.emplace_back(found->values);
  }
  std::vector<Samples> out(capture.axes.size(), Samples(capture.size()));
  compensate_series(compensator, series, [&](std::size_t i, const CompensatorOutput& step) {
    for (std::size_t a = 0; a < out.size(); ++a) out[a][i] = step.compensated_radps[a];
  });
  return out;
}

}  // namespace ifog::tools
