// SPDX-License-Identifier: Apache-2.0
// Block data for tests of one room at a time, made without cut_to_blocks().
#pragma once

#include "filters/diagnosis/regression/candidates.h"
#include "tests/unit/test.h"

namespace ifog {

// Blocks of one second and of one sample each, all valid; one record unless its lengths are given.
inline BlockGrid grid_of(const std::vector<std::size_t>& lengths) {
  BlockGrid grid;
  grid.block_s = grid.fine_s = grid.sample_s = 1.0;
  for (const std::size_t n : lengths) {
    grid.records.push_back({grid.size(), grid.size() + n});
    for (std::size_t i = 0; i < n; ++i) {
      grid.valid.push_back(1);
      grid.time_s.push_back(static_cast<double>(i));
    }
  }
  grid.error = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(grid.size()));
  return grid;
}

inline FineChannel channel_of(const std::string& name, const std::vector<double>& values) {
  FineChannel channel;
  channel.name = name;
  channel.values = values;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  channel.low = *low;
  channel.high = *high;
  channel.varies = high != low;
  return channel;
}

// Unit white noise in the error and one slow temperature.
inline BlockData white_with_temperature(std::size_t n, std::uint64_t seed) {
  test::Noise normal(seed);
  BlockData data;
  data.grid = grid_of({n});
  std::vector<double> temperature;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i);
    data.grid.error[static_cast<Eigen::Index>(i)] = normal();
    temperature.push_back(25.0 + 8.0 * std::sin(2.0 * M_PI * t / 700.0) +
                          3.0 * std::sin(2.0 * M_PI * t / 130.0));
  }
  data.channels = {channel_of("temperature_degC", temperature)};
  data.channels[0].smooth = true;
  return data;
}

inline Candidate candidate_of(Form form, double time_constant_s = 0.0) {
  Candidate candidate;
  candidate.form = form;
  candidate.channel = 0;
  candidate.time_constant_s = time_constant_s;
  return candidate;
}

inline Candidate step_at(double time_s) {
  Candidate step;
  step.form = Form::kStep;
  step.time_s = time_s;
  return step;
}

}  // namespace ifog
