// SPDX-License-Identifier: Apache-2.0
// Numbers in order, as many as there are: in memory at first, and beyond a limit in a file without a name,
// which nothing is left of when the program ends however it ends.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "drivers/system/unnamed_file.h"

namespace ifog {

class LongSeries {
 public:
  // 8 MiB of numbers: a dozen columns in memory together are a hundredth of a small computer's.
  static constexpr std::size_t kInMemory = std::size_t{1} << 20U;
  // Numbers that are written to the file together: so many or more, added together, go straight there.
  static constexpr std::size_t kAtOnce = std::size_t{1} << 16U;

  // in_memory: numbers kept there before the file is begun, in $TMPDIR or else /var/tmp or /tmp.
  explicit LongSeries(std::size_t in_memory = kInMemory) : most_(in_memory) {}
  ~LongSeries();
  LongSeries(LongSeries&& other) noexcept;
  LongSeries& operator=(LongSeries&& other) noexcept;
  LongSeries(const LongSeries&) = delete;
  LongSeries& operator=(const LongSeries&) = delete;

  // Whether to add so many writes to the file.
  [[nodiscard]] bool will_write(std::size_t numbers) const {
    return recent_.size() + numbers >= (!file_ ? most_ + 1 : kAtOnce);
  }
  // Nothing has been added yet, and so many will be: they go to a file that somebody else gave back, if there
  // is one that long.
  void expect(std::size_t numbers);
  // Both throw std::runtime_error with one line: no room for the file, an error of its device.
  void add(double value);
  void add(std::span<const double> values);

  [[nodiscard]] std::size_t size() const { return filed_ + recent_.size(); }
  [[nodiscard]] bool empty() const { return size() == 0; }
  // The whole where it is in memory; what is not in the file yet otherwise.
  [[nodiscard]] const std::vector<double>& recent() const { return recent_; }
  [[nodiscard]] std::size_t filed() const { return filed_; }  // numbers in the file, the first ones
  // to: as many as are wanted, all of them there. Several threads may read at once.
  void read(std::size_t first, std::span<double> to) const;
  // All of them as memory, for what wants them so: mapped where they are in the file, and of the file's
  // pages only some at a time are in memory (mapped_file.h). Valid until more are added. Throws as add().
  [[nodiscard]] std::span<const double> all();

 private:
  void file_recent();
  void unmap();

  std::size_t most_;
  std::vector<double> recent_;
  std::size_t filed_ = 0;
  std::optional<UnnamedFile> file_;
  const double* mapped_ = nullptr;  // the file's numbers
};

}  // namespace ifog
