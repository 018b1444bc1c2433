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
// Samples after the start over which the gain is followed one by one, and the divisor of their number after
// that.
constexpr std::size_t kFollowed = 256;
// Samples after a missing one over which it is followed again: what is fast in the model has then recovered.
constexpr std::size_t kRecovery = 16;
// A gain that changes by less than this share from one hold to the next has settled.
constexpr double kSettled = 1e-9;

// Covariance and gain, which no measurement changes, so of any number of axes: compiled once for each number
// of states, and apart from the samples' loop.
template <int n>
class GainOf {
 public:
  using Vector = Eigen::Matrix<double, n, 1>;
  using Matrix = Eigen::Matrix<double, n, n>;

  GainOf(const StateModel& model, double process_noise, double measurement_noise, double dt_s);

  [[nodiscard]] const Vector& gain() const { return core_.gain; }
  [[nodiscard]] const Vector& measurement() const { return core_.h; }
  [[nodiscard]] const Matrix& transition() const { return transition_; }
  // Variance of the innovation.
  [[nodiscard]] double variance() const { return variance_; }

  // To the next sample's prediction.
  void predict();
  // Corrects this sample's prediction.
  void correct();
  // Over 2^half samples and as many again, with the gain in their middle; whether it is still what it was.
  bool hold(std::size_t half);

 private:
  KalmanCore<n> core_;
  Matrix transition_, driving_;
  double noise_, variance_ = 0.0;
  std::optional<CovarianceDoubling> doubling_;
};

template <int n>
GainOf<n>::GainOf(const StateModel& model, double process_noise, double measurement_noise, double dt_s)
    : noise_(measurement_noise) {
  core_.h = model.measurement();
  model.discretise(dt_s, transition_, driving_);
  driving_ *= process_noise;
  core_.p = process_noise * model.stationary();
  const double loudness = noise_ + core_.variance() + core_.h.dot(driving_ * core_.h);
  core_.p.diagonal() += kDiffuse * loudness * model.diffuse();
  doubling_.emplace(transition_, driving_, core_.h, noise_);
}

template <int n>
void GainOf<n>::predict() {
  core_.predict_covariance(transition_, driving_);
}

template <int n>
void GainOf<n>::correct() {
  variance_ = core_.variance() + noise_;
  core_.correct(variance_);
}

template <int n>
bool GainOf<n>::hold(std::size_t half) {
  const Vector before = core_.gain;
  core_.p = doubling_->ahead(core_.p, half);
  const Vector ph = core_.p * core_.h;
  variance_ = core_.h.dot(ph) + noise_;
  core_.gain = ph / variance_;
  const bool settled = (core_.gain - before).norm() <= kSettled * core_.gain.norm();
  core_.p = doubling_->ahead(core_.p, half);
  return settled;
}

template <int n, int lanes>
class Pass {
 public:
  Pass(const StateModel& model, double process_noise, double measurement_noise, double dt_s)
      : gain_(model, process_noise, measurement_noise, dt_s),
        level_(model.level()),
        diffuse_(static_cast<std::size_t>((model.diffuse().array() > 0).count())) {}

  LikelihoodTerms over(const LikelihoodRecord::Group& group) {
    const double* row = group.rows.data();
    LikelihoodTerms terms;
    std::size_t measured = 0;
    for (const LikelihoodRecord::Run& run : group.runs) {
      if (run.missing) {
        for (std::size_t k = 0; k < run.length && measured > 0; ++k) predict();
        row += run.length * lanes;
        continue;
      }
      if (measured == 0 && diffuse_ > 0) start(row);
      bool settled = false;
      for (std::size_t done = 0; done < run.length;) {
        const std::size_t left = run.length - done;
        const std::size_t hold = settled ? left : held(measured, done, left);
        if (hold == 1)
          gain_.correct();
        else if (!settled)
          settled = gain_.hold(static_cast<std::size_t>(std::bit_width(hold) - 2));
        const double squares = take(row, hold, group.axes);
        if (hold == 1) gain_.predict();
        if (measured >= diffuse_) {
          terms.count += static_cast<long>(hold * group.axes);
          terms.sum_log_variance += static_cast<double>(hold * group.axes) * std::log(gain_.variance());
          terms.sum_normalised += squares / gain_.variance();
        }
        done += hold;
        measured += hold;
        row += hold * lanes;
      }
    }
    return terms;
  }

 private:
  using Row = Eigen::Array<double, lanes, 1>;

  // Samples over which the gain may be held, a power of two.
  static std::size_t held(std::size_t measured, std::size_t since_missing, std::size_t left) {
    if (measured < 2 * kFollowed || since_missing < kRecovery) return 1;
    return std::bit_floor(std::min(measured / kFollowed, left));
  }

  void start(const double* row) {
    for (int a = 0; a < lanes; ++a) x_.row(a) = level_.transpose() * row[a];
  }

  void predict() {
    x_ = (x_.matrix() * gain_.transition().transpose()).array().eval();
    gain_.predict();
  }

  // `count` samples at this gain, from prediction to prediction. Returns the sum of the squared innovations.
  double take(const double* row, std::size_t count, std::size_t axes) {
    const typename GainOf<n>::Matrix& transition = gain_.transition();
    const typename GainOf<n>::Vector& h = gain_.measurement();
    const typename GainOf<n>::Vector predictor = transition * gain_.gain();
    std::array<Row, n> x, next;
    for (int i = 0; i < n; ++i) x[at(i)] = x_.col(i);
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
    for (int i = 0; i < n; ++i) x_.col(i) = x[at(i)];
    double sum = 0.0;
    for (std::size_t a = 0; a < axes; ++a) sum += squares(static_cast<Eigen::Index>(a));
    return sum;
  }
  static constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }

  GainOf<n> gain_;
  typename GainOf<n>::Vector level_;
  std::size_t diffuse_;
  Eigen::Array<double, lanes, n> x_ = Eigen::Array<double, lanes, n>::Zero();
};

template <int n>
LikelihoodTerms sized(const StateModel& model, double process_noise, double measurement_noise,
                      const LikelihoodRecord& record, double dt_s) {
  LikelihoodTerms sum;
  for (const LikelihoodRecord::Group& group : record.groups()) {
    const LikelihoodTerms one = group.lanes == 1
                                    ? Pass<n, 1>(model, process_noise, measurement_noise, dt_s).over(group)
                                    : Pass<n, 4>(model, process_noise, measurement_noise, dt_s).over(group);
    sum.count += one.count;
    sum.sum_log_variance += one.sum_log_variance;
    sum.sum_normalised += one.sum_normalised;
  }
  return sum;
}

bool same_missing(std::span<const double> a, std::span<const double> b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
           return std::isfinite(x) == std::isfinite(y);
         });
}

LikelihoodRecord::Group grouped(std::span<const std::span<const double>> axes) {
  LikelihoodRecord::Group group;
  group.axes = axes.size();
  group.lanes = axes.size() == 1 ? 1 : 4;
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
  constexpr std::size_t kMostAxes = 4;
  std::vector<std::span<const double>> left(axes.begin(), axes.end());
  while (!left.empty()) {
    std::vector<std::span<const double>> together, others;
    for (const auto& axis : left)
      (same_missing(left[0], axis) && together.size() < kMostAxes ? together : others).push_back(axis);
    groups_.push_back(grouped(together));
    left = std::move(others);
  }
}

double LikelihoodTerms::log_likelihood() const {
  return -0.5 *
         (static_cast<double>(count) * std::log(2 * std::numbers::pi) + sum_log_variance + sum_normalised);
}

LikelihoodTerms likelihood(const StateModel& model, double process_noise, double measurement_noise,
                           const LikelihoodRecord& record, double dt_s) {
  constexpr std::array kSized{sized<1>, sized<2>, sized<3>, sized<4>, sized<5>, sized<6>, sized<7>, sized<8>};
  return kSized.at(static_cast<std::size_t>(model.states() - 1))(model, process_noise, measurement_noise,
                                                                 record, dt_s);
}

LikelihoodTerms likelihood(const StateModel& model, double process_noise, double measurement_noise,
                           std::span<const double> rate, double dt_s) {
  const std::span<const double> axes[] = {rate};
  return likelihood(model, process_noise, measurement_noise, LikelihoodRecord(axes), dt_s);
}

}  // namespace ifog
