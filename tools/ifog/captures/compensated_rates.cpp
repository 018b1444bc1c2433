// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/compensated_rates.h"

#include <limits>
#include <stdexcept>
#include <string>

#include "drivers/ifog/quoted.h"
#include "filters/effects/compensate_series.h"
#include "filters/model_file/channel_names.h"
#include "tools/ifog/captures/model_axes.h"

namespace ifog::tools {

namespace {

// The line of the first effect on it, where the model is a file's.
std::string place_of(const Model& model, const std::string& channel) {
  for (const Effect& effect : model.effects)
    for (const std::string& used : {effect.channel, effect.with_channel})
      if (const ChannelNames names = names_in(used);
          effect.line > 0 && (names.of == channel || names.less == channel))
        return " in line " + std::to_string(effect.line);
  return "";
}

}  // namespace

std::vector<Samples> compensated_rates(const CaptureView& capture, const Model& model) {
  Compensator compensator(without_axes(model, capture.dead_axes), capture.axes,
                          std::numeric_limits<double>::infinity(), capture.since_power_up_s);
  SeriesToCompensate series{capture.time_s, capture.rate_radps, {}};
  for (const std::string& name : compensator.channels()) {
    const CaptureView::Channel* found = nullptr;
    for (const CaptureView::Channel& channel : capture.channels)
      if (channel.name == name) found = &channel;
    if (!found)
      throw std::runtime_error("the model wants channel " + in_quotes(name) + place_of(model, name) +
                               ", which the capture does not have");
    series.channels.emplace_back(found->values);
  }
  std::vector<Samples> out(capture.axes.size(), Samples(capture.size()));
  compensate_series(compensator, series, [&](std::size_t i, const CompensatorOutput& step) {
    for (std::size_t a = 0; a < out.size(); ++a) out[a][i] = step.compensated_radps[a];
  });
  return out;
}

}  // namespace ifog::tools
