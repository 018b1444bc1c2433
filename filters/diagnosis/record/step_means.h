// SPDX-License-Identifier: Apache-2.0
// A record's columns as means over the steps of a grid, worked out once for all axes of the sensor.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "filters/diagnosis/record.h"
#include "filters/diagnosis/record/known_columns.h"

namespace ifog {

// The step of a record's fine grid that sample i is in.
std::size_t fine_index(const Record& record, std::size_t i, double fine_s);

// The first sample of each step of a record's fine grid, and behind the last step the number of samples.
using StepStarts = std::vector<std::size_t>;
std::shared_ptr<const StepStarts> step_starts(const Record& record, double fine_s, std::size_t steps);

struct StepMeans {
  std::vector<double> means, power;  // power: of what is within a step, about its mean
};

// Of the columns of a record, by its steps of fine_s.
class StepMeansOf {
 public:
  // starts: outlives this.
  StepMeansOf(const Record& record, const StepStarts& starts, double fine_s, bool with_power)
      : known_(record.known), starts_(starts), fine_s_(fine_s), with_power_(with_power) {}

  // Steps without a value hold the last one; linear where the record has no rows.
  [[nodiscard]] std::shared_ptr<const StepMeans> column(std::span<const double> values) const;
  // Of those that nobody else is at work on, so that several axes share them out.
  void prepare(std::span<const RecordChannel> channels) const;

 private:
  [[nodiscard]] KnownColumns::Asked asked(std::span<const double> values) const {
    return {"step means", values, fine_s_, starts_.size()};
  }
  [[nodiscard]] StepMeans worked_out(std::span<const double> values) const;

  std::shared_ptr<KnownColumns> known_;
  const StepStarts& starts_;
  double fine_s_;
  bool with_power_;
};

}  // namespace ifog
