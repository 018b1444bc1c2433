// SPDX-License-Identifier: Apache-2.0
// Samples with copy on write: steps that do not change an error share its memory. Not thread-safe.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "filters/series/samples.h"
#include "filters/series/samples_writer.h"

namespace ifog {

class SharedSamples {
 public:
  SharedSamples() : values_(std::make_shared<Samples>()) {}
  SharedSamples(Samples values) : values_(std::make_shared<Samples>(std::move(values))) {}
  SharedSamples(const std::vector<double>& values) : SharedSamples(Samples(values)) {}

  // View of foreign numbers, which must outlive this and not change.
  [[nodiscard]] static SharedSamples of(std::span<const double> others) {
    SharedSamples samples(nullptr);
    samples.others_ = others;
    return samples;
  }

  [[nodiscard]] Samples values() const { return copied({data(), size()}); }
  [[nodiscard]] std::size_t size() const { return values_ ? values_->size() : others_.size(); }
  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] const double* data() const { return values_ ? values_->data() : others_.data(); }
  [[nodiscard]] const double* begin() const { return data(); }
  [[nodiscard]] const double* end() const { return data() + size(); }
  [[nodiscard]] double operator[](std::size_t i) const { return data()[i]; }
  // True if both share the same memory.
  [[nodiscard]] bool is(const SharedSamples& other) const {
    return values_ == other.values_ && others_.data() == other.others_.data();
  }

  // Makes the samples writable; copies them if they are shared.
  [[nodiscard]] Samples& own() {
    if (values_.use_count() != 1) values_ = std::make_shared<Samples>(values());
    others_ = {};
    return *values_;
  }

 private:
  explicit SharedSamples(std::nullptr_t) {}

  std::shared_ptr<Samples> values_;  // null if others_ is used
  std::span<const double> others_;   // used if there are no own values
};

}  // namespace ifog
