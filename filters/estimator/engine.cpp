#include "filters/estimator/engine.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "filters/kalman/core.h"

namespace ifog {
namespace {

// Variance before the first measurement as a multiple of the measurement's: large enough to be forgotten
// after one measurement, small enough to leave the covariance ten digits.
constexpr double kDiffuse = 1e6;

template <int n>
class SizedEngine final : public Engine {
 public:
  explicit SizedEngine(EngineParts parts) : parts_(std::move(parts)) {
    core_.h = parts_.model->measurement();
    level_ = parts_.model->level();
    restart();
  }

  void step(const EstimatorInput& in, EstimatorOutput& out) noexcept override {
    out.flags = 0;
    discretise(in.dt_s);
    core_.predict(transition_, driving_);

    std::array<double, kMaxAxes> innovations{};
    std::array<int, kMaxAxes> axis_of{};
    std::size_t count = 0;
    for (int axis = 0; axis < parts_.axes; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      out.innovation_radps[a] = 0.0;
      if ((in.valid_axes >> a & 1U) == 0 || !std::isfinite(in.rate_radps[a])) continue;
      if (!started_[a]) {
        started_[a] = true;
        core_.x.col(axis) = level_ * in.rate_radps[a];
      }
      innovations[count] = out.innovation_radps[a] = in.rate_radps[a] - core_.rate(axis);
      axis_of[count++] = axis;
    }

    double c = core_.variance();
    if (count == 0) {
      core_.gain.setZero();
    } else {
      const double scale = in.averaged_s > 0.0 ? parts_.period_s / in.averaged_s : 1.0;
      if (first_) {
        first_ = false;
        c += parts_.settings.measurement_noise * scale;
      } else {
        c = parts_.rule->innovation_covariance({c, scale, {innovations.data(), count}, in.sequence});
      }
      core_.correct(c);
      for (std::size_t i = 0; i < count; ++i) core_.update(axis_of[i], innovations[i]);
    }

    const double variance = core_.variance();
    for (int axis = 0; axis < parts_.axes; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      out.denoised_radps[a] = core_.rate(axis);
      out.variance_rad2ps2[a] = variance;
      out.innovation_variance[a] = c;
      out.gain[a] = core_.h.dot(core_.gain);
      health_.measurement_noise[a] = parts_.rule->measurement_noise();
    }
    health_.floor_hits = parts_.rule->floor_hits();
  }

  void restart() noexcept override {
    first_ = true;
    started_ = {};
    core_.x.setZero();
    core_.p = parts_.settings.process_noise * parts_.model->stationary();
    core_.p.diagonal() += kDiffuse * parts_.settings.measurement_noise * parts_.model->diffuse();
    parts_.rule->restart();
  }

  const EstimatorHealth& health() const noexcept override { return health_; }

 private:
  using Core = KalmanCore<n>;

  void discretise(double dt_s) noexcept {
    if (dt_s == discretised_dt_s_) return;
    discretised_dt_s_ = dt_s;
    parts_.model->discretise(dt_s, transition_, driving_);
    driving_ *= parts_.settings.process_noise;
  }

  EngineParts parts_;
  Core core_;
  typename Core::Vector level_;
  typename Core::Matrix transition_, driving_;
  double discretised_dt_s_ = -1.0;
  bool first_ = true;
  std::array<bool, kMaxAxes> started_{};
  EstimatorHealth health_;
};

template <int n>
std::unique_ptr<Engine> make_sized(EngineParts parts) {
  return std::make_unique<SizedEngine<n>>(std::move(parts));
}

}  // namespace

std::unique_ptr<Engine> make_engine(EngineParts parts) {
  using Make = std::unique_ptr<Engine> (*)(EngineParts);
  constexpr std::array<Make, kMaxStates> kMakers{make_sized<1>, make_sized<2>, make_sized<3>, make_sized<4>,
                                                 make_sized<5>, make_sized<6>, make_sized<7>, make_sized<8>};
  const int states = parts.model->states();
  if (states < 1 || states > kMaxStates) {
    throw std::invalid_argument("state: " + std::to_string(states) + " states in all, expected 1 to " +
                                std::to_string(kMaxStates));
  }
  return kMakers[static_cast<std::size_t>(states - 1)](std::move(parts));
}

}  // namespace ifog
