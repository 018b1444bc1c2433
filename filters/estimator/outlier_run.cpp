// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/outlier_run.h"

#include <algorithm>
#include <cmath>

#include "filters/random/log_exp.h"

namespace ifog {
namespace {

constexpr double kFarOut_sigma = 5.0;  // sigma
// Where more than one sample in a thousand is far they are the sensor's own, and carry angle: only what is
// much further out is kept out.
constexpr double kTails = 1e-3;
constexpr double kFarInTails = 20.0;
constexpr double kMemory = 8192.0;
// Before any was seen; and what is assumed of samples to come.
constexpr double kLeastShare = 1e-9;
// The log-likelihood ratio a sample of kFarOut_sigma has at most.
constexpr double kMostEvidence = 0.5 * kFarOut_sigma * kFarOut_sigma;

}  // namespace

void OutlierRun::count(bool far) noexcept {
  share_ += ((far ? 1.0 : kLeastShare) - share_) / std::max(samples_, 1.0);
}

// An axis is where the run has last measured it, and before where it first did.
void OutlierRun::fill(std::uint32_t valid) noexcept {
  Axes& last = run_[length_ - 1];
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    if ((valid >> a & 1U) != 0 && (measured_ >> a & 1U) == 0)
      for (std::size_t i = 0; i + 1 < length_; ++i) run_[i][a] = last[a];
    else if ((valid >> a & 1U) == 0 && (measured_ >> a & 1U) != 0)
      last[a] = run_[length_ - 2][a];
  }
  measured_ |= valid;
}

void OutlierRun::take(const Surprise& now, double lag) noexcept {
  keep_out_ = jump_ = began_ = false;
  std::uint32_t far_axes = 0;
  double farthest = 0.0, square = 0.0, apart = 0.0;
  int axes = 0;
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    if ((now.valid >> a & 1U) == 0) continue;
    const double own = now.innovation[a] * now.innovation[a] / (now.rest_factor * now.scale[a]);
    farthest = std::max(farthest, own);
    if (own > kFarOut_sigma * kFarOut_sigma) far_axes |= 1U << a;
    square += own;
    ++axes;
    if (length_ == 0 || (measured_ >> a & 1U) == 0) continue;
    const double step = now.rate[a] - run_[length_ - 1][a];
    apart += step * step / now.scale[a];
  }
  samples_ = std::min(samples_ + 1.0, kMemory);
  if (farthest <= kFarOut_sigma * kFarOut_sigma) {
    // Of the axes that are far it says nothing where it has none of them. But those may be gone for good, and
    // what comes long after is no part of the row.
    if (length_ > 0 && (now.valid & far_axes_) == 0 && ++waited_ <= kMost) return;
    // Only now: the first of a jump is no outlier.
    if (length_ > 0) {
      for (; length_ > 0; --length_) count(true);
      most_ = std::min(kMostEvidence, -logarithm(share_));
    }
    count(false);
    if (share_ > 1e-6) most_ = std::min(kMostEvidence, -logarithm(share_));
    return;
  }
  keep_out_ = share_ <= kTails || farthest > kFarInTails * kFarInTails;
  if (length_ == 0) {
    apart_ = squares_ = 0.0;
    measured_ = far_axes_ = 0;
    began_ = true;
  }
  far_axes_ |= far_axes;
  waited_ = 0;
  squares_ += square;
  if (length_ > 0)
    apart_ += 0.5 * logarithm(squares_ / static_cast<double>(length_ + 1) / std::max(apart, 2.0 * axes));
  if (length_ == kMost) {
    std::copy(run_.begin() + 1, run_.end(), run_.begin());
    --length_;
  }
  run_[length_++] = now.rate;
  fill(now.valid);
  const auto far = static_cast<double>(length_);
  jump_ = length_ >= 2 && -far * logarithm(share_) > ChangeTest::kEvidence &&
          apart_ > 0.5 * logarithm(std::max(lag, 1.0));
}

}  // namespace ifog
