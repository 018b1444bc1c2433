// SPDX-License-Identifier: Apache-2.0
// Records cut to means over blocks of equal length, a few thousand in all: slow effects are distinguished from slow
// noise just as well there, at a thousandth of the cost. Channels keep a finer grid, on which the causal
// shapes run before they are averaged, so that lags and derivatives are not blurred by the block.
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "filters/diagnosis/record.h"
#include "filters/effects/meaning.h"
#include "filters/effects/shape.h"

namespace ifog {

// Blocks first … end - 1 of the grid, all of one record.
struct BlockRange {
  std::size_t first = 0, end = 0;

  [[nodiscard]] std::size_t size() const { return end - first; }
  // The same as rows of a matrix that has one for each block.
  [[nodiscard]] Eigen::Index row() const { return static_cast<Eigen::Index>(first); }
  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(size()); }
};

struct BlockGrid {
  double block_s = 0.0;              // length of a block
  double fine_s = 0.0;               // of a step of the fine grid
  std::size_t fine = 1;              // steps a block
  std::vector<BlockRange> records;   // one behind the other
  std::vector<RecordOrigin> origin;  // of each, that its times are counted from; empty: all 0
  std::vector<std::uint8_t> valid;   // by block: enough samples in it
  std::vector<double> time_s;        // middle of the block, in its record's time
  Eigen::VectorXd error;             // by block: mean of rate - reference, 0 where not valid
  double sample_s = 0.0;             // median period of the samples
  bool dwells = false;               // points of a rate table, no time series: their noise is white
  double white_variance = 0.0;       // of one sample, from differences of neighbours
  bool noisy_reference = false;      // blocks had to be lengthened for it: its powers are mostly its noise

  [[nodiscard]] std::size_t size() const { return valid.size(); }
  [[nodiscard]] std::size_t used() const;     // valid blocks
  [[nodiscard]] std::size_t longest() const;  // blocks of the longest record
  [[nodiscard]] Eigen::Index constants() const { return static_cast<Eigen::Index>(records.size()); }
  [[nodiscard]] RecordOrigin origin_of(std::size_t record) const {
    return record < origin.size() ? origin[record] : RecordOrigin{};
  }
  // Steps of the fine grid that a record's blocks are made of.
  [[nodiscard]] BlockRange fine_steps(const BlockRange& record) const {
    return {record.first * fine, record.end * fine};
  }
};

// Takes from the rows of each record, one a block, their mean.
template <class Rows>
void centre_records(const BlockGrid& grid, Rows& values) {
  for (const BlockRange& record : grid.records) {
    auto rows = values.middleRows(record.row(), record.rows());
    rows.rowwise() -= rows.colwise().mean().eval();
  }
}

struct FineChannel {
  std::string name;
  std::vector<double> values;  // on the fine grid of all records, missing ones held
  std::vector<double> power;   // variance within each step of the fine grid; empty when a step is one sample
  double low = 0.0, high = 0.0;
  bool varies = false;
  bool still = false;       // no more than reading noise: its averages are those of white noise
  bool smooth = false;      // moves smoothly, so that it has no power of its own above its slope
  bool moves = false;       // senses motion, and no reference rate tells rotation from error; see motion.h
  bool held = false;        // of such an acceleration: it stays for half a minute at a time
  bool shakes = false;      // of such an acceleration: most of its power is quicker than sways and waves
  bool two_valued = false;  // a switch: its powers are itself
  bool of_axis = false;     // the rate of another axis of the sensor
  double period = 0.0;      // of an angle without its wraps: only what repeats with it is a function of it
  // Its mean square may be that of a vibration. Above a low-pass a smooth channel has its slope; and without a
  // reference the mean square of a velocity, a sway or a wave may be the sensor's own rotation.
  [[nodiscard]] bool vibrates() const {
    const Motion motion = motion_of(name);
    return !smooth && motion != Motion::kAngle && (!moves || shakes);
  }
  // A quantity of the surroundings, that any form may be made of.
  [[nodiscard]] bool environment() const { return !moves && !of_axis && period == 0.0; }
};

struct BlockData {
  BlockGrid grid;
  std::vector<FineChannel> channels;  // in the order of the first record; the reference, if any, last
  std::ptrdiff_t reference = -1;      // its index
};

// Between samples of a time series, s. What is slower is a table: its rows are averages of their own.
inline constexpr double kSlowest_s = 1.0;

// Throws std::invalid_argument, naming the record: no record, columns of different length, a reference in
// some records only, a time that does not increase.
void check_columns(const std::vector<Record>& records);

// Throws std::invalid_argument as diagnose() does.
BlockData cut_to_blocks(const std::vector<Record>& records, std::size_t most_blocks = 4096);

// Means over blocks of a shape of a channel, or of the product of two; each record restarts it.
Eigen::VectorXd column(const BlockData& data, const ShapeSettings& shape, std::size_t channel);
Eigen::VectorXd column(const BlockData& data, const ShapeSettings& shape, std::size_t channel,
                       const ShapeSettings& with, std::size_t with_channel);

}  // namespace ifog
