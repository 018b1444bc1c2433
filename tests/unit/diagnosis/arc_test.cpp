// SPDX-License-Identifier: Apache-2.0
// A turntable of which a first capture saw a part of the circle and the next one sees all of it. Once a turn
// is made here by its law, the written model is run over the next capture, and what it leaves is counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnose.h"
#include "filters/diagnosis/record/compensated_error.h"
#include "tests/unit/diagnosis/gaussian_deviate.h"

namespace ifog {
namespace {

constexpr double kTurn = 2.0 * M_PI;
constexpr double kWhite = 1e-6;
constexpr std::uint32_t kSamples = 9000;
constexpr double kStep_s = 0.2;

struct Table {
  std::vector<double> time, rate, reference, angle;
  [[nodiscard]] Record record() const {
    Record r;
    r.name = "table";
    r.time_s = time;
    r.rate_radps = rate;
    r.reference_radps = reference;
    r.channels = {{"table_rad", angle}};
    return r;
  }
};

// At angle turned(time), with the error error(angle) and white noise.
template <class Turned, class Error>
Table make(std::uint32_t stream, double noise, Turned turned, Error error) {
  Table table;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const double t = kStep_s * i;
    const double angle = turned(t);
    table.time.push_back(t);
    table.reference.push_back((turned(t + 0.1) - turned(t - 0.1)) / 0.2);
    table.angle.push_back(angle - kTurn * std::floor(angle / kTurn));
    table.rate.push_back(table.reference.back() + error(angle) + noise * gaussian_deviate(i, stream, 41, 6));
  }
  return table;
}

double spread(std::vector<double> x) {
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  double square = 0.0;
  for (const double v : x) square += (v - mean) * (v - mean);
  return std::sqrt(square / static_cast<double>(x.size()));
}

// What the written model leaves of a capture without noise, over what it was given.
double left_of(const Diagnosis& diagnosis, const Table& next) {
  Model model;
  add_to_model(diagnosis, "", model);
  const auto after = compensated_error(next.record(), model);
  const auto before = compensated_error(next.record(), Model{});
  return spread({after.begin(), after.end()}) / spread({before.begin(), before.end()});
}

std::string all_in_words(const Diagnosis& diagnosis) {
  std::string words;
  for (const FoundEffect& found : diagnosis.effects)
    words += found.effect.form + " of " + found.effect.channel + "; ";
  return words;
}

bool all_swings(const Diagnosis& diagnosis) {
  return std::all_of(diagnosis.effects.begin(), diagnosis.effects.end(), [](const FoundEffect& each) {
    return each.effect.form == "cosine" || each.effect.form == "sine";
  });
}

double all_round(double t) { return 0.05 * t + 3.0 * std::sin(t / 30.0); }

// A tenth of a turn in unlike swings, all on one side of where the angle wraps.
double short_arc(double t) {
  const double swing =
      std::sin(kTurn * t / 411.0) + 0.7 * std::sin(kTurn * t / 163.0) + 0.4 * std::sin(kTurn * t / 97.0);
  return 5.9 + 0.17 * swing;
}

// Polynomials of the angle, which the arc shows as well, leave it and know nothing of the circle.
TEST(Arc, WhatAShortOneShowsDoesNoHarmRoundTheCircle) {
  int found_any = 0;
  for (std::uint32_t stream = 1; stream <= 6; ++stream) {
    const double phase = 1.1 * stream;
    const auto law = [&](double a) { return 6e-6 * (std::cos(a + phase) + 0.5 * std::cos(2.0 * a)); };
    const Diagnosis found = diagnose({make(stream, kWhite, short_arc, law).record()}, {});
    EXPECT_TRUE(all_swings(found)) << stream << ": " << all_in_words(found);
    found_any += found.effects.empty() ? 0 : 1;
    EXPECT_LT(left_of(found, make(0, 0.0, all_round, law)), 1.1) << stream << ": " << all_in_words(found);
    if (!found.effects.empty()) {
      EXPECT_LT(left_of(found, make(0, 0.0, short_arc, law)), 0.3) << stream << ": within the arc";
    }
  }
  EXPECT_GE(found_any, 3);
}

// A fifth of a turn about where a cosine turns: one term says all that the record shows, and its law has
// more, which makes the rest of the circle.
TEST(Arc, ALawIsWrittenWhole) {
  const auto law = [](double a) { return 5e-7 * (std::cos(a + 0.4) + 0.4 * std::cos(2.0 * a)); };
  const auto arc = [](double t) {
    return 0.4 + 0.7 * (0.6 * std::sin(kTurn * t / 210.0) + 0.4 * std::sin(kTurn * t / 83.0));
  };
  const Table next = make(0, 0.0, all_round, law);
  constexpr std::uint32_t kFirst = 11, kCount = 6;
  double square = 0.0;
  for (std::uint32_t stream = kFirst; stream < kFirst + kCount; ++stream) {
    const Diagnosis found = diagnose({make(stream, kWhite, arc, law).record()}, {});
    EXPECT_EQ(found.effects.size(), 4U) << stream << ": " << all_in_words(found);
    EXPECT_TRUE(all_swings(found)) << stream << ": " << all_in_words(found);
    const double left = left_of(found, next);
    square += left * left / kCount;
  }
  EXPECT_LT(std::sqrt(square), 0.7);
}

}  // namespace
}  // namespace ifog
