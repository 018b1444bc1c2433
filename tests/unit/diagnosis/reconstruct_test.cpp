// SPDX-License-Identifier: Apache-2.0
// What a channel was behind its readings.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "filters/diagnosis/channels/reconstruct.h"

namespace ifog {
namespace {

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST(Reconstruct, ATemperatureReadInWholeDegreesIsKnownToATenth) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<double> truth, read;
  for (int i = 0; i < 8000; ++i) {
    truth.push_back(30.0 + 11.3 * std::sin(2.0 * M_PI * i / 5000.0));
    read.push_back(std::round(truth.back() + noise(random)));
  }
  const Reconstruction found = reconstruct(read);
  EXPECT_TRUE(found.smooth);
  EXPECT_GT(rms_difference(read, truth), 0.25);
  EXPECT_LT(rms_difference(found.values, truth), 0.1);
}

// RMS error of what is made of a channel that is read with a noise of 0.01.
double left_of_noise(const std::vector<double>& truth, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<double> read;
  for (const double each : truth) read.push_back(each + noise(random));
  const Reconstruction found = reconstruct(read);
  EXPECT_TRUE(found.smooth);
  return rms_difference(found.values, truth);
}

TEST(Reconstruct, ReadingNoiseOfASmoothChannelIsSmoothedAway) {
  std::vector<double> truth;
  for (int i = 0; i < 8000; ++i) truth.push_back(30.0 + 11.3 * std::sin(2.0 * M_PI * i / 5000.0));
  EXPECT_LT(left_of_noise(truth, 2), 0.0025);
}

// Two kinks in hours of straight lines, and the spline has to turn there all the same.
TEST(Reconstruct, ARampBetweenSoaksKeepsItsKinks) {
  std::vector<double> truth{10.0};
  for (int i = 0; i < 22000; ++i) {
    const double target = 10.0 + 24.0 * std::clamp((i - 4000.0) / 13000.0, 0.0, 1.0);
    truth.push_back(truth.back() + (target - truth.back()) / 200.0);
  }
  EXPECT_LT(left_of_noise(truth, 5), 0.003);
}

// A spline through jumps or jitter would be another channel.
TEST(Reconstruct, WhatJumpsOrJittersStaysAsItWasRead) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise;
  std::vector<double> jumps, walk;
  double level = 0.0;
  double place = 0.0;
  for (int i = 0; i < 6000; ++i) {
    if (i % 200 == 0) level = 5.0 * noise(random);
    place += 0.05 * noise(random);
    jumps.push_back(level + 0.002 * noise(random));
    walk.push_back(place + 0.002 * noise(random));
  }
  for (const std::vector<double>& channel : {jumps, walk}) {
    const Reconstruction found = reconstruct(channel);
    EXPECT_FALSE(found.smooth);
    EXPECT_EQ(found.values, channel);
    EXPECT_FALSE(stands_still(channel));
  }
}

TEST(Reconstruct, ReadingNoiseAloneIsStandingStill) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise;
  int moving = 0;
  for (int channel = 0; channel < 50; ++channel) {
    std::vector<double> read;
    for (int i = 0; i < 5000; ++i) read.push_back(3.9 + 0.002 * noise(random));
    moving += stands_still(read) ? 0 : 1;
  }
  EXPECT_EQ(moving, 0);
}

}  // namespace
}  // namespace ifog
