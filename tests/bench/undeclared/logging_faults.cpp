// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/undeclared/logging_faults.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "tests/bench/undeclared/draw.h"

namespace ifog::undeclared {
namespace {

double span_of(const Capture& c) { return c.time_s.back() - c.time_s.front(); }

std::size_t row_at(const Capture& c, double after_s) {
  const auto row = std::lower_bound(c.time_s.begin(), c.time_s.end(), c.time_s.front() + after_s);
  return std::min(c.size() - 1, static_cast<std::size_t>(row - c.time_s.begin()));
}

void leave_out_rows(Capture& c, Draw& draw) {
  const double length_s = std::min(300.0, 0.2 * span_of(c));
  const double start_s = draw.uniform(0.1, 0.7) * span_of(c);
  const auto from = static_cast<std::ptrdiff_t>(row_at(c, start_s));
  const auto to = static_cast<std::ptrdiff_t>(row_at(c, start_s + length_s));
  const auto cut = [&](std::vector<double>& column) {
    if (!column.empty()) column.erase(column.begin() + from, column.begin() + to);
  };
  cut(c.time_s);
  for (auto& rate : c.rate_radps) cut(rate);
  for (auto& reference : c.reference_rate_radps) cut(reference);
  for (CaptureColumn& channel : c.channels) cut(channel.values);
}

void say_sentinels(Capture& c, Draw& draw) {
  for (CaptureColumn& channel : c.channels) {
    if (!channel.name.ends_with("_degC")) continue;
    for (int i = 0; i < 3; ++i) {
      const double start_s = draw.uniform(0.05, 0.9) * span_of(c);
      const std::size_t to = row_at(c, start_s + draw.uniform(1.0, 10.0));
      for (std::size_t k = row_at(c, start_s); k < to; ++k) channel.values[k] = i == 1 ? -127.0 : 85.0;
    }
  }
}

void stand_still(Capture& c, Draw& draw) {
  for (CaptureColumn& channel : c.channels) {
    if (channel.name != "temperature_degC") continue;
    const double start_s = draw.uniform(0.1, 0.7) * span_of(c);
    const std::size_t from = row_at(c, start_s), to = row_at(c, start_s + 0.2 * span_of(c));
    for (std::size_t k = from; k < to; ++k) channel.values[k] = channel.values[from];
  }
}

void glitch(Capture& c, Draw& draw) {
  for (CaptureColumn& channel : c.channels) {
    const std::size_t k = row_at(c, draw.uniform(0.05, 0.95) * span_of(c));
    channel.values[k] = 1e3 * (std::abs(channel.values[k]) + 1.0);
  }
}

}  // namespace

const std::vector<std::string>& logging_faults() {
  static const std::vector<std::string> names = {"hole", "sentinel", "stuck", "glitch"};
  return names;
}

std::vector<Capture> spoilt(const std::string& fault, std::vector<Capture> captures) {
  const std::vector<std::function<void(Capture&, Draw&)>> spoil = {leave_out_rows, say_sentinels, stand_still,
                                                                   glitch};
  const auto& names = logging_faults();
  const auto at = std::find(names.begin(), names.end(), fault);
  if (at == names.end()) throw std::invalid_argument("'" + fault + "' is no fault of logging");
  std::uint64_t number = 0;
  for (Capture& capture : captures) {
    Draw draw(capture.size() + number++, 4242);
    spoil[static_cast<std::size_t>(at - names.begin())](capture, draw);
  }
  return captures;
}

Diagnose logged_with(const std::string& fault, Diagnose inner) {
  return [fault, inner = std::move(inner)](const std::vector<Capture>& captures) {
    return inner(spoilt(fault, captures));
  };
}

}  // namespace ifog::undeclared
