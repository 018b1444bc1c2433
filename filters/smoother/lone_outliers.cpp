// SPDX-License-Identifier: Apache-2.0
#include "filters/smoother/lone_outliers.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cmath>

namespace ifog {
namespace {

constexpr double kFarOff = 5.5;  // sigma, as in a manoeuvre online
// The cubic goes through the others where it is no further from one than so many sigma, or than this part of
// how far it is from the measurement in question.
constexpr double kNear = 4.0, kPart = 1.0 / 6.0;
// Neighbours that are looked at on each side, those left out at most, and the time they may stretch over.
constexpr std::size_t kSide = 6;
constexpr int kMostLeftOut = 3;
constexpr double kLongest = 4.0 * kSide;

// Measurements about one, that one left out: when, in nominal samples from it, and how far from it.
struct Neighbours {
  std::array<double, 2 * kSide> at{}, rate{};
  std::array<bool, 2 * kSide> used{};
  std::size_t count = 0, before = 0;
  void add(double when, double apart) {
    at[count] = when;
    rate[count] = apart;
    used[count++] = true;
  }
};

Neighbours about(std::span<const double> rate, std::span<const double> steps, std::size_t i) {
  Neighbours out;
  double when = 0.0;
  for (std::size_t j = i; j-- > 0 && out.count < kSide;) {
    when -= steps[j + 1];
    if (when < -kLongest) break;
    if (std::isfinite(rate[j])) out.add(when, rate[j] - rate[i]);
  }
  out.before = out.count;
  when = 0.0;
  for (std::size_t j = i + 1; j < rate.size() && out.count < out.before + kSide; ++j) {
    when += steps[j];
    if (when > kLongest) break;
    if (std::isfinite(rate[j])) out.add(when, rate[j] - rate[i]);
  }
  return out;
}

// By the next two on each side: of what it is foreseen, whether it is so far off that more is to be asked.
bool suspect(const Neighbours& n, double sigma) {
  if (n.before < kSide || n.count < n.before + kSide) return false;
  const std::array<std::size_t, 4> next{0, 1, n.before, n.before + 1};
  double sum = 0.0, squares = 1.0;
  for (const std::size_t i : next) {
    double weight = 1.0;
    for (const std::size_t j : next)
      if (j != i) weight *= n.at[j] / (n.at[j] - n.at[i]);
    sum += weight * n.rate[i];
    squares += weight * weight;
  }
  return sum * sum > kFarOff * kFarOff * squares * sigma * sigma;
}

struct Cubic {
  double here = 0.0, variance = 0.0;  // what is foreseen, and its variance over R
  std::size_t worst = 0;              // of those used
  double apart = 0.0;                 // how far that is
};

Cubic fit(const Neighbours& n) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  const auto row = [&](std::size_t i) {
    const double t = n.at[i] / kSide;
    return Eigen::Vector4d(1.0, t, t * t, t * t * t);
  };
  for (std::size_t i = 0; i < n.count; ++i) {
    if (!n.used[i]) continue;
    normal += row(i) * row(i).transpose();
    right += n.rate[i] * row(i);
  }
  const Eigen::LDLT<Eigen::Matrix4d> solver(normal);
  const Eigen::Vector4d cubic = solver.solve(right);
  Cubic out{cubic[0], solver.solve(Eigen::Vector4d::UnitX())[0]};
  for (std::size_t i = 0; i < n.count; ++i) {
    const double apart = std::abs(n.rate[i] - cubic.dot(row(i)));
    if (n.used[i] && !(apart <= out.apart)) out.worst = i, out.apart = apart;
  }
  return out;
}

// Beside the measurement in question, or one that was left out already.
bool beside(const Neighbours& n, std::size_t i) {
  const bool first = i == 0 || i == n.before, last = i + 1 == n.before || i + 1 == n.count;
  return first || !n.used[i - 1] || (!last && !n.used[i + 1]);
}

bool lone(Neighbours n, double sigma) {
  for (int left_out = 0;; ++left_out) {
    const Cubic through = fit(n);
    const double far = std::abs(through.here);
    const double near = std::max(kNear * sigma, kPart * far);
    if (through.apart <= near) return far > kFarOff * sigma * std::sqrt(1.0 + through.variance);
    if (left_out == kMostLeftOut || beside(n, through.worst)) return false;
    n.used[through.worst] = false;
  }
}

}  // namespace

void find_lone_outliers(std::span<const double> rate, std::span<const double> steps, double noise,
                        std::size_t begin, std::size_t end, std::vector<std::size_t>& places) {
  const double sigma = std::sqrt(noise);
  for (std::size_t i = begin; i < end; ++i) {
    if (!std::isfinite(rate[i])) continue;
    const Neighbours near = about(rate, steps, i);
    if (suspect(near, sigma) && lone(near, sigma)) places.push_back(i);
  }
}

}  // namespace ifog
