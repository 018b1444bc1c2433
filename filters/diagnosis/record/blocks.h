// SPDX-License-Identifier: Apache-2.0
// Records reduced to means over a few thousand blocks of equal length. This suffices to distinguish slow
// effects from slow noise at a thousandth of the cost. Channels keep a finer grid, on which causal shapes are
// computed before averaging, so that lags and derivatives are not blurred.
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "filters/diagnosis/record.h"
#include "filters/effects/meaning.h"
#include "filters/effects/shape.h"

namespace ifog {

// Blocks first … end - 1 of the grid, all of one record.
struct BlockRange {
  std::size_t first = 0, end = 0;
  double power_up_s = 0.0;  // of the sensor, in the record's time

  [[nodiscard]] std::size_t size() const { return end - first; }
  // As rows of a matrix with one row per block.
  [[nodiscard]] Eigen::Index row() const { return static_cast<Eigen::Index>(first); }
  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(size()); }
};

struct BlockGrid {
  double block_s = 0.0;              // length of a block
  double fine_s = 0.0;               // step of the fine grid
  std::size_t fine = 1;              // steps per block
  std::vector<BlockRange> records;   // one after the other
  std::vector<RecordOrigin> origin;  // origin of each record's times; empty: all 0
  std::vector<std::uint8_t> valid;   // by block: has enough samples
  std::vector<double> time_s;        // centre of the block, in its record's time
  Eigen::VectorXd error;             // by block: mean of rate - reference, 0 if not valid
  double sample_s = 0.0;             // median sample period
  bool dwells = false;               // points of a rate table instead of a time series: their noise is white
  double white_variance = 0.0;       // of one sample, from differences of neighbours
  bool noisy_reference = false;      // blocks were lengthened because of it; its powers are mostly noise

  [[nodiscard]] std::size_t size() const { return valid.size(); }
  [[nodiscard]] std::size_t used() const;     // valid blocks
  [[nodiscard]] std::size_t longest() const;  // blocks of the longest record
  [[nodiscard]] Eigen::Index constants() const { return static_cast<Eigen::Index>(records.size()); }
  [[nodiscard]] RecordOrigin origin_of(std::size_t record) const {
    return record < origin.size() ? origin[record] : RecordOrigin{};
  }
  // Steps of the fine grid in the record's blocks.
  [[nodiscard]] BlockRange fine_steps(const BlockRange& record) const {
    return {record.first * fine, record.end * fine};
  }
};

// Subtracts from the rows of each record their mean.
template <class Rows>
void centre_records(const BlockGrid& grid, Rows& values) {
  for (const BlockRange& record : grid.records) {
    auto rows = values.middleRows(record.row(), record.rows());
    rows.rowwise() -= rows.colwise().mean().eval();
  }
}

struct FineChannel {
  std::string name;
  std::vector<double> values;      // on the fine grid of all records; interpolated between readings
  std::vector<std::uint8_t> read;  // 0: a step between two readings
  std::vector<double> power;       // variance within each fine step; empty if a step is one sample
  double low = 0.0, high = 0.0;
  bool varies = false;
  bool still = false;       // only reading noise: its averages are those of white noise
  bool smooth = false;      // moves smoothly, so its power is only that of its slope
  bool moves = false;       // senses motion and there is no reference, see motion.h
  bool held = false;        // of such an acceleration: constant for half a minute at a time
  bool shakes = false;      // of such an acceleration: most power is faster than sway and waves
  bool two_valued = false;  // a switch: its powers equal itself
  bool of_axis = false;     // the rate of another axis of the sensor
  double period = 0.0;      // of an unwrapped angle: effects must be periodic in it
  // True if its mean square may be that of a vibration. A smooth channel only has its slope above a low-pass.
  // Without a reference the mean square of a velocity, sway or wave may be the sensor's own rotation.
  [[nodiscard]] bool vibrates() const {
    const Motion motion = motion_of(name);
    return !smooth && motion != Motion::kAngle && (!moves || shakes);
  }
  // Environmental quantity, for which all forms are allowed.
  [[nodiscard]] bool environment() const { return !moves && !of_axis && period == 0.0; }
};

struct BlockData {
  BlockGrid grid;
  std::vector<FineChannel> channels;  // in the order of the first record; the reference, if any, last
  std::ptrdiff_t reference = -1;      // index of the reference

  // Of a channel by name; nullopt if there is none.
  [[nodiscard]] std::optional<std::size_t> index_of(std::string_view name) const;
};

// Largest sample time of a time series, s. Slower rows are points of a table, averages by themselves.
inline constexpr double kSlowest_s = 1.0;

// Throws std::invalid_argument that names the record: no record, columns of different length, a reference in
// some records only, time not increasing.
void check_columns(const std::vector<Record>& records);

// Noise variance of one sample of rate minus reference, from the median difference of neighbours, which ignores
// steps, ramps and bursts.
double white_variance(const std::vector<Record>& records);

// Throws std::invalid_argument as diagnose() does.
BlockData cut_to_blocks(const std::vector<Record>& records, std::size_t most_blocks = 4096);

// Block means of step(k, starts) over the fine steps k; starts: of a record.
template <class Step>
Eigen::VectorXd block_means(const BlockGrid& grid, Step&& step) {
  Eigen::VectorXd means(static_cast<Eigen::Index>(grid.size()));
  for (const BlockRange& record : grid.records)
    for (std::size_t b = record.first; b < record.end; ++b) {
      double sum = 0.0;
      for (std::size_t k = b * grid.fine; k < (b + 1) * grid.fine; ++k)
        sum += step(k, k == record.first * grid.fine);
      means[static_cast<Eigen::Index>(b)] = sum / static_cast<double>(grid.fine);
    }
  return means;
}

// Block means of a shape of a channel, or of the product of two shapes; restarts at each record.
Eigen::VectorXd column(const BlockData& data, const ShapeSettings& shape, std::size_t channel);
Eigen::VectorXd column(const BlockData& data, const ShapeSettings& shape, std::size_t channel,
                       const ShapeSettings& with, std::size_t with_channel);

}  // namespace ifog
