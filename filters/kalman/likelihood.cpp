// SPDX-License-Identifier: Apache-2.0
#include "filters/kalman/likelihood.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>

#include "filters/kalman/core.h"
#include "filters/kalman/doubling.h"

namespace ifog {
namespace {

constexpr double kDiffuse = 1e9;
// Samples after the start with individual gains, and the divisor for later intervals of constant gain.
constexpr std::size_t kFollowed = 256;
// Samples with individual gains after a missing one, until fast states have recovered.
constexpr std::size_t kRecovery = 16;
// The gain is constant if it changes by less than this, relatively, between intervals.
constexpr double kSettled = 1e-9;
// Axes that are filtered in parallel.
constexpr int kLanes = 4;

// States of up to kLanes axes, state by state.
using States = std::array<double, static_cast<std::size_t>(kMaxStates* kLanes)>;

// Propagates `states` over `count` samples with constant gain, from prediction to prediction. predictor:
// transition times gain. Returns each lane's sum of squared innovations. The only loop over samples, so it is
// compiled for each size.
template <int n, int lanes>
double carry(States& states, const double* row, std::size_t count, const FewStatesMatrix& of_transition,
             const FewStatesVector& of_predictor, const FewStatesVector& of_measurement) {
  using Row = Eigen::Array<double, lanes, 1>;
  const Eigen::Matrix<double, n, n> transition = of_transition;
  const Eigen::Matrix<double, n, 1> predictor = of_predictor, h = of_measurement;
  std::array<Row, n> x, next;
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  for (int i = 0; i < n; ++i) x[at(i)] = Eigen::Map<const Row>(&states[at(i * lanes)]);
  Row squares = Row::Zero();
  for (std::size_t k = 0; k < count; ++k, row += lanes) {
    Row innovation = Eigen::Map<const Row>(row);
    for (int i = 0; i < n; ++i) innovation -= h(i) * x[at(i)];
    squares += innovation.square();
    for (int i = 0; i < n; ++i) {
      next[at(i)] = predictor(i) * innovation;
      for (int j = 0; j < n; ++j) next[at(i)] += transition(i, j) * x[at(j)];
    }
    x = next;
  }
  for (int i = 0; i < n; ++i) std::copy_n(x[at(i)].data(), lanes, &states[at(i * lanes)]);
  return squares.sum();
}

template <int lanes>
constexpr std::array kCarry{carry<1, lanes>, carry<2, lanes>, carry<3, lanes>, carry<4, lanes>,
                            carry<5, lanes>, carry<6, lanes>, carry<7, lanes>, carry<8, lanes>};

// Filter of axes with the same missing samples, which share covariance and gain.
class Pass {
 public:
  Pass(const StateModel& model, double process_noise, double measurement_noise, double dt_s)
      : h_(model.measurement()),
        level_(model.level()),
        gain_(FewStatesVector::Zero(model.states())),
        p_(process_noise * model.stationary()),
        transition_(model.states(), model.states()),
        driving_(model.states(), model.states()),
        noise_(measurement_noise),
        diffuse_(static_cast<std::size_t>((model.diffuse().array() > 0).count())) {
    model.discretise(dt_s, transition_, driving_);
    driving_ *= process_noise;
    const double scale = noise_ + h_.dot((p_ + driving_) * h_);
    p_.diagonal() += kDiffuse * scale * model.diffuse();
    doubling_.emplace(transition_, driving_, h_, noise_);
  }

  LikelihoodTerms over(const LikelihoodRecord::Group& group) {
    const std::size_t lanes = group.lanes;
    const auto carry = (lanes == 1 ? kCarry<1> : kCarry<kLanes>)[static_cast<std::size_t>(h_.size() - 1)];
    const double* row = group.rows.data();
    LikelihoodTerms terms;
    std::size_t measured = 0;
    for (const LikelihoodRecord::Run& run : group.runs) {
      if (run.missing) {
        if (measured > 0) predict(run.length, lanes);
        row += run.length * lanes;
        continue;
      }
      if (measured == 0 && diffuse_ > 0)
        states(lanes) = Eigen::Map<const Eigen::VectorXd>(row, states(lanes).rows()) * level_.transpose();
      bool settled = false;
      for (std::size_t done = 0; done < run.length;) {
        const std::size_t left = run.length - done;
        const std::size_t count = settled ? left : held(measured, done, left);
        if (count == 1) {
          variance_ = noise_ + h_.dot(p_ * h_);
          correct_covariance(p_, gain_, h_, variance_);
        } else if (!settled) {
          settled = hold(static_cast<std::size_t>(std::bit_width(count) - 2));
        }
        const FewStatesVector predictor = transition_ * gain_;
        // Lanes without an axis have zero innovations.
        const double squares = carry(x_, row, count, transition_, predictor, h_);
        if (count == 1) predict_covariance(p_, transition_, driving_);
        if (measured >= diffuse_) {
          terms.count += static_cast<long>(count * group.axes);
          terms.sum_log_variance += static_cast<double>(count * group.axes) * std::log(variance_);
          terms.sum_normalised += squares / variance_;
        }
        done += count;
        measured += count;
        row += count * lanes;
      }
    }
    return terms;
  }

 private:
  // Samples with constant gain, a power of two.
  static std::size_t held(std::size_t measured, std::size_t since_missing, std::size_t left) {
    if (measured < 2 * kFollowed || since_missing < kRecovery) return 1;
    return std::bit_floor(std::min(measured / kFollowed, left));
  }

  // Propagates over 2 · 2^half samples with the gain in their middle; true if it has not changed.
  bool hold(std::size_t half) {
    const FewStatesVector before = gain_;
    p_ = doubling_->ahead(p_, half);
    const FewStatesVector ph = p_ * h_;
    variance_ = h_.dot(ph) + noise_;
    gain_ = ph / variance_;
    p_ = doubling_->ahead(p_, half);
    return (gain_ - before).norm() <= kSettled * gain_.norm();
  }

  // Predicts over `count` missing samples, by powers of two.
  void predict(std::size_t count, std::size_t lanes) {
    FewStatesMatrix transition = transition_, driving = driving_;
    for (; count > 0; count >>= 1) {
      if (count % 2 == 1) {
        states(lanes) = (states(lanes) * transition.transpose()).eval();
        predict_covariance(p_, transition, driving);
      }
      const FewStatesMatrix once = driving;
      predict_covariance(driving, transition, once);
      transition = transition.lazyProduct(transition).eval();
    }
  }

  // One row per axis, one column per state.
  Eigen::Map<Eigen::MatrixXd> states(std::size_t lanes) {
    return {x_.data(), static_cast<Eigen::Index>(lanes), h_.size()};
  }

  FewStatesVector h_, level_, gain_;
  FewStatesMatrix p_, transition_, driving_;
  double noise_, variance_ = 0.0;
  std::size_t diffuse_;
  std::optional<CovarianceDoubling> doubling_;
  States x_{};
};

bool same_missing(std::span<const double> a, std::span<const double> b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
           return std::isfinite(x) == std::isfinite(y);
         });
}

LikelihoodRecord::Group grouped(std::span<const std::span<const double>> axes) {
  LikelihoodRecord::Group group;
  group.axes = axes.size();
  group.lanes = axes.size() == 1 ? 1 : static_cast<std::size_t>(kLanes);
  group.rows.assign(axes[0].size() * group.lanes, 0.0);
  for (std::size_t k = 0; k < axes[0].size(); ++k) {
    const bool missing = !std::isfinite(axes[0][k]);
    if (group.runs.empty() || group.runs.back().missing != missing) group.runs.push_back({0, missing});
    ++group.runs.back().length;
    for (std::size_t a = 0; a < axes.size(); ++a) {
      if (!missing) group.rows[k * group.lanes + a] = axes[a][k];
    }
  }
  return group;
}

}  // namespace

LikelihoodRecord::LikelihoodRecord(std::span<const std::span<const double>> axes) {
  const bool alike = axes.size() <= std::size_t{kLanes} &&
                     std::ranges::all_of(axes, [&](const auto& axis) { return same_missing(axes[0], axis); });
  if (alike)
    groups_.push_back(grouped(axes));
  else
    for (const auto& axis : axes) groups_.push_back(grouped({&axis, 1}));
}

double LikelihoodTerms::log_likelihood() const {
  return -0.5 *
         (static_cast<double>(count) * std::log(2 * std::numbers::pi) + sum_log_variance + sum_normalised);
}

LikelihoodTerms likelihood(const StateModel& model, double process_noise, double measurement_noise,
                           const LikelihoodRecord& record, double dt_s) {
  LikelihoodTerms sum;
  for (const LikelihoodRecord::Group& group : record.groups()) {
    const LikelihoodTerms one = Pass(model, process_noise, measurement_noise, dt_s).over(group);
    sum.count += one.count;
    sum.sum_log_variance += one.sum_log_variance;
    sum.sum_normalised += one.sum_normalised;
  }
  return sum;
}

}  // namespace ifog
