// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/undeclared/scoring.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace ifog::undeclared {
namespace {

using Series = std::vector<double>;
constexpr double kInvisible = 3.0;  // sigma
constexpr int kNextCapture = 50;    // any number above those of the diagnosed captures

double mean(const Series& x) {
  double sum = 0.0;
  for (const double v : x) sum += v;
  return sum / static_cast<double>(x.size());
}

double rms(const Series& x, double about = 0.0) {
  double sum = 0.0;
  for (const double v : x) sum += (v - about) * (v - about);
  return std::sqrt(sum / static_cast<double>(x.size()));
}

const ModelParameter* parameter_named(const Effect& e, const std::string& name) {
  for (const ModelParameter& p : e.parameters)
    if (p.name == name) return &p;
  return nullptr;
}

const char* shape_name(const TrueEffect& truth) {
  if (truth.form == "lagged") return "lag_s";
  if (truth.form == "line") return "frequency_hz";
  if (truth.form == "warm_up") return "time_constant_s";
  if (truth.form == "step") return "time_s";
  return nullptr;  // a rate's bandwidth is chosen by the search, not determined by the data
}

bool same_names(const TrueEffect& truth, const Effect& found) {
  if (truth.with_channel.empty())
    return found.with_channel.empty() && truth.form == found.form && truth.channel == found.channel;
  const auto is = [](const std::string& form, const std::string& wanted) {
    return form == wanted || form == "product";
  };
  const bool straight = truth.channel == found.channel && truth.with_channel == found.with_channel &&
                        is(found.form, truth.form) && is(found.with_form, truth.with_form);
  const bool crossed = truth.channel == found.with_channel && truth.with_channel == found.channel &&
                       is(found.form, truth.with_form) && is(found.with_form, truth.form);
  return straight || crossed;
}

// A line at another frequency or a step at another time is another effect.
bool same_place(const TrueEffect& truth, const Effect& found, double record_s) {
  const char* name = shape_name(truth);
  const ModelParameter* p = name == nullptr ? nullptr : parameter_named(found, name);
  if (p == nullptr) return true;
  if (truth.form == "line") return std::abs(p->value - truth.shape) < 2.0 / record_s;
  if (truth.form == "step") return std::abs(p->value - truth.shape) < 0.05 * record_s;
  return true;
}

// The hidden parabola is about its channel's reference and has no linear term there.
bool places_turning_point(const TrueEffect& truth, const Effect& found) {
  if (truth.form != "quadratic" || !truth.with_channel.empty() || found.form != "linear" ||
      found.channel != truth.channel)
    return false;
  const ModelParameter* p = parameter_named(found, "coefficient");
  return p != nullptr && std::abs(p->value) <= kInvisible * p->std_error;
}

void add_parameter(Score& s, const std::string& effect, const Effect& found, const char* name, double truth,
                   double oracle = 0.0) {
  const ModelParameter* p = parameter_named(found, name);
  if (p == nullptr || !(p->std_error > 0.0)) return;
  s.parameters.push_back(
      {effect + " " + name, (p->value - truth) / p->std_error, oracle > 0.0 ? p->std_error / oracle : 0.0});
}

void score_names(Score& s, const Sensor& sensor, const std::vector<Record>& records, const Finding& finding) {
  const double record_s = static_cast<double>(sensor.samples) * sensor.dt_s;
  std::vector<bool> used(finding.effects.size(), false), matched(sensor.effects.size(), false);
  for (std::size_t t = 0; t < sensor.effects.size(); ++t)
    for (std::size_t f = 0; f < finding.effects.size() && !matched[t]; ++f) {
      const TrueEffect& truth = sensor.effects[t];
      const Effect& found = finding.effects[f].effect;
      if (used[f] || !same_names(truth, found) || !same_place(truth, found, record_s)) continue;
      used[f] = matched[t] = true;
      ++s.exact;
      const std::string name = name_of(found);
      if (truth.form != "line")
        add_parameter(s, name, found, "coefficient", truth.size, std::abs(truth.size) / truth.sigma);
      if (const char* shape = shape_name(truth)) add_parameter(s, name, found, shape, truth.shape);
    }
  // Each capture may have its own phase of a line and its own step.
  for (const TrueEffect& truth : sensor.effects) {
    if (truth.form != "line" && truth.form != "step") continue;
    std::size_t again = records.size();
    for (std::size_t f = 0; f < used.size(); ++f) {
      const Effect& found = finding.effects[f].effect;
      if (again == 0 || !same_names(truth, found) || !same_place(truth, found, record_s)) continue;
      used[f] = true;
      --again;
    }
  }

  for (std::size_t t = 0; t < sensor.effects.size(); ++t)
    for (std::size_t f = 0; f < used.size(); ++f)
      if (!used[f] && matched[t] && places_turning_point(sensor.effects[t], finding.effects[f].effect)) {
        used[f] = true;
        ++s.completed;
      }

  const auto left = static_cast<int>(std::count(used.begin(), used.end(), false));
  const int unmatched = s.hidden - s.exact;
  s.missed = unmatched;
  s.extra = left;
  if (unmatched == 0 || left == 0) return;

  const Visibility oracle = visibility(sensor);
  Visibility::Column hidden(records.size());
  std::vector<Visibility::Column> found(finding.effects.size());
  for (std::size_t c = 0; c < records.size(); ++c) {
    hidden[c].assign(sensor.samples, 0.0);
    for (std::size_t t = 0; t < matched.size(); ++t)
      for (std::size_t k = 0; !matched[t] && k < sensor.samples; ++k)
        hidden[c][k] += records[c].effects[t][k];
    for (std::size_t f = 0; f < found.size(); ++f)
      found[f].push_back(finding.effects[f].waveform(records[c].capture));
  }
  if (oracle.of(hidden, found) >= kInvisible) return;
  s.equivalent = unmatched;
  s.missed = 0;
  s.extra = 0;
  for (std::size_t f = 0; f < found.size(); ++f) {
    if (used[f]) continue;
    std::vector<Visibility::Column> without(found);
    without.erase(without.begin() + static_cast<std::ptrdiff_t>(f));
    if (oracle.of(hidden, without) < kInvisible) {
      ++s.extra;
      found[f].assign(records.size(), Series(sensor.samples, 0.0));  // not used from here on
    }
  }
}

// Hysteresis should be reported as unexplained; effects in its own channel describe a part of it.
void score_uncovered(Score& s, const Sensor& sensor, const Finding& finding) {
  for (const Claim& f : finding.effects)
    if (f.effect.channel != sensor.effects[0].channel || !f.effect.with_channel.empty()) ++s.extra;
  s.exact = finding.unexplained ? 1 : 0;
  s.missed = 1 - s.exact;
}

// For the longest predicted time within the capture, with the bias from its beginning.
std::optional<double> heading_square(const HeadingPrediction& predicted, const Series& noise,
                                     const Series& difference, double dt_s) {
  const auto align = static_cast<std::size_t>(std::lround(predicted.aligned_s / dt_s));
  std::size_t last = 0, end = 0;
  for (std::size_t i = 0; i < predicted.after_s.size(); ++i) {
    const std::size_t k = align + static_cast<std::size_t>(std::lround(predicted.after_s[i] / dt_s));
    if (k > noise.size() || k <= end) continue;
    last = i;
    end = k;
  }
  if (align == 0 || end == 0) return std::nullopt;
  double bias = 0.0, heading = 0.0;
  for (std::size_t k = 0; k < end; ++k) {
    const double left = noise[k] - difference[k];
    if (k < align)
      bias += left / static_cast<double>(align);
    else
      heading += (left - bias) * dt_s;
  }
  return heading * heading / (predicted.sigma_rad[last] * predicted.sigma_rad[last]);
}

void score_next_capture(Score& s, const Sensor& sensor, const Finding& finding) {
  const Record next = record(sensor, kNextCapture);
  Series difference(sensor.samples, 0.0), truth(sensor.samples, 0.0);
  for (const Series& e : next.effects)
    for (std::size_t k = 0; k < truth.size(); ++k) truth[k] += e[k];
  for (const Claim& f : finding.effects) {
    const Series estimate = f.waveform(next.capture);
    for (std::size_t k = 0; k < truth.size(); ++k) difference[k] += estimate[k];
  }
  for (std::size_t k = 0; k < truth.size(); ++k) difference[k] -= truth[k];
  for (const TrueEffect& e : sensor.effects)
    s.transferable = s.transferable && e.form != "line" && e.form != "step";

  const Series noise = block_means(next.noise, sensor.dt_s, 10.0);
  const double scale = rms(noise, mean(noise));
  const Series error = block_means(difference, sensor.dt_s, 10.0),
               effect = block_means(truth, sensor.dt_s, 10.0);
  s.effect_error = rms(error) / scale;
  s.shape_error = rms(error, mean(error)) / scale;
  s.effect_size = rms(effect, mean(effect)) / scale;

  if (finding.heading)
    s.heading_square = heading_square(finding.heading(next.capture), next.noise, difference, sensor.dt_s);
}

}  // namespace

std::vector<double> block_means(const Series& x, double dt_s, double seconds) {
  const auto length = static_cast<std::size_t>(std::max(1.0, std::round(seconds / dt_s)));
  Series out;
  for (std::size_t k = 0; k + length <= x.size(); k += length) {
    double sum = 0.0;
    for (std::size_t i = 0; i < length; ++i) sum += x[k + i];
    out.push_back(sum / static_cast<double>(length));
  }
  return out;
}

std::string name_of(const Effect& e) {
  std::string out = e.form;
  if (!e.channel.empty()) out += " " + e.channel;
  if (!e.with_channel.empty()) out += " x " + e.with_form + " " + e.with_channel;
  return out;
}

Score score(const Sensor& sensor, const Diagnose& diagnose) {
  std::vector<Record> records;
  std::vector<Capture> captures;
  for (int c = 0; c < sensor.captures; ++c) {
    records.push_back(record(sensor, c));
    captures.push_back(records.back().capture);
  }
  Score s;
  s.kind = sensor.kind;
  s.seed = sensor.seed;
  s.hidden = static_cast<int>(sensor.effects.size());
  s.sigma = sensor.effects.empty() ? 0.0 : sensor.effects[0].sigma;
  const auto start = std::chrono::steady_clock::now();
  const Finding finding = diagnose(captures);
  s.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  s.unexplained = finding.unexplained;
  s.contradictions = finding.contradictions;
  for (const Claim& f : finding.effects) s.names += (s.names.empty() ? "" : " + ") + name_of(f.effect);
  if (sensor.kind == Kind::kUncovered)
    score_uncovered(s, sensor, finding);
  else
    score_names(s, sensor, records, finding);
  score_next_capture(s, sensor, finding);
  return s;
}

}  // namespace ifog::undeclared
