// SPDX-License-Identifier: Apache-2.0
#include "drivers/units/units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

// SI value = value * scale + offset, within a quantity. names: in lower case, as from plain(), between bars.
struct Unit {
  std::string_view names;
  double scale, offset = 0.0;
};
using Units = std::span<const Unit>;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kDegree = std::numbers::pi / 180.0;

constexpr Unit kAngles[] = {{"|rad|radian|radiant|", 1.0},
                            {"|deg|degree|degre|degreofarc|degdeg|", kDegree},  // degdeg: sign and word
                            {"|arcmin|arcminute|", kDegree / 60.0},
                            {"|arcsec|arcsecond|", kDegree / 3600.0},
                            {"|mas|", kDegree / 3600.0e3},
                            {"|cdeg|", kDegree * 1e-2},
                            {"|gon|", kTurn / 400.0},
                            {"|rev|revolution|turn|umdr|", kTurn}};

// Revolution in "per minute" only. By ISO 80000-3 "1/min" is a rotational frequency, while "1/s" may be an
// angular velocity; r, U (Umdrehung) and tr (tour) are revolutions.
constexpr std::array<std::string_view, 5> kPerMinute{"1", "", "r", "u", "tr"};

constexpr Unit kRates[] = {{"|dps|degps|", kDegree},
                           {"|mdps|", kDegree * 1e-3},
                           {"|udps|", kDegree * 1e-6},
                           {"|dph|degph|degh|", kDegree / 3600.0},
                           {"|radps|", 1.0},
                           {"|mradps|", 1e-3},
                           {"|rpm|upm|minutinver|", kTurn / 60.0},
                           {"|krpm|", kTurn / 60.0e-3}};

constexpr Unit kTimes[] = {{"|s|sec|second|sek|secon|sekunde|", 1.0},
                           {"|min|minute|", 60.0},
                           {"|h|hr|hrs|hour|std|", 3600.0},
                           {"|d|day|", 86400.0}};

constexpr std::pair<std::string_view, double> kPrefixes[] = {{"milli", 1e-3}, {"micro", 1e-6}, {"nano", 1e-9},
                                                             {"m", 1e-3},     {"u", 1e-6},     {"n", 1e-9}};

const Unit* find_in(Units units, std::string_view name) {
  const auto found = std::ranges::find_if(units, [between = "|" + std::string(name) + "|"](const Unit& unit) {
    return unit.names.find(between) != std::string_view::npos;
  });
  return found == units.end() ? nullptr : &*found;
}

// Also in the plural, of names of three letters or more.
std::optional<double> find(Units units, std::string_view text) {
  const Unit* unit = find_in(units, text);
  if (unit == nullptr && text.size() > 3 && text.ends_with('s'))
    unit = find_in(units, text.substr(0, text.size() - 1));
  return unit == nullptr ? std::nullopt : std::optional(unit->scale);
}

// Also with a prefix, of a unit of at most that value: mrad, milliradians; ms, nanoseconds, but no milli-hours.
std::optional<double> find_prefixed(Units units, std::string_view text, double most) {
  if (const std::optional<double> whole = find(units, text)) return whole;
  for (const auto& [prefix, value] : kPrefixes)
    if (text.starts_with(prefix))
      if (const auto rest = find(units, text.substr(prefix.size())); rest && *rest <= most)
        return value * *rest;
  return std::nullopt;
}

std::optional<double> find_time(std::string_view text) { return find_prefixed(kTimes, text, 1.0); }
std::optional<double> find_angle(std::string_view text) { return find_prefixed(kAngles, text, kTurn); }

struct Spelling {
  std::string_view from, to;
};

// Longer ones first: the byte B0 is Latin-1 only outside C2 B0.
constexpr std::array kSpellings{
    Spelling{"\xC3\x82\xC2\xB0", "deg"},  // UTF-8 read as Latin-1 and encoded again
    Spelling{"\xC2\xB0", "deg"},
    Spelling{"\xC2\xBA", "deg"},              // ordinal sign, often used by mistake
    Spelling{"\x81\x8B", "deg"},              // Shift-JIS
    Spelling{"\xA1\xE3", "deg"},              // GBK
    Spelling{"\xA1\xC6", "deg"},              // CP949
    Spelling{"\xC2\xB5", "u"},                // micro sign
    Spelling{"\xCE\xBC", "u"},                // Greek letter
    Spelling{"\xC2\xB7", "*"},                // middle dot
    Spelling{"\xE2\x8B\x85", "*"},            // dot operator
    Spelling{"\xE2\x81\xBB\xC2\xB9", "^-1"},  // superscripts
    Spelling{"\xCB\x9A", "deg"},              // ring above
    Spelling{"\xE2\x81\xB0", "deg"},          // superscript zero
    Spelling{"&deg;", "deg"},
    Spelling{"&#176;", "deg"},
    Spelling{"\xE5\xBA\xA6", "deg"},                      // 度, of arc
    Spelling{"\xE5\xBC\xA7\xE5\xBA\xA6", "rad"},          // 弧度
    Spelling{"\xE7\xA7\x92", "s"},                        // 秒
    Spelling{"\xD0\xB3\xD1\x80\xD0\xB0\xD0\xB4", "deg"},  // град
    Spelling{"\xD1\x80\xD0\xB0\xD0\xB4", "rad"},          // рад
    Spelling{"\xD1\x81", "s"},                            // с
    Spelling{"\xD1\x87", "h"},                            // ч
    Spelling{"\xE3\xF0\xE0\xE4", "deg"},                  // the three above in Windows-1251
    Spelling{"\xF0\xE0\xE4", "rad"},
    Spelling{"\xF1", "s"},
    Spelling{"\xE2\x80\xB2", "arcmin"},  // prime and double prime
    Spelling{"\xE2\x80\xB3", "arcsec"},
    Spelling{"\"", "arcsec"},   // typewriter form
    Spelling{"\xC3\xA9", "e"},  // é
    Spelling{"\xC2\xA0", " "},  // no-break space
    Spelling{"**", "^"},
    Spelling{"(-1)", "-1"},
    Spelling{"{-1}", "-1"},
    Spelling{"\xF8", "deg"},  // code pages 437 and 850
    Spelling{"\xE9", "e"},
    Spelling{"\xB0", "deg"},
    Spelling{"\xBA", "deg"},
    Spelling{"\xB5", "u"},
    Spelling{"Grad", "deg"}};

std::string_view trimmed(std::string_view text, std::string_view what) {
  const std::size_t from = text.find_first_not_of(what);
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(what) - from + 1);
}

// In ASCII, lower case, trimmed, without brackets. "" if its case is ambiguous or it is too long for a unit.
std::string plain(std::string_view text) {
  constexpr std::string_view kBlank = " \t";
  if (text.size() > 64) return "";
  text = trimmed(text, kBlank);
  if (text.size() > 2 && (text.front() == '[' || text.front() == '(') &&
      text.back() == (text.front() == '[' ? ']' : ')'))
    text = trimmed(text.substr(1, text.size() - 2), kBlank);
  std::string out;
  while (!text.empty()) {
    const auto* const found = std::ranges::find_if(
        kSpellings, [text](const Spelling& each) { return text.starts_with(each.from); });
    if (found != kSpellings.end()) {
      out += found->to;
      text.remove_prefix(found->from.size());
      continue;
    }
    const char c = text.front();
    out += c >= 'A' && c <= 'Z' && !(c == 'M' && out.empty() && !text.starts_with("Min"))
               ? static_cast<char>(c - 'A' + 'a')
               : c;
    text.remove_prefix(1);
  }
  constexpr std::string_view kPrefix = "unit_";
  return out.starts_with(kPrefix) ? out.substr(kPrefix.size()) : out;
}

struct Quotient {
  std::string_view angle, time;
};

std::optional<Quotient> quotient(std::string_view text) {
  constexpr std::string_view kBetween = " \t_*.";
  if (text.ends_with("-1")) {
    text = trimmed(text.substr(0, text.size() - 2), " ^*");
    std::size_t at = text.size();
    while (at > 0 && text[at - 1] >= 'a' && text[at - 1] <= 'z') --at;
    return Quotient{trimmed(text.substr(0, at), kBetween), text.substr(at)};
  }
  for (const std::string_view sign : {"/", "per"})
    if (const std::size_t at = text.find(sign); at != std::string_view::npos)
      return Quotient{trimmed(text.substr(0, at), kBetween),
                      trimmed(text.substr(at + sign.size()), kBetween)};
  return std::nullopt;
}

}  // namespace

std::optional<double> time_unit(std::string_view text) { return find_time(plain(text)); }

std::optional<double> angle_unit(std::string_view text, bool rate, bool bare_rate) {
  const std::string unit = plain(text);
  const std::optional<double> bare = find_angle(unit);
  if (!rate || (bare && bare_rate)) return bare;
  if (const std::optional<double> known = find(kRates, unit)) return known;
  const std::optional<Quotient> parts = quotient(unit);
  if (!parts) return std::nullopt;
  const std::optional<double> time = find_time(parts->time);
  if (!time) return std::nullopt;
  if (*time == 60.0)
    for (const std::string_view turn : kPerMinute)
      if (parts->angle == turn) return kTurn / *time;
  const std::optional<double> angle = find_angle(parts->angle);
  if (!angle) return std::nullopt;
  return *angle / *time;
}

namespace {

struct Quantity {
  std::string_view shown;  // for messages
  Units units;
};

constexpr double kGravity = 9.80665, kZeroCelsius_K = 273.15, kFahrenheit = 5.0 / 9.0;
constexpr double kZeroFahrenheit_K = kZeroCelsius_K - 32.0 * kFahrenheit;

constexpr Unit kTemperatures[] = {{"|degc|c|celsius|", 1.0, kZeroCelsius_K},
                                  {"|degf|f|fahrenheit|", kFahrenheit, kZeroFahrenheit_K},
                                  {"|k|kelvin|", 1.0}};
constexpr Unit kAccelerations[] = {{"|mps2|m/s2|m/s^2|m/s\xC2\xB2|m/s/s|m s^-2|", 1.0},
                                   {"|g|", kGravity},
                                   {"|mg|", kGravity * 1e-3},
                                   {"|ug|", kGravity * 1e-6},
                                   {"|gal|", 1e-2},
                                   {"|mgal|", 1e-5}};
constexpr Unit kVoltages[] = {{"|v|", 1.0}, {"|mv|", 1e-3}, {"|uv|", 1e-6}, {"|kv|", 1e3}};
constexpr Unit kCurrents[] = {{"|a|", 1.0}, {"|ma|", 1e-3}, {"|ua|", 1e-6}};
constexpr Unit kFluxDensities[] = {{"|t|", 1.0},   {"|mt|", 1e-3},    {"|ut|", 1e-6},
                                   {"|nt|", 1e-9}, {"|gauss|", 1e-4}, {"|mgauss|", 1e-7}};
constexpr Unit kPressures[] = {{"|pa|", 1.0}, {"|hpa|mbar|", 1e2}, {"|kpa|", 1e3}, {"|bar|", 1e5}};
constexpr Unit kRatios[] = {{"|pct|%|percent|%rh|", 1.0}};

constexpr std::array kQuantities{Quantity{"degC, degF, K", kTemperatures},
                                 Quantity{"mps2, g, mg, Gal", kAccelerations},
                                 Quantity{"V, mV, uV", kVoltages},
                                 Quantity{"A, mA, uA", kCurrents},
                                 Quantity{"uT, nT, mT, gauss", kFluxDensities},
                                 Quantity{"Pa, hPa, kPa, mbar, bar", kPressures},
                                 Quantity{"pct, %", kRatios}};

}  // namespace

std::string clock_speed(double runs, const char* right) {
  constexpr double kErrs = 0.02;  // relative
  if (std::abs(runs - 1.0) < kErrs) return right;
  if (!(runs > 0.0)) return "stands still or runs back";
  std::ostringstream out;
  out.precision(4);
  out << "runs " << std::max(runs, 1.0 / runs) << " times too " << (runs < 1.0 ? "slow" : "fast");
  for (const auto& [unit, ns] : {std::pair("us", 1e3), {"ms", 1e6}, {"s", 1e9}})
    if (std::abs(runs * ns - 1.0) < kErrs) out << " (perhaps in " << unit << ", expected ns)";
  return out.str();
}

std::optional<UnitConversion> convert_unit(std::string_view from, std::string_view wanted) {
  if (from == wanted) return UnitConversion{};
  const std::string a = plain(from), b = plain(wanted);
  for (const Quantity& quantity : kQuantities) {
    const Unit* const to = find_in(quantity.units, b);
    if (to == nullptr) continue;
    const Unit* const is = find_in(quantity.units, a);
    if (is == nullptr) return std::nullopt;
    return UnitConversion{is->scale / to->scale, (is->offset - to->offset) / to->scale};
  }
  if (const auto to = time_unit(wanted)) {
    if (const auto is = time_unit(from)) return UnitConversion{*is / *to};
    return std::nullopt;
  }
  const auto to = angle_unit(wanted, true, false), is = angle_unit(from, true, false);
  if (to && is) return UnitConversion{*is / *to};
  return std::nullopt;
}

UnitConversion convert_to_column(std::string_view stated, std::string_view column, std::string& remark) {
  const std::string_view wanted = column.substr(column.rfind('_') + 1);
  const auto by = stated.empty() ? UnitConversion{} : convert_unit(stated, wanted);
  if (!by)
    remark = in_quotes(column) + ": its unit is stated as " + in_quotes(stated) +
             ", which is not converted to " + in_quotes(wanted) + ": values are used as they are";
  return by.value_or(UnitConversion{});
}

std::string other_units(std::string_view wanted) {
  const std::string name = plain(wanted);
  for (const Quantity& quantity : kQuantities)
    if (find_in(quantity.units, name) != nullptr) return std::string(quantity.shown);
  if (time_unit(wanted)) return "s, ms, us, ns, min, h, d";
  return angle_unit(wanted, true, false) ? "rad/s, deg/s, deg/h, rpm" : "";
}

}  // namespace ifog
