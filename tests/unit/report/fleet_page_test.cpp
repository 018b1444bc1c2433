// SPDX-License-Identifier: Apache-2.0
#include "tools/report/pages/fleet_page.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace {

using namespace ifog;
using namespace ifog::report;

// Twelve gyros of which the last has neither the effect nor the others' noise, and one without a result.
Population example() {
  Population p;
  p.type = "T<1>";
  TypeEffect effect;
  effect.effect.form = "linear";
  effect.effect.channel = "temperature_degC";
  effect.effect.meaning = "bias by temperature & more";
  effect.effect.parameters = {{"coefficient", 0.0, 0.0, "rad/s/degC"}};
  PopulationParameter noise;
  noise.name = "N";
  noise.unit = "rad/s/rtHz";
  noise.logarithmic = true;
  for (std::size_t i = 0; i < 13; ++i) {
    p.serials.push_back("G" + std::to_string(i));
    if (i == 12) continue;
    const double wiggle = 0.1 * std::sin(static_cast<double>(i));
    EffectInGyro each;
    each.gyro = i;
    each.own = Estimate{(i == 11 ? 0.0 : 6e-9) + 1e-9 * wiggle, 1e-9};
    each.found_alone = i < 4;
    effect.gyros.push_back(each);
    noise.gyros.push_back(i);
    noise.values.push_back({(i == 11 ? 9e-8 : 2e-8) * (1.0 + wiggle), 1e-10});
  }
  judge(effect, 0.01);
  effect.gyros.front().with_prior = Estimate{6e-9, 2e-10};
  p.effects = {effect};
  describe(noise);
  p.parameters = {noise};
  p.standing_out = standing_out(p.parameters);
  p.failed = {{12, "G12.csv: no <such> file"}};
  return p;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(FleetPage, SaysWhatTheTypeHasWhoStandsOutAndWhoFailed) {
  const Population population = example();
  FleetPage page;
  page.population = &population;
  page.made = "today";
  page.command = "ifog fleet 'a<b.toml'";
  const std::string html = fleet_page(page);
  for (const char* id : {"account", "failed", "effects", "parameters", "standing-out", "gyros", "origin"})
    EXPECT_TRUE(has(html, "<h2 id=\"" + std::string(id) + "\">")) << id;
  EXPECT_FALSE(has(html, "<h2 id=\"own\">"));  // nothing to say
  EXPECT_TRUE(has(html, "found in 4 gyros by themselves, in 11 of 12 with what the type says"));
  EXPECT_TRUE(has(html, "<a href=\"gyros/G11/report.html\">G11</a></th><td>N</td>"));
  EXPECT_TRUE(has(html, "12 of 13 gyros have a result"));
}

TEST(FleetPage, WhatFilesSayIsText) {
  const Population population = example();
  FleetPage page;
  page.population = &population;
  page.command = "ifog fleet 'a<b.toml'";
  const std::string html = fleet_page(page);
  EXPECT_TRUE(has(html, "T&lt;1&gt;") && has(html, "no &lt;such&gt; file") && has(html, "a&lt;b.toml"));
  EXPECT_TRUE(has(html, "Bias by temperature &amp; more."));
  EXPECT_FALSE(has(html, "T<1>") || has(html, "no <such>") || has(html, "a<b.toml"));
}

}  // namespace
