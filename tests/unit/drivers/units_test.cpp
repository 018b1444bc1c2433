// SPDX-License-Identifier: Apache-2.0
// Units as DBC files spell them, against factors worked out by hand.
#include "drivers/units/units.h"
#include "tests/unit/test.h"

namespace {

using ifog::angle_unit;

constexpr double kDegree = 0.017453292519943295;  // π / 180
constexpr double kTurn = 6.283185307179586;       // 2 π

// rad/s per unit, and its spellings: in DBC files, in manuals, and in files of other code pages and tongues.
const std::pair<double, const char*> kSpelled[] = {
    {1.0,
     "rad/s|rad/sec|RAD/S|rads/s|radian/second|radians/s|rad/second|radps|rad s^-1|rad*s^-1|rad.s-1|"
     "rad\xC2\xB7s\xE2\x81\xBB\xC2\xB9|rad per second|[rad/s]| rad / s |rad/sec.|radians/second|"
     "radians/sec|\xE5\xBC\xA7\xE5\xBA\xA6/\xE7\xA7\x92|\xD1\x80\xD0\xB0\xD0\xB4/\xD1\x81|"
     "rad/Sekunde|Radiant/s"},
    {1e-3, "mrad/s|mrad/sec|mradps|milliradians per second"},
    {1e-6, "urad/s|\xC2\xB5rad/s|\xCE\xBCrad/s|\xB5rad/s|microradians/s"},
    {1e-9, "nrad/s"},
    {1.0 / 60.0, "rad/min"},
    {1.0 / 3600.0, "rad/h"},
    {kDegree,
     "deg/s|Deg/s|DEG/S|Deg/Sec|deg/sec|degs/s|degree/s|degree/second|degrees/s|degrees/sec|"
     "degrees per second|deg_per_s|(deg/s)|deg s-1|dps|DPS|degps|\xC2\xB0/s|\xB0/s|\xB0/sec|"
     "\xC2\xB0/sec|\xC2\xBA/s|\xBA/s|\xC3\x82\xC2\xB0/s|\xA1\xC6/s|\xA1\xE3/s|\x81\x8B/s|"
     "\xC2\xB0 / s|Grad/s|Grad/Sek|Unit_DegreOfArcPerSecon|degrees/second|deg/S|deg/sek|"
     "Degr\xC3\xA9/s|Degr\xE9/s|degr\xC3\xA9s/s|\xC2\xB0Grad/s|\xB0Grad/s|Grad/sec|"
     "Unit_DegreePerSecond|\xCB\x9A/s|\xE2\x81\xB0/s|&deg;/s|&#176;/sec|\xF8/s|"
     "\xC2\xB0\xC2\xA0/\xC2\xA0s|\xE5\xBA\xA6/\xE7\xA7\x92|\xE5\xBA\xA6/s|"
     "\xD0\xB3\xD1\x80\xD0\xB0\xD0\xB4/\xD1\x81|deg s**-1|deg s^(-1)|deg.s^{-1}"},
    {kDegree / 1e3, "mdps|m\xC2\xB0/s|mdeg/s|mDPS|millidegrees/s"},
    {kDegree / 1e2, "cdeg/s"},
    {kDegree / 60.0, "deg/min|arcmin/s|deg/minutes"},
    {kDegree / 3600.0,
     "deg/h|deg/hr|\xC2\xB0/h|deg/hour|dph|arcsec/s|degrees/hour|deg/hours|\xC2\xB0/hr|deg/hrs|"
     "Grad/Std|\xE2\x80\xB3/s|\xE2\x80\xB2/min|arcseconds/second"},
    {kTurn / 400.0, "gon/s"},
    {kTurn / 60.0,
     "rpm|RPM|1/min|min-1|min^-1|U/min|r/min|rev/min|Unit_MinutInver|R/min|upm|tr/min|Umdr/min"},
    {kTurn, "rev/s"},
    {kDegree * 1e3, "deg/ms"},
    {kTurn / 60.0 * 1e3, "krpm"},
    {kDegree / 1e6, "udps"},
    {kDegree / 3600.0e3, "mas/s"},
};

std::vector<std::string> split(const std::string& texts) {
  std::vector<std::string> out;
  std::istringstream in(texts);
  for (std::string text; std::getline(in, text, '|');) out.push_back(text);
  return out;
}

TEST(Units, RatesAsTheyAreSpelled) {
  for (const auto& [rad_per_s, spellings] : kSpelled)
    for (const std::string& text : split(spellings)) {
      const std::optional<double> found = angle_unit(text, true, false);
      ASSERT_TRUE(found) << text;
      EXPECT_NEAR(*found, rad_per_s, 1e-12 * rad_per_s) << text;
    }
}

TEST(Units, WhatIsNoRateOrTwoIsRefused) {
  for (const std::string& text :
       split("| |deg|rad|\xC2\xB0|s|1|/s|deg/|deg/s^2|deg/s/s|rad/s2|rad/s-1|rad s^-2|deg/m|m/s|m/s^2|g|"
             "km/h|%|V|\xC2\xB0\x43|deg*s|0.01 deg/s|deg/s %|grad/s|grad|1/s|s^-1|Hz|rps|Mrad/s|Mdeg/s|"
             "MRAD/S|dBm|furlong/s|per|per s|\xEF\xBF\xBD/s|-1|^-1|[|()|r/s|U/sec|1/rad/s|deg/s**2|"
             "deg/s^(-1)|rpm/ms|Nm/s|l/min|Unit_None|Unit_PerCent|\xC2\xB0/s\xC2\xB2"))
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
