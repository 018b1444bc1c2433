// SPDX-License-Identifier: Apache-2.0
// A sequence of numbers: first in memory, beyond a limit in an unnamed file, which disappears with the
// process.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "drivers/system/unnamed_file.h"

namespace ifog {

class LongSeries {
 public:
  // 8 MiB of numbers, so that a dozen columns take about 1 % of a small computer's memory.
  static constexpr std::size_t kInMemory = std::size_t{1} << 20U;
  // Numbers written to the file at a time; larger additions are written directly.
  static constexpr std::size_t kAtOnce = std::size_t{1} << 16U;

  // in_memory: numbers in memory before a file is used, in $TMPDIR or else /var/tmp or /tmp.
  explicit LongSeries(std::size_t in_memory = kInMemory) : most_(in_memory) {}
  ~LongSeries();
  LongSeries(LongSeries&& other) noexcept;
  LongSeries& operator=(LongSeries&& other) noexcept;
  LongSeries(const LongSeries&) = delete;
  LongSeries& operator=(const LongSeries&) = delete;

  // True if adding this many numbers writes to the file.
  [[nodiscard]] bool will_write(std::size_t numbers) const {
    return recent_.size() + numbers >= (!file_ ? most_ + 1 : kAtOnce);
  }
  // Announces the number of values, before the first is added: reserves memory or reuses a released file.
  void expect(std::size_t numbers);
  // These throw std::runtime_error with one line: no space for the file, or an I/O error.
  void add(double value);
  void add(std::span<const double> values);

  [[nodiscard]] std::size_t size() const { return filed_ + recent_.size(); }
  [[nodiscard]] bool empty() const { return size() == 0; }
  // All values if they are in memory; else those not yet in the file.
  [[nodiscard]] const std::vector<double>& recent() const { return recent_; }
  [[nodiscard]] std::size_t filed() const { return filed_; }  // numbers in the file, the first ones
  // Reads to.size() numbers, which must exist. Several threads may read at once.
  void read(std::size_t first, std::span<double> to) const;
  // All values as memory; a file is mapped, and only part of its pages is in memory at a time
  // (mapped_file.h). Valid until more are added. Throws as add().
  [[nodiscard]] std::span<const double> all();

 private:
  void file_recent();
  void unmap();

  std::size_t most_;
  std::vector<double> recent_;
  std::size_t filed_ = 0;
  std::optional<UnnamedFile> file_;
  const double* mapped_ = nullptr;  // mapping of the file
};

}  // namespace ifog
