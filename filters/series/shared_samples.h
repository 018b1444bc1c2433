// SPDX-License-Identifier: Apache-2.0
// Samples that are the same for several until one of them changes its own: what is made of an error step by
// step is, where a step has nothing to take out, the error as it was. One thread at a time.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "filters/series/samples.h"

namespace ifog {

class SharedSamples {
 public:
  SharedSamples() : values_(std::make_shared<Samples>()) {}
  SharedSamples(Samples values) : values_(std::make_shared<Samples>(std::move(values))) {}
  SharedSamples(const std::vector<double>& values) : SharedSamples(Samples(values)) {}

  [[nodiscard]] const Samples& values() const { return *values_; }
  [[nodiscard]] std::size_t size() const { return values_->size(); }
  [[nodiscard]] bool empty() const { return values_->empty(); }
  [[nodiscard]] const double* data() const { return values_->data(); }
  [[nodiscard]] const double* begin() const { return data(); }
  [[nodiscard]] const double* end() const { return data() + size(); }
  [[nodiscard]] double operator[](std::size_t i) const { return (*values_)[i]; }
  // True: the same memory, not only the same numbers.
  [[nodiscard]] bool is(const SharedSamples& other) const { return values_ == other.values_; }

  // To change: a copy, where others share them.
  [[nodiscard]] Samples& own() {
    if (values_.use_count() > 1) values_ = std::make_shared<Samples>(*values_);
    return *values_;
  }
  // To write all of them: so many, whatever is in them.
  [[nodiscard]] Samples& anew(std::size_t size) {
    if (values_.use_count() > 1) values_ = std::make_shared<Samples>();
    values_->resize(size);
    return *values_;
  }

 private:
  std::shared_ptr<Samples> values_;  // never null, but where it was moved from
};

}  // namespace ifog
