// SPDX-License-Identifier: Apache-2.0
#include "filters/smoother/motion_smoother.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace ifog {
namespace {

using Vector = Eigen::Vector3d;  // level, slope, curvature; per nominal sample
using Matrix = Eigen::Matrix3d;

// Bandwidth times memory: the Kalman filter of three integrators has gain 2 w, the fading-memory parabola 3 /
// M.
constexpr double kBandwidth = 1.5;
// After this many samples without measurement the motion may have changed.
constexpr double kGapEnds = 16.0;
// Number of filtered states stored at a time.
constexpr std::size_t kHeldAtOnce = 4096;
// Variance of slope and curvature at the start of a motion.
constexpr double kAnySlope = 100.0;
// Variance for an arbitrary change relative to the distance of neighbours: its influence is at most the
// inverse. The square would be 1e16 after a jump of 1e8, and only rounding would remain.
constexpr double kAnything = 1e3;

// Estimate of a sample; at rest only the level is used.
struct State {
  Vector x = Vector::Zero();
  Matrix p = Matrix::Zero();
};

// Transition between samples and the covariance of its driving noise.
struct Step {
  Matrix transition = Matrix::Zero(), driving = Matrix::Zero();
  void predict(State& state) const {
    state.x = transition * state.x;
    state.p = (transition * state.p * transition.transpose() + driving).eval();
  }
};

// In units of the noise.
class Course {
 public:
  Course(const RateCourse& of, double noise) : of_(of), noise_(noise) {}

  [[nodiscard]] bool moving(std::size_t i) const {
    return !of_.memories.empty() && of_.memories[i] > pace::kRest;
  }
  // Step from i - 1 to i.
  [[nodiscard]] Step step(std::size_t i) const {
    Step out;
    out.transition(0, 0) = 1.0;
    if (moving(i) || moving(i - 1)) move(i, out.transition, out.driving);
    out.driving(0, 0) += of_.walk[i] / noise_;
    if (moving(i)) return out;
    out.transition.bottomRows<2>().setZero();
    out.driving.bottomRows<2>().setZero();
    out.driving.rightCols<2>().setZero();
    return out;
  }
  // Filters from i - 1 to i.
  void filter(std::size_t i, State& state) const {
    step(i).predict(state);
    if (!std::isfinite(of_.rate[i])) return;
    const Vector gain = state.p.col(0) / (state.p(0, 0) + 1.0);
    state.x += gain * (of_.rate[i] / std::sqrt(noise_) - state.x[0]);
    // Joseph form: after an arbitrary change the difference of two large covariances could become negative.
    Matrix kept = Matrix::Identity();
    kept.col(0) -= gain;
    state.p = (kept * state.p * kept.transpose() + gain * gain.transpose()).eval();
  }
  [[nodiscard]] double anything(std::size_t i) const {
    double most = 1.0;
    for (const std::size_t j : {i, i + 1}) {
      if (j == 0 || j >= of_.rate.size()) continue;
      const double apart = of_.rate[j] - of_.rate[j - 1];
      if (std::isfinite(apart)) most = std::max(most, apart * apart / noise_);
    }
    return kAnything * std::sqrt(most);
  }

 private:
  void move(std::size_t i, Matrix& transition, Matrix& driving) const {
    const double t = of_.steps.empty() ? 1.0 : of_.steps[i];
    const float now = of_.memories[i], before = of_.memories[i - 1];
    const bool begins = before <= pace::kRest, ends = now <= pace::kRest;
    if ((!ends && now <= pace::kBroken) || (!begins && before <= pace::kBroken) || t > kGapEnds) {
      driving.diagonal().setConstant(anything(i));
      return;
    }
    if (begins) {
      driving(1, 1) = driving(2, 2) = kAnySlope;
    } else {
      transition << 1.0, t, 0.5 * t * t, 0.0, 1.0, t, 0.0, 0.0, 1.0;
    }
    const double jerk = pace::jerk(ends ? before : begins ? now : std::min(now, before));
    const double t2 = t * t, t3 = t2 * t;
    Matrix of_jerk;
    of_jerk << t3 * t2 / 20.0, t2 * t2 / 8.0, t3 / 6.0, t2 * t2 / 8.0, t3 / 3.0, t2 / 2.0, t3 / 6.0, t2 / 2.0,
        t;
    driving += jerk * of_jerk;
  }

  RateCourse of_;
  double noise_;
};

// Smoothed state at i, from its filtered state and the next sample's smoothed state.
void smooth_back(const Course& course, std::size_t i, State& filtered, const State& next) {
  const Step step = course.step(i + 1);
  State predicted = filtered;
  step.predict(predicted);
  const Matrix cross = filtered.p * step.transition.transpose();
  Matrix gain = Matrix::Zero();
  if (course.moving(i + 1))
    gain = predicted.p.llt().solve(cross.transpose()).transpose();
  else
    gain.col(0) = cross.col(0) / predicted.p(0, 0);
  filtered.x += gain * (next.x - predicted.x);
  // A sum, as in correct(), to avoid cancellation.
  const Matrix kept = Matrix::Identity() - gain * step.transition;
  filtered.p =
      (kept * filtered.p * kept.transpose() + gain * (step.driving + next.p) * gain.transpose()).eval();
}

}  // namespace

double pace::jerk(double memory) noexcept {
  const double bandwidth = kBandwidth / memory, square = bandwidth * bandwidth;
  return square * square * square;
}

Smoothed smooth_course(const RateCourse& of, double noise) {
  const std::size_t length = of.rate.size();
  Smoothed out{Samples(length, std::nan("")), Samples(length, std::nan(""))};
  Samples &rate = out.rate_radps, &variance = out.variance_rad2ps2;
  std::size_t first = 0;
  while (first < length && !std::isfinite(of.rate[first])) ++first;
  if (first == length) return out;
  const Course course(of, noise);
  const double sigma = std::sqrt(noise);
  State now;
  now.x[0] = of.rate[first] / sigma;
  now.p(0, 0) = 1.0;
  if (course.moving(first)) now.p(1, 1) = now.p(2, 2) = course.anything(first);
  std::vector<State> begun{now};  // filtered, at the start of each piece
  for (std::size_t i = first + 1; i < length; ++i) {
    course.filter(i, now);
    if ((i - first) % kHeldAtOnce == 0) begun.push_back(now);
  }
  std::vector<State> piece;
  for (; !begun.empty(); begun.pop_back()) {
    const std::size_t begin = first + (begun.size() - 1) * kHeldAtOnce,
                      end = std::min(length, begin + kHeldAtOnce);
    piece.assign(1, begun.back());
    for (std::size_t i = begin + 1; i < end; ++i) {
      piece.push_back(piece.back());
      course.filter(i, piece.back());
    }
    for (std::size_t i = end; i-- > begin;) {
      State& filtered = piece[i - begin];
      if (i + 1 < length) smooth_back(course, i, filtered, now);
      now = filtered;
      rate[i] = now.x[0] * sigma;
      variance[i] = now.p(0, 0) * noise;
    }
  }
  for (std::size_t i = first; i-- > 0;) {
    rate[i] = rate[first];
    variance[i] = variance[i + 1] + of.walk[i + 1];
  }
  return out;
}

}  // namespace ifog
