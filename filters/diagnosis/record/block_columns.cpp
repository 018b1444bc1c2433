// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/blocks.h"

namespace ifog {

Eigen::VectorXd column(const BlockData& data, const ShapeSettings& settings, std::size_t channel) {
  Shape shape(settings);
  const FineChannel& source = data.channels[channel];
  const bool add_power = !source.power.empty();
  return block_means(data.grid, [&](std::size_t k, bool starts) {
    if (starts) shape.restart();
    return shape.step_over(source.values[k], add_power ? source.power[k] : 0.0, data.grid.fine_s);
  });
}

Eigen::VectorXd column(const BlockData& data, const ShapeSettings& settings, std::size_t channel,
                       const ShapeSettings& with_settings, std::size_t with_channel) {
  Shape shape(settings);
  Shape with(with_settings);
  const FineChannel& source = data.channels[channel];
  const FineChannel& other = data.channels[with_channel];
  return block_means(data.grid, [&](std::size_t k, bool starts) {
    if (starts) {
      shape.restart();
      with.restart();
    }
    return shape.step(source.values[k], data.grid.fine_s) * with.step(other.values[k], data.grid.fine_s);
  });
}

}  // namespace ifog
