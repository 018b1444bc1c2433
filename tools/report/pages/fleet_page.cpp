// SPDX-License-Identifier: Apache-2.0
#include "tools/report/pages/fleet_page.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <set>

#include "drivers/ifog/quoted.h"
#include "tools/report/chart.h"
#include "tools/report/pages/section.h"
#include "tools/report/pages/words.h"
#include "tools/report/text.h"

namespace ifog::report {
namespace {

constexpr std::size_t kMostDrawn = 7;  // parameters per picture; one colour each

std::string linked(const Population& p, std::size_t gyro) {
  const std::string serial = escaped(p.serials[gyro]);
  return "<a href=\"gyros/" + serial + "/report.html\">" + serial + "</a>";
}

std::string on_axis(const std::string& axis) { return axis.empty() ? "" : ", axis " + axis; }

std::string count(std::size_t n, std::size_t of) { return std::to_string(n) + " of " + std::to_string(of); }

// Gyros from left to right in the manifest's order, beginning with 1, with a margin.
ChartAxis gyro_axis(const std::vector<std::string>& serials, std::size_t last) {
  constexpr std::size_t kLongest = 16;
  ChartAxis axis{"gyro, in the manifest's order", false, 0.5, static_cast<double>(last) + 1.5};
  for (const std::string& serial : serials) axis.names.push_back(printable(serial, kLongest));
  return axis;
}

// With a margin above and below the bands.
ChartAxis roomy_axis(const std::string& label, std::initializer_list<const std::vector<double>*> all) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const std::vector<double>* const values : all)
    for (const double value : *values)
      if (std::isfinite(value)) least = std::min(least, value), most = std::max(most, value);
  if (!(most >= least)) return {label, false, {}, {}};
  const double room = most > least ? 0.12 * (most - least) : std::max(std::abs(most), 1e-300) * 0.1;
  return {label, false, least - room, most + room};
}

// Each gyro's coefficient with and without the type's prior, in the manifest's order.
std::string gyros_picture(const TypeEffect& effect, const std::vector<std::string>& serials) {
  const FieldUnit unit = field_unit(effect.effect.parameters.front().unit);
  std::vector<double> x, own, with_x, with, band_x, low, high;
  for (const EffectInGyro& each : effect.gyros) {
    if (!each.own) continue;
    x.push_back(static_cast<double>(each.gyro) + 1.0);
    own.push_back(each.own->value * unit.scale);
    if (!each.with_prior) continue;
    with_x.push_back(x.back());
    with.push_back(each.with_prior->value * unit.scale);
  }
  if (x.size() < 2) return "";
  const ChartAxis along = gyro_axis(serials, effect.gyros.back().gyro);
  for (const double end : {*along.low, *along.high}) {
    band_x.push_back(end);
    low.push_back((effect.prior.mean - effect.prior.spread) * unit.scale);
    high.push_back((effect.prior.mean + effect.prior.spread) * unit.scale);
  }
  Chart chart("The coefficient in each gyro",
              "Each gyro's coefficient by its own captures, and together with what the type says.", along,
              roomy_axis("coefficient (" + unit.unit + ")", {&own, &with, &low, &high}));
  chart.band(Role::kFit, band_x, low, high);
  chart.points(Role::kBefore, "its captures alone", x, own);
  chart.points(Role::kAfter, "with the type's prior", with_x, with);
  return figure_html(
      chart.svg(),
      "Each gyro that the effect was measured in, and those that have it with what the type adds. "
      "The band is the type: mean and one standard deviation from gyro to gyro.");
}

std::string effect_section(const TypeEffect& effect, const std::vector<std::string>& serials) {
  const FieldUnit unit = field_unit(effect.effect.parameters.front().unit);
  const std::size_t measured = effect.all.count;
  const auto value = [&](double v, double error) {
    return with_error(v * unit.scale, error * unit.scale) + " " + escaped(unit.unit);
  };
  const auto spread = [&](double v) { return number(v * unit.scale, 3) + " " + escaped(unit.unit); };
  std::string rows =
      row("mean of those that have it", {value(effect.prior.mean, effect.prior.mean_std_error)}) +
      row("likeliest spread from gyro to gyro", {spread(effect.prior.likeliest_spread)}) +
      row("spread that is reckoned with, by so few gyros", {spread(effect.prior.spread)}) +
      row("excluded from these as outliers", {count(effect.set_aside, effect.gyros.size())}) +
      row("share of the type that has it", {number(100.0 * effect.prior.share, 3) + " %"}) +
      row("found by a gyro's own diagnosis", {count(effect.found_alone, effect.gyros.size())}) +
      row("found with the type's prior", {count(effect.found, effect.gyros.size())}) +
      row("all gyros measured (DerSimonian and Laird)",
          {value(effect.all.mean, effect.all.mean_std_error) + ", spread " + spread(effect.all.spread) +
           ", I² " + number(100.0 * effect.all.i_squared, 3) + " %"}) +
      row("twice the log-likelihood over nobody having it", {number(effect.prior.likelihood_ratio, 4)});
  for (std::size_t i = 1; i < effect.effect.parameters.size(); ++i)
    rows += row(escaped(effect.effect.parameters[i].name) + ", median of those found",
                {number(effect.effect.parameters[i].value)});
  return "<h3>" + escaped(effect_words(effect.effect) + on_axis(effect.effect.axis)) + "</h3>\n<p>" +
         escaped(sentence(effect.effect.meaning)) + "</p>\n" +
         table("In " + std::to_string(measured) + " gyros, standard errors one sigma", {"what", "value"},
               rows) +
         gyros_picture(effect, serials);
}

// Noise in the units of data sheets.
FieldUnit unit_of(const PopulationParameter& each) {
  if (!each.logarithmic) return field_unit(each.unit);
  if (each.name == "N") return {1.0 / kDegreePerRootHour, "°/√h"};
  if (each.name == "K") return {1.0 / kDegreePerHourPerRootHour, "°/h/√h"};
  if (each.name == "R") return {1.0 / kDegreePerHourPerHour, "°/h/h"};
  return field_unit(each.unit);
}

std::string parameter_label(const PopulationParameter& each) { return each.name + on_axis(each.axis); }

// A parameter with a log-normal spread is shown as a value with a relative spread.
std::string parameter_row(const PopulationParameter& each) {
  const FieldUnit unit = unit_of(each);
  const auto text_of = [&](double middle, double sigma) -> std::string {
    if (each.logarithmic)
      return number(std::exp(middle) * unit.scale) + " ± " + number(100.0 * sigma, 2) + " %";
    return number(middle * unit.scale) + " ± " + number(sigma * unit.scale, 2);
  };
  return row(
      escaped(parameter_label(each)),
      {escaped(unit.unit), std::to_string(each.values.size()), text_of(each.robust.median, each.robust.sigma),
       each.spread ? text_of(each.spread->mean, each.spread->spread) : "",
       each.spread ? number(100.0 * each.spread->i_squared, 3) + " %" : ""});
}

std::string z_picture(const Population& p) {
  if (p.serials.size() < 2) return "";
  const ChartAxis along = gyro_axis(p.serials, p.serials.size() - 1);
  const std::vector<double> limits = {-kStandsOut, kStandsOut};  // drawn even if no gyro is near them
  std::vector<double> drawn = limits;
  for (std::size_t i = 0; i < std::min(kMostDrawn, p.parameters.size()); ++i)
    drawn.insert(drawn.end(), p.parameters[i].z.begin(), p.parameters[i].z.end());
  Chart chart("How far each gyro is from the median", "Robust z of every parameter, over the gyros.", along,
              roomy_axis("distance from the median (robust σ)", {&drawn}));
  for (const double limit : limits) chart.guide(Role::kRaw, {*along.low, *along.high}, {limit, limit});
  for (std::size_t i = 0; i < std::min(kMostDrawn, p.parameters.size()); ++i) {
    const PopulationParameter& each = p.parameters[i];
    std::vector<double> x;
    for (const std::size_t gyro : each.gyros) x.push_back(static_cast<double>(gyro) + 1.0);
    chart.points(role_of(i), parameter_label(each), x, each.z);
  }
  if (chart.empty()) return "";
  return figure_html(chart.svg(),
                     "Gyros beyond the thin lines, 3.5 robust standard deviations, are outliers.");
}

std::string parameters_section(const Population& p) {
  std::string rows;
  for (const PopulationParameter& each : p.parameters) rows += parameter_row(each);
  return table("How the type's parameters are spread",
               {"parameter", "unit", "gyros", "median ± robust σ", "mean ± spread, without own errors", "I²"},
               rows) +
         z_picture(p);
}

std::string standing_out_section(const Population& p) {
  if (p.standing_out.empty()) return "<p>No outliers.</p>\n";
  std::string rows;
  for (const StandingOut& each : p.standing_out)
    rows += row(linked(p, each.gyro),
                {escaped(parameter_label(p.parameters[each.parameter])), number(each.z, 3)});
  return table("Farther than 3.5 robust σ from the median", {"gyro", "parameter", "robust z"}, rows);
}

std::string own_section(const Population& p) {
  std::string rows;
  for (const FoundInGyro& each : p.own)
    rows += row(linked(p, each.gyro), {escaped(effect_words(each.effect) + on_axis(each.effect.axis)),
                                       escaped(each.effect.meaning)});
  return table("Effects that single gyros have and the type has not", {"gyro", "effect", "what it is"}, rows);
}

std::string failures_section(const Population& p) {
  std::string rows;
  for (const Population::Failure& each : p.failed)
    rows += row(escaped(p.serials[each.gyro]), {escaped(printable(each.why, kLongestMessage))});
  return table("Gyros without a result, or without all of it", {"gyro", "why"}, rows);
}

std::string gyros_section(const Population& p) {
  std::set<std::size_t> failed;
  for (const Population::Failure& each : p.failed) failed.insert(each.gyro);
  std::string rows;
  for (std::size_t gyro = 0; gyro < p.serials.size(); ++gyro) {
    if (failed.count(gyro) > 0) continue;
    std::string effects;
    for (const TypeEffect& effect : p.effects)
      for (const EffectInGyro& each : effect.gyros)
        if (each.gyro == gyro && each.found)
          effects += (effects.empty() ? "" : ", ") + escaped(effect_words(effect.effect)) +
                     (each.found_alone ? "" : " (by the prior)");
    rows += row(linked(p, gyro), {effects});
  }
  return table("Every gyro's own page, and what it has of the type's effects", {"gyro", "has"}, rows);
}

std::string account(const Population& p) {
  std::string out = "<p>" + count(p.serials.size() - p.failed.size(), p.serials.size()) +
                    " gyros have a result" + (p.failed.empty() ? "." : "; the others are named below.") +
                    "</p>\n";
  for (const TypeEffect& each : p.effects) out += "<p>" + escaped(sentence(in_words(each))) + "</p>\n";
  for (const std::string& remark : p.remarks) out += "<p>" + escaped(sentence(remark)) + "</p>\n";
  return "<div class=\"account\">" + out + "</div>\n";
}

// The most likely spread; the spread in use is larger if few gyros cannot exclude it.
std::string spread_in_words(const TypeEffect& effect, double scale) {
  const double likeliest = effect.prior.likeliest_spread, most = effect.prior.spread;
  return ", from gyro to gyro ± " + number(likeliest * scale, 2) +
         (likeliest < most ? " (by so few gyros ± " + number(most * scale, 2) + " is reckoned with)" : "") +
         (effect.set_aside > 0
              ? ", without " + count(effect.set_aside, effect.gyros.size()) + " that stand out"
              : "");
}

}  // namespace

std::string in_words(const TypeEffect& effect) {
  const FieldUnit unit = field_unit(effect.effect.parameters.front().unit);
  return "the type has an effect " + effect_words(effect.effect) + on_axis(effect.effect.axis) + ": " +
         with_error(effect.prior.mean * unit.scale, effect.prior.mean_std_error * unit.scale) + " " +
         unit.unit + spread_in_words(effect, unit.scale) + "; found in " +
         std::to_string(effect.found_alone) + " gyros by themselves, in " +
         count(effect.found, effect.gyros.size()) + " with what the type says";
}

std::string fleet_page(const FleetPage& page) {
  const Population& p = *page.population;
  const std::string title = "Gyros of type " + escaped(printable(p.type));
  std::string effects;
  for (const TypeEffect& each : p.effects) effects += effect_section(each, p.serials);
  const std::string body =
      section("account", "In short", account(p)) +
      section("failed", "Without a result", failures_section(p)) +
      section("effects", "What the type has", effects) +
      section("parameters", "How the type is spread", parameters_section(p)) +
      section("standing-out", "Outliers", standing_out_section(p)) +
      section("own", "What only single gyros have", own_section(p)) +
      section("gyros", "The gyros", gyros_section(p)) +
      section("origin", "Where it comes from", "<p>Made by</p>\n<pre>" + escaped(page.command) + "</pre>\n");
  return whole_page(
      title, std::to_string(p.serials.size()) + " gyros", body,
      "Made " + escaped(page.made) +
          ". Rates in °/h; JSON and model files are in SI units. Under the pointer a picture shows "
          "its values; draw over a stretch to look closer, twice on it for the whole.");
}

}  // namespace ifog::report
