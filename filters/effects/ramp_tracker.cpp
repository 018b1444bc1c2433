// SPDX-License-Identifier: Apache-2.0
#include "filters/effects/ramp_tracker.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "filters/model_file/form.h"

namespace ifog {
namespace {

constexpr double kPi2 = 2.0 * std::numbers::pi;
constexpr double kProof = 25.0;            // log-likelihood ratio of a phase to none
constexpr double kMemory = 8.0 * kProof;   // memory as energy of the table, in units of the noise
constexpr double kLeastSamples = 32.0;     // for a noise estimate
constexpr double kSlowSamples = 512.0;     // running mean that is removed, as in the fit of the table
constexpr double kScatterSamples = 128.0;  // averaging of the noise's square
constexpr double kRampUncertainty = 1e-5;  // of k, relative, over temperature
constexpr double kFrequencyTimes = 4.0;    // tracking time of a frequency offset in memories of the phase
constexpr double kFarOff = 10.0;           // in sample noises; kInARow such samples are a new rate
constexpr int kInARow = 3;
constexpr double kMostInnovation = 4.0;  // in sample noises; limit of an innovation
constexpr int kDecideEvery = 8;          // samples, in acquisition
constexpr int kLocateEvery = 16;         // in tracking
constexpr std::size_t kLanes = 8;        // parallel sums for vectorisation

double wrapped(double cycles) noexcept { return cycles - std::floor(cycles); }

// Cosine and sine parts of harmonics 1 … n/2 of n equidistant values of a cycle.
std::vector<std::complex<double>> harmonics_of(const std::vector<double>& values) {
  const std::size_t n = values.size();
  std::vector<std::complex<double>> parts(n / 2);
  for (std::size_t h = 1; h <= parts.size(); ++h) {
    const std::complex<double> turn =
        std::polar(1.0, -kPi2 * static_cast<double>(h) / static_cast<double>(n));
    std::complex<double> carrier = 1.0;
    for (const double value : values) {
      parts[h - 1] += value * carrier;
      carrier *= turn;
    }
    parts[h - 1] *= (2 * h == n ? 1.0 : 2.0) / static_cast<double>(n);
  }
  return parts;
}

// Factor of a harmonic's amplitude, averaged over phases of this standard deviation.
double kept_of(std::size_t harmonic, double sigma) {
  const double radians = kPi2 * static_cast<double>(harmonic) * sigma;
  return std::exp(-0.5 * radians * radians);
}

// Adds to each phase the energy that it explains of one sample. Returns the mean energy of the table, in
// units of the noise.
template <std::size_t count>
double add_sample(const float* now, const float* before, double error, double weight, double covered_s,
                  float keep, std::array<float, count>& gained) noexcept {
  const auto scale = static_cast<float>(std::sqrt(weight) / covered_s);
  const auto twice = static_cast<float>(2.0 * error * std::sqrt(weight));
  std::array<float, kLanes> squares{};
  for (std::size_t cell = 0; cell < count; cell += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float ramp = (now[cell + lane] - before[cell + lane]) * scale;
      squares[lane] += ramp * ramp;
      gained[cell + lane] = keep * gained[cell + lane] + ramp * (twice - ramp);
    }
  }
  double information = 0.0;
  for (const float square : squares) information += static_cast<double>(square) / count;
  return information;
}

// Variance of the phase at which averaging keeps this share of the power of the table's slope.
double variance_that_keeps(double share, const std::vector<std::complex<double>>& parts) {
  const auto kept = [&](double sigma) {
    double all = 0.0;
    double left = 0.0;
    for (std::size_t h = 0; h < parts.size(); ++h) {
      const double power = std::norm(parts[h]) * static_cast<double>((h + 1) * (h + 1));
      const double amplitude = kept_of(h + 1, sigma);
      all += power;
      left += power * amplitude * amplitude;
    }
    return left / std::max(all, 1e-300);
  };
  double low = 0.0;
  double high = 0.5;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (kept(middle) > share ? low : high) = middle;
  }
  return low * low;
}

}  // namespace

RampSettings ramp_settings(const Effect& effect) {
  RampSettings settings;
  settings.cycles_per_rad = parameter(effect, "cycles_per_rad");
  settings.noise_density = parameter(effect, "noise_density");
  settings.phase_walk = parameter(effect, "phase_walk");
  const std::size_t knots = effect.table_x.size();
  if (knots < 5 || effect.table_y.size() != knots)
    throw std::invalid_argument("a rebuilt ramp needs a table of one cycle, of at least five knots");
  for (std::size_t i = 0; i < knots; ++i) {
    const double even = static_cast<double>(i) / static_cast<double>(knots - 1);
    if (std::abs(effect.table_x[i] - even) > 1e-9)
      throw std::invalid_argument("a rebuilt ramp's table_x goes from 0 to 1 cycle in even steps");
  }
  settings.angle_rad.assign(effect.table_y.begin(), effect.table_y.end() - 1);
  return settings;
}

RampTracker::RampTracker(RampSettings settings) : settings_(std::move(settings)) {
  if (!(std::abs(settings_.cycles_per_rad) > 0.0) || !std::isfinite(settings_.cycles_per_rad))
    throw std::invalid_argument("cycles_per_rad is no number of cycles");
  if (!(settings_.noise_density > 0.0)) throw std::invalid_argument("noise_density is not positive");
  if (!(settings_.phase_walk >= 0.0)) throw std::invalid_argument("phase_walk is negative");
  if (settings_.angle_rad.size() < 4 || settings_.angle_rad.size() > 2 * kCells)
    throw std::invalid_argument("a rebuilt ramp's table has 4 to 512 values");
  build_tables();
}

void RampTracker::Comb::set(const std::vector<double>& table, std::size_t steps_apart) {
  stride = steps_apart;
  angle.resize(2 * kSteps);
  for (std::size_t row = 0; row < stride; ++row) {
    const std::size_t columns = 2 * kSteps / stride;
    for (std::size_t i = 0; i < columns; ++i)
      angle[row * columns + i] = static_cast<float>(table[(row + stride * i) % kSteps]);
  }
}

void RampTracker::build_tables() {
  const std::vector<std::complex<double>> parts = harmonics_of(settings_.angle_rad);
  tables_.assign(kVague * (kSteps + 1), 0.0);
  std::vector<double> exact(kSteps);
  for (std::size_t h = 0; h < parts.size(); ++h) {
    const std::complex<double> turn = std::polar(1.0, kPi2 * static_cast<double>(h + 1) / kSteps);
    std::complex<double> carrier = parts[h];
    std::array<double, kVague> kept{};
    for (std::size_t t = 0; t < kVague; ++t)
      kept[t] = kept_of(h + 1, std::ldexp(kVaguest, -static_cast<int>(t)));
    for (std::size_t i = 0; i <= kSteps; ++i, carrier *= turn) {
      if (i < kSteps) exact[i] += carrier.real();
      for (std::size_t t = kVague; t-- > 0 && kept[t] > 1e-9;)
        tables_[t * (kSteps + 1) + i] += kept[t] * carrier.real();
    }
  }
  wide_.set(exact, kSteps / kCells);
  // Eight phases per shortest wave of the table; closer ones cannot be distinguished. 64 of them cover four
  // waves on either side.
  const std::size_t apart = std::bit_floor(kSteps / (8 * std::max<std::size_t>(parts.size() / 2, 1)));
  near_by_.set(exact, std::clamp<std::size_t>(apart, 1, kSteps / kNear));
  const double cell = static_cast<double>(near_by_.stride) / kSteps;
  least_variance_ = cell * cell / 12.0;
  // Resolution of the acquisition, for any table.
  constexpr double kTwoCells = 2.0 / kCells;
  most_variance_ = std::max(variance_that_keeps(0.25, parts), kTwoCells * kTwoCells);
}

void RampTracker::use_table() noexcept {
  table_ = 0;
  for (double vague = kVaguest; table_ + 1 < kVague && variance_ < 0.5 * vague * vague; vague *= 0.5)
    ++table_;
}

double RampTracker::at(double cycles) const noexcept {
  const double* const table = tables_.data() + table_ * (kSteps + 1);
  const double position = wrapped(cycles) * kSteps;
  const std::size_t i = std::min(static_cast<std::size_t>(position), kSteps - 1);
  return table[i] + (table[i + 1] - table[i]) * (position - static_cast<double>(i));
}

// Over a gap the angle is extrapolated with the mean rate; its uncertainty follows from the scatter of the
// rate.
void RampTracker::pass_over(double missed_s) noexcept {
  const double guess = std::abs(settings_.cycles_per_rad) * missed_s * std::sqrt(scatter_);
  phase_ = wrapped(phase_ + (turning_ + frequency_) * missed_s);
  loosen(guess * guess + settings_.phase_walk * settings_.phase_walk * missed_s);
  if (locked_) angle_ = at(phase_ + offset_);
}

// Error of k: proportional to the angle turned, unlike noise.
void RampTracker::loosen_by_turning(double cycles, double covered_s) noexcept {
  if (!locked_) return;
  const double beyond = kRampUncertainty * std::abs(cycles - settled_ * covered_s);
  settled_ += (cycles / covered_s - settled_) / kSlowSamples;
  loosen(beyond * (2.0 * std::sqrt(variance_) + beyond));
}

// The phase has changed by an unknown amount of this variance: the likelihood is raised to a power that
// widens it accordingly.
void RampTracker::loosen(double variance) noexcept {
  if (!locked_) {
    if (variance > most_variance_) lose();
    return;
  }
  const auto keep = static_cast<float>(variance_ / (variance_ + variance));
  for (float& gained : near_) gained *= keep;
  variance_ += variance;
  if (variance_ > most_variance_)
    lose();
  else
    use_table();
}

double RampTracker::step(const RampSample& in) noexcept {
  const bool measured = std::isfinite(in.measured_radps) && std::isfinite(in.rest_radps);
  const double missed = measured ? std::clamp(in.missed_s, 0.0, in.dt_s) : in.dt_s;
  if (missed > 0.0) pass_over(missed);
  const double covered = in.dt_s - missed;
  if (!measured || !(covered > 0.0)) return 0.0;
  const double turn = settings_.cycles_per_rad * in.measured_radps * covered;
  Sight sight{phase_,
              wrapped(phase_ + turn + frequency_ * covered),
              wrapped(phase_ + (turning_ + frequency_) * covered),
              covered,
              in.rest_radps - slow_,
              0.0};
  phase_ = sight.end;
  loosen_by_turning(turn, covered);
  const double known = settings_.noise_density * settings_.noise_density / covered;
  if (slow_weight_ == 0.0) {
    learn_slow_part(in.rest_radps, in.rest_radps, turn / covered, known);
    return 0.0;
  }
  double ramp = 0.0;
  if (locked_) {
    sight.weight = 1.0 / std::max(known, scatter_);
    ramp = follow(sight);
    if (!locked_) ramp = 0.0;
  } else {
    scatter_weight_ = std::min(scatter_weight_ + 1.0, kScatterSamples);
    scatter_ += (sight.error * sight.error - scatter_) / scatter_weight_;
    sight.weight = 1.0 / std::max(known, scatter_);
    turned_ += turning_ * covered;
    acquire(sight);
  }
  learn_slow_part(in.rest_radps, in.rest_radps - ramp, turn / covered, known);
  return ramp;
}

// Running mean of at most 512 samples; restarts after a turn at the new rate.
void RampTracker::learn_slow_part(double rest, double without_ramp, double turning,
                                  double variance) noexcept {
  const double off = without_ramp - slow_;
  const bool far = slow_weight_ > 0.0 && off * off > kFarOff * kFarOff * variance;
  far_off_ = far ? far_off_ + 1 : 0;
  if (slow_weight_ == 0.0 || far_off_ >= kInARow) {
    slow_ = locked_ ? without_ramp : rest;
    turning_ = turning;
    slow_weight_ = 1.0;
    far_off_ = 0;
    return;
  }
  slow_weight_ = std::min(slow_weight_ + 1.0, kSlowSamples);
  slow_ += off / slow_weight_;
  turning_ += (turning - turning_) / slow_weight_;
}

void RampTracker::acquire(const Sight& sight) noexcept {
  const std::size_t now = std::min(static_cast<std::size_t>(sight.expected * kSteps), kSteps - 1);
  const std::size_t before = std::min(static_cast<std::size_t>(sight.start * kSteps), kSteps - 1);
  const double information =
      add_sample(wide_.at(now), wide_.at(before), sight.error, sight.weight, sight.covered_s, 1.0F, gained_);
  const double keep = std::max(0.0, 1.0 - information / kMemory);
  for (float& gained : gained_) gained *= static_cast<float>(keep);
  energy_ = keep * (energy_ + sight.error * sight.error * sight.weight);
  samples_ = keep * (samples_ + 1.0);
  decide();
}

void RampTracker::decide() noexcept {
  if (++undecided_ < kDecideEvery || samples_ < kLeastSamples || std::abs(turned_) < 1.0) return;
  undecided_ = 0;
  const double energy = std::max(energy_, samples_);
  const double wanted = energy * -std::expm1(-2.0 * kProof / samples_);
  const auto best = std::ranges::max_element(gained_);
  if (*best >= wanted) lock(static_cast<std::size_t>(best - gained_.begin()));
}

void RampTracker::lock(std::size_t cell) noexcept {
  locked_ = true;
  proof_ = gained_[cell];
  frequency_ = 0.0;
  settled_ = turning_;
  undecided_ = 0;
  const std::size_t middle = cell * (kSteps / kCells);
  first_near_ = (middle + kSteps - kNear / 2 * near_by_.stride) % kSteps;
  for (std::size_t i = 0; i < kNear; ++i) {
    const double position =
        static_cast<double>((first_near_ + i * near_by_.stride) % kSteps) * kCells / kSteps;
    const auto low = static_cast<std::size_t>(position);
    const auto share = static_cast<float>(position - static_cast<double>(low));
    near_[i] = gained_[low] + share * (gained_[(low + 1) % kCells] - gained_[low]);
  }
  locate(0.0);
  if (locked_) angle_ = at(phase_ + offset_);
}

void RampTracker::lose() noexcept {
  locked_ = false;
  frequency_ = 0.0;
  gained_.fill(0.0F);
  energy_ = samples_ = turned_ = 0.0;
  undecided_ = 0;
}

double RampTracker::follow(const Sight& sight) noexcept {
  const double now = at(sight.end + offset_);
  const double correction = (now - angle_) / sight.covered_s;
  angle_ = now;
  const double before = at(sight.start + offset_);
  const double ramp = (now - before) / sight.covered_s;
  const double expected = (at(sight.expected + offset_) - before) / sight.covered_s;
  const double innovation = sight.error - ramp;
  scatter_ += (std::min(innovation * innovation, 1e4 / sight.weight) - scatter_) / kScatterSamples;
  const double most = kMostInnovation / std::sqrt(sight.weight);
  const double error = std::clamp(sight.error, ramp - most, ramp + most);

  const auto step_of = [this](double cycles) {
    return (std::min(static_cast<std::size_t>(cycles * kSteps), kSteps - 1) + first_near_) % kSteps;
  };
  const double walk = settings_.phase_walk * settings_.phase_walk * sight.covered_s;
  add_sample(near_by_.at(step_of(sight.expected)), near_by_.at(step_of(sight.start)), error, sight.weight,
             sight.covered_s, static_cast<float>(variance_ / (variance_ + walk)), near_);
  const double information = expected * expected * sight.weight;
  proof_ = std::max(0.0, 1.0 - information / kMemory) * proof_ +
           (2.0 * error - expected) * expected * sight.weight;
  if (++undecided_ >= kLocateEvery) locate(sight.covered_s * undecided_);
  if (proof_ < 0.0) lose();
  return correction;
}

// Mean and variance of the phase over the tracked ones, and the frequency from the drift of the mean.
void RampTracker::locate(double seconds) noexcept {
  undecided_ = 0;
  const float best = *std::ranges::max_element(near_);
  double sum = 0.0;
  double first = 0.0;
  double second = 0.0;
  for (std::size_t i = 0; i < kNear; ++i) {
    if (near_[i] < best - 40.0F) continue;
    const double weight = std::exp(0.5 * static_cast<double>(near_[i] - best));
    const auto place = static_cast<double>(i);
    sum += weight;
    first += weight * place;
    second += weight * place * place;
  }
  const double mean = first / sum;
  const double cell = static_cast<double>(near_by_.stride) / kSteps;
  const double offset = static_cast<double>(first_near_) / kSteps + cell * mean;
  variance_ = std::max(cell * cell * (second / sum - mean * mean), least_variance_);
  if (seconds > 0.0) {
    const double walk = settings_.phase_walk * settings_.phase_walk;
    const double moved = offset - offset_ - std::round(offset - offset_);
    frequency_ += moved * walk / (kFrequencyTimes * (variance_ + walk * seconds));
  }
  offset_ = wrapped(offset);
  if (variance_ > most_variance_) {
    lose();
    return;
  }
  use_table();
  const auto middle = static_cast<std::size_t>(std::lround(mean));
  if (middle < kNear / 4 || middle > kNear - kNear / 4) recentre(middle);
}

// Shifts the tracked phases to the most likely one; new ones get the value of the outermost.
void RampTracker::recentre(std::size_t middle) noexcept {
  std::array<float, kNear> moved{};
  for (std::size_t i = 0; i < kNear; ++i)
    moved[i] = near_[std::min(i + middle > kNear / 2 ? i + middle - kNear / 2 : 0, kNear - 1)];
  near_ = moved;
  first_near_ = (first_near_ + kSteps + middle * near_by_.stride - kNear / 2 * near_by_.stride) % kSteps;
}

bool RampTracker::take_over(const RampTracker& previous) noexcept {
  if (settings_.cycles_per_rad != previous.settings_.cycles_per_rad ||
      settings_.angle_rad != previous.settings_.angle_rad)
    return false;
  static_cast<RampState&>(*this) = previous;
  return true;
}

}  // namespace ifog
