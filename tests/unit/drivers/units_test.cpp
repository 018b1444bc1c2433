// SPDX-License-Identifier: Apache-2.0
// Units as DBC files spell them, against factors worked out by hand.
#include "drivers/units/units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace {

using ifog::angle_unit;

constexpr double kDegree = 0.017453292519943295;  // π / 180
constexpr double kTurn = 6.283185307179586;       // 2 π

struct Case {
  const char* text;
  double rad_per_s;
};

const Case kSpelled[] = {{"rad/s", 1.0},
                         {"rad/sec", 1.0},
                         {"RAD/S", 1.0},
                         {"rads/s", 1.0},
                         {"radian/second", 1.0},
                         {"radians/s", 1.0},
                         {"rad/second", 1.0},
                         {"radps", 1.0},
                         {"rad s^-1", 1.0},
                         {"rad*s^-1", 1.0},
                         {"rad.s-1", 1.0},
                         {"rad\xC2\xB7s\xE2\x81\xBB\xC2\xB9", 1.0},
                         {"rad per second", 1.0},
                         {"[rad/s]", 1.0},
                         {" rad / s ", 1.0},
                         {"rad/sec.", 1.0},
                         {"mrad/s", 1e-3},
                         {"mrad/sec", 1e-3},
                         {"urad/s", 1e-6},
                         {"\xC2\xB5rad/s", 1e-6},
                         {"\xCE\xBCrad/s", 1e-6},
                         {"\xB5rad/s", 1e-6},
                         {"nrad/s", 1e-9},
                         {"rad/min", 1.0 / 60.0},
                         {"rad/h", 1.0 / 3600.0},
                         {"deg/s", kDegree},
                         {"Deg/s", kDegree},
                         {"DEG/S", kDegree},
                         {"Deg/Sec", kDegree},
                         {"deg/sec", kDegree},
                         {"degs/s", kDegree},
                         {"degree/s", kDegree},
                         {"degree/second", kDegree},
                         {"degrees/s", kDegree},
                         {"degrees/sec", kDegree},
                         {"degrees per second", kDegree},
                         {"deg_per_s", kDegree},
                         {"(deg/s)", kDegree},
                         {"deg s-1", kDegree},
                         {"dps", kDegree},
                         {"DPS", kDegree},
                         {"degps", kDegree},
                         {"mdps", kDegree / 1e3},
                         {"\xC2\xB0/s", kDegree},
                         {"\xB0/s", kDegree},
                         {"\xB0/sec", kDegree},
                         {"\xC2\xB0/sec", kDegree},
                         {"\xC2\xBA/s", kDegree},
                         {"\xBA/s", kDegree},
                         {"\xC3\x82\xC2\xB0/s", kDegree},
                         {"\xA1\xC6/s", kDegree},
                         {"\xA1\xE3/s", kDegree},
                         {"\x81\x8B/s", kDegree},
                         {"\xC2\xB0 / s", kDegree},
                         {"m\xC2\xB0/s", kDegree / 1e3},
                         {"Grad/s", kDegree},
                         {"Grad/Sek", kDegree},
                         {"Unit_DegreOfArcPerSecon", kDegree},
                         {"mdeg/s", kDegree / 1e3},
                         {"cdeg/s", kDegree / 1e2},
                         {"deg/min", kDegree / 60.0},
                         {"deg/h", kDegree / 3600.0},
                         {"deg/hr", kDegree / 3600.0},
                         {"\xC2\xB0/h", kDegree / 3600.0},
                         {"deg/hour", kDegree / 3600.0},
                         {"dph", kDegree / 3600.0},
                         {"arcsec/s", kDegree / 3600.0},
                         {"arcmin/s", kDegree / 60.0},
                         {"gon/s", kTurn / 400.0},
                         {"rpm", kTurn / 60.0},
                         {"RPM", kTurn / 60.0},
                         {"1/min", kTurn / 60.0},
                         {"min-1", kTurn / 60.0},
                         {"min^-1", kTurn / 60.0},
                         {"U/min", kTurn / 60.0},
                         {"r/min", kTurn / 60.0},
                         {"rev/min", kTurn / 60.0},
                         {"rev/s", kTurn},
                         {"Unit_MinutInver", kTurn / 60.0},
                         {"deg/ms", kDegree * 1e3},
                         // Of public DBC files.
                         {"degree/second", kDegree},
                         {"degrees/second", kDegree},
                         {"radians/second", 1.0},
                         {"radians/sec", 1.0},
                         {"deg/S", kDegree},
                         {"deg/sek", kDegree},
                         {"Degr\xC3\xA9/s", kDegree},
                         {"Degr\xE9/s", kDegree},
                         {"degr\xC3\xA9s/s", kDegree},
                         {"\xC2\xB0Grad/s", kDegree},
                         {"\xB0Grad/s", kDegree},
                         {"Grad/sec", kDegree},
                         {"R/min", kTurn / 60.0},
                         {"upm", kTurn / 60.0},
                         {"Unit_DegreePerSecond", kDegree},
                         // Of manuals and of files in other code pages and tongues.
                         {"\xCB\x9A/s", kDegree},
                         {"\xE2\x81\xB0/s", kDegree},
                         {"&deg;/s", kDegree},
                         {"&#176;/sec", kDegree},
                         {"\xF8/s", kDegree},
                         {"\xC2\xB0\xC2\xA0/\xC2\xA0s", kDegree},
                         {"\xE5\xBA\xA6/\xE7\xA7\x92", kDegree},
                         {"\xE5\xBA\xA6/s", kDegree},
                         {"\xE5\xBC\xA7\xE5\xBA\xA6/\xE7\xA7\x92", 1.0},
                         {"\xD0\xB3\xD1\x80\xD0\xB0\xD0\xB4/\xD1\x81", kDegree},
                         {"\xD1\x80\xD0\xB0\xD0\xB4/\xD1\x81", 1.0},
                         {"rad/Sekunde", 1.0},
                         {"Radiant/s", 1.0},
                         {"tr/min", kTurn / 60.0},
                         {"Umdr/min", kTurn / 60.0},
                         {"krpm", kTurn / 60.0 * 1e3},
                         {"mDPS", kDegree / 1e3},
                         {"udps", kDegree / 1e6},
                         {"mradps", 1e-3},
                         {"millidegrees/s", kDegree / 1e3},
                         {"milliradians per second", 1e-3},
                         {"microradians/s", 1e-6},
                         {"deg s**-1", kDegree},
                         {"deg s^(-1)", kDegree},
                         {"deg.s^{-1}", kDegree},
                         {"degrees/hour", kDegree / 3600.0},
                         {"deg/hours", kDegree / 3600.0},
                         {"\xC2\xB0/hr", kDegree / 3600.0},
                         {"deg/hrs", kDegree / 3600.0},
                         {"Grad/Std", kDegree / 3600.0},
                         {"deg/minutes", kDegree / 60.0},
                         {"\xE2\x80\xB3/s", kDegree / 3600.0},
                         {"\xE2\x80\xB2/min", kDegree / 3600.0},
                         {"arcseconds/second", kDegree / 3600.0},
                         {"mas/s", kDegree / 3600.0e3}};

TEST(Units, RatesAsTheyAreSpelled) {
  for (const Case& c : kSpelled) {
    const std::optional<double> found = angle_unit(c.text, true, false);
    ASSERT_TRUE(found) << c.text;
    EXPECT_NEAR(*found, c.rad_per_s, 1e-12 * c.rad_per_s) << c.text;
  }
}

TEST(Units, WhatIsNoRateOrTwoIsRefused) {
  for (const char* text : {"",
                           " ",
                           "deg",
                           "rad",
                           "\xC2\xB0",
                           "s",
                           "1",
                           "/s",
                           "deg/",
                           "deg/s^2",
                           "deg/s/s",
                           "rad/s2",
                           "rad/s-1",
                           "rad s^-2",
                           "deg/m",
                           "m/s",
                           "m/s^2",
                           "g",
                           "km/h",
                           "%",
                           "V",
                           "\xC2\xB0"
                           "C",
                           "deg*s",
                           "0.01 deg/s",
                           "deg/s %",
                           "grad/s",
                           "grad",
                           "1/s",
                           "s^-1",
                           "Hz",
                           "rps",
                           "Mrad/s",
                           "Mdeg/s",
                           "MRAD/S",
                           "dBm",
                           "furlong/s",
                           "per",
                           "per s",
                           "\xEF\xBF\xBD/s",
                           "-1",
                           "^-1",
                           "[",
                           "()",
                           "r/s",
                           "U/sec",
                           "1/rad/s",
                           "deg/s**2",
                           "deg/s^(-1)",
                           "rpm/ms",
                           "Nm/s",
                           "l/min",
                           "Unit_None",
                           "Unit_PerCent",
                           "\xC2\xB0/s\xC2\xB2"})
    EXPECT_FALSE(angle_unit(text, true, false)) << text;
}

TEST(Units, AngleAndTime) {
  EXPECT_NEAR(*angle_unit("\xB0", false, false), kDegree, 1e-15);
  EXPECT_NEAR(*angle_unit("Degrees", false, false), kDegree, 1e-15);
  EXPECT_NEAR(*angle_unit("Grad", false, false), kDegree, 1e-15);
  EXPECT_FALSE(angle_unit("deg/s", false, false));
  EXPECT_NEAR(*angle_unit("deg", true, true), kDegree, 1e-15);
  EXPECT_NEAR(*angle_unit("deg/h", true, true), kDegree / 3600.0, 1e-18);
  EXPECT_EQ(ifog::time_unit("us"), 1e-6);
  EXPECT_EQ(ifog::time_unit("\xC2\xB5s"), 1e-6);
  EXPECT_EQ(ifog::time_unit("Sec"), 1.0);
  EXPECT_FALSE(ifog::time_unit("deg"));
}

TEST(Units, ChannelsAreConverted) {
  struct Row {
    const char *from, *to;
    double value, becomes;
  };
  for (const Row& row :
       {Row{"degF", "degC", 212.0, 100.0}, Row{"K", "degC", 273.15, 0.0},
        Row{"\xC2\xB0\x43", "degC", 25.0, 25.0}, Row{"degC", "K", -273.15, 0.0},
        Row{"mg", "mps2", 1000.0, 9.80665}, Row{"mV", "V", 1500.0, 1.5}, Row{"gauss", "uT", 0.5, 50.0},
        Row{"hPa", "Pa", 1013.25, 101325.0}, Row{"deg/s", "radps", 180.0, kTurn / 2},
        Row{"ms", "s", 5.0, 0.005}, Row{"counts", "counts", 7.0, 7.0}}) {
    const auto conversion = ifog::convert_unit(row.from, row.to);
    ASSERT_TRUE(conversion) << row.from << " to " << row.to;
    EXPECT_NEAR(row.value * conversion->scale + conversion->offset, row.becomes,
                1e-9 * std::abs(row.value) + 1e-12)
        << row.from << " to " << row.to;
  }
  EXPECT_FALSE(ifog::convert_unit("G", "uT"));  // a gauss to some, 9.8 m/s² to others
  EXPECT_FALSE(ifog::convert_unit("V", "degC"));
  EXPECT_FALSE(ifog::convert_unit("furlong", "mps2"));
  EXPECT_FALSE(ifog::convert_unit("V", "counts"));
}

}  // namespace
