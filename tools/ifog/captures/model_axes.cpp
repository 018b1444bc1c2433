// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/model_axes.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "filters/effects/compensate_series.h"
#include "filters/effects/form.h"
#include "filters/model_file/channel_names.h"
#include "filters/model_file/covariance.h"
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

void tell_model_of_one_axis(const Model& model, const std::string& path,
                            const std::vector<std::string>& axes) {
  if (const std::string remark = effects_of_no_axis(model, axes); !remark.empty())
    warn("{}: {}\n", path, remark);
}

Model without_axes(Model model, const std::vector<std::string>& axes) {
  const auto is_out = [&](const std::string& axis) {
    return !axis.empty() && std::find(axes.begin(), axes.end(), axis) != axes.end();
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
