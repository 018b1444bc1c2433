// SPDX-License-Identifier: Apache-2.0
// Samples that are the same for several until one of them changes its own: what is made of an error step by
// step is, where a step has nothing to take out, the error as it was. One thread at a time.
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

  // Numbers of somebody else, that outlive this and do not change.
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
  // True: the same memory, not only the same numbers.
  [[nodiscard]] bool is(const SharedSamples& other) const {
    return values_ == other.values_ && others_.data() == other.others_.data();
  }

  // To change, before anything else is asked of them: a copy, where others share them.
  [[nodiscard]] Samples& own() {
    if (values_.use_count() != 1) values_ = std::make_shared<Samples>(values());
    others_ = {};
    return *values_;
  }
  // To write all of them: so many, whatever is in them.
  [[nodiscard]] Samples& anew(std::size_t size) {
    if (values_.use_count() != 1) values_ = std::make_shared<Samples>();
    others_ = {};
    values_->resize(size);
    return *values_;
  }

 private:
  explicit SharedSamples(std::nullptr_t) {}

  std::shared_ptr<Samples> values_;  // null: of others
  std::span<const double> others_;   // without own ones
};

}  // namespace ifog
