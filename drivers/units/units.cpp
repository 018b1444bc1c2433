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

using Unit = std::pair<std::string_view, double>;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kDegree = std::numbers::pi / 180.0;

constexpr std::array kAngles{Unit{"rad", 1.0},
                             Unit{"radian", 1.0},
                             Unit{"radiant", 1.0},
                             Unit{"deg", kDegree},
                             Unit{"degree", kDegree},
                             Unit{"degre", kDegree},
                             Unit{"degreofarc", kDegree},
                             Unit{"degdeg", kDegree},  // sign and word
                             Unit{"arcmin", kDegree / 60.0},
                             Unit{"arcminute", kDegree / 60.0},
                             Unit{"arcsec", kDegree / 3600.0},
                             Unit{"arcsecond", kDegree / 3600.0},
                             Unit{"mas", kDegree / 3600.0e3},
                             Unit{"cdeg", kDegree * 1e-2},
                             Unit{"gon", kTurn / 400.0},
                             Unit{"rev", kTurn},
                             Unit{"revolution", kTurn},
                             Unit{"turn", kTurn},
                             Unit{"umdr", kTurn}};

// Revolution in "per minute" only. By ISO 80000-3 "1/min" is a rotational frequency, while "1/s" may be an
// angular velocity; r, U (Umdrehung) and tr (tour) are revolutions.
constexpr std::array<std::string_view, 5> kPerMinute{"1", "", "r", "u", "tr"};

constexpr std::array kRates{Unit{"dps", kDegree},
                            Unit{"mdps", kDegree * 1e-3},
                            Unit{"dph", kDegree / 3600.0},
                            Unit{"udps", kDegree * 1e-6},
                            Unit{"degps", kDegree},
                            Unit{"radps", 1.0},
                            Unit{"degph", kDegree / 3600.0},
                            Unit{"degh", kDegree / 3600.0},
                            Unit{"mradps", 1e-3},
                            Unit{"rpm", kTurn / 60.0},
                            Unit{"krpm", kTurn / 60.0e-3},
                            Unit{"upm", kTurn / 60.0},
                            Unit{"minutinver", kTurn / 60.0}};

constexpr std::array kTimes{Unit{"s", 1.0},      Unit{"sec", 1.0},     Unit{"second", 1.0},
                            Unit{"sek", 1.0},    Unit{"secon", 1.0},   Unit{"sekunde", 1.0},
                            Unit{"min", 60.0},   Unit{"minute", 60.0}, Unit{"h", 3600.0},
                            Unit{"hr", 3600.0},  Unit{"hrs", 3600.0},  Unit{"hour", 3600.0},
                            Unit{"std", 3600.0}, Unit{"d", 86400.0},   Unit{"day", 86400.0}};

constexpr std::array kPrefixes{Unit{"milli", 1e-3}, Unit{"micro", 1e-6}, Unit{"nano", 1e-9},
                               Unit{"m", 1e-3},     Unit{"u", 1e-6},     Unit{"n", 1e-9}};

template <std::size_t N>
std::optional<double> find(const std::array<Unit, N>& units, std::string_view text) {
  for (const auto& [name, value] : units)
    if (name == text || (name.size() > 2 && text == std::string(name) + "s")) return value;
  return std::nullopt;
}

// Also with a prefix, of a unit of at most that value: mrad, milliradians; ms, nanoseconds, but no milli-hours.
template <std::size_t N>
std::optional<double> find_prefixed(const std::array<Unit, N>& units, std::string_view text, double most) {
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

// SI value = value * scale + offset, within a quantity. Lower case, as from plain().
struct QuantityUnit {
  std::string_view name;
  double scale, offset = 0.0;
};

struct Quantity {
  std::string_view shown;  // for messages
  std::span<const QuantityUnit> units;
};

constexpr double kGravity = 9.80665, kZeroCelsius_K = 273.15, kFahrenheit = 5.0 / 9.0;
constexpr double kZeroFahrenheit_K = kZeroCelsius_K - 32.0 * kFahrenheit;

constexpr std::array kTemperatures{QuantityUnit{"degc", 1.0, kZeroCelsius_K},
                                   QuantityUnit{"c", 1.0, kZeroCelsius_K},
                                   QuantityUnit{"celsius", 1.0, kZeroCelsius_K},
                                   QuantityUnit{"degf", kFahrenheit, kZeroFahrenheit_K},
                                   QuantityUnit{"f", kFahrenheit, kZeroFahrenheit_K},
                                   QuantityUnit{"fahrenheit", kFahrenheit, kZeroFahrenheit_K},
                                   QuantityUnit{"k", 1.0},
                                   QuantityUnit{"kelvin", 1.0}};
constexpr std::array kAccelerations{QuantityUnit{"mps2", 1.0},           QuantityUnit{"m/s2", 1.0},
                                    QuantityUnit{"m/s^2", 1.0},          QuantityUnit{"m/s\xC2\xB2", 1.0},
                                    QuantityUnit{"m/s/s", 1.0},          QuantityUnit{"m s^-2", 1.0},
                                    QuantityUnit{"g", kGravity},         QuantityUnit{"mg", kGravity * 1e-3},
                                    QuantityUnit{"ug", kGravity * 1e-6}, QuantityUnit{"gal", 1e-2},
                                    QuantityUnit{"mgal", 1e-5}};
constexpr std::array kVoltages{QuantityUnit{"v", 1.0}, QuantityUnit{"mv", 1e-3}, QuantityUnit{"uv", 1e-6},
                               QuantityUnit{"kv", 1e3}};
constexpr std::array kCurrents{QuantityUnit{"a", 1.0}, QuantityUnit{"ma", 1e-3}, QuantityUnit{"ua", 1e-6}};
constexpr std::array kFluxDensities{QuantityUnit{"t", 1.0},      QuantityUnit{"mt", 1e-3},
                                    QuantityUnit{"ut", 1e-6},    QuantityUnit{"nt", 1e-9},
                                    QuantityUnit{"gauss", 1e-4}, QuantityUnit{"mgauss", 1e-7}};
constexpr std::array kPressures{QuantityUnit{"pa", 1.0}, QuantityUnit{"hpa", 1e2}, QuantityUnit{"kpa", 1e3},
                                QuantityUnit{"mbar", 1e2}, QuantityUnit{"bar", 1e5}};

constexpr std::array kRatios{QuantityUnit{"pct", 1.0}, QuantityUnit{"%", 1.0}, QuantityUnit{"percent", 1.0},
                             QuantityUnit{"%rh", 1.0}};

constexpr std::array kQuantities{Quantity{"degC, degF, K", kTemperatures},
                                 Quantity{"mps2, g, mg, Gal", kAccelerations},
                                 Quantity{"V, mV, uV", kVoltages},
                                 Quantity{"A, mA, uA", kCurrents},
                                 Quantity{"uT, nT, mT, gauss", kFluxDensities},
                                 Quantity{"Pa, hPa, kPa, mbar, bar", kPressures},
                                 Quantity{"pct, %", kRatios}};

const QuantityUnit* find_in(const Quantity& quantity, std::string_view name) {
  for (const QuantityUnit& unit : quantity.units)
    if (unit.name == name) return &unit;
  return nullptr;
}

}  // namespace

std::string clock_speed(double runs, const char* right) {
  constexpr double kErrs = 0.02;  // relative
  if (std::abs(runs - 1.0) < kErrs) return right;
  if (!(runs > 0.0)) return "stands still or runs back";
  std::ostringstream out;
  out.precision(4);
  out << "runs " << std::max(runs, 1.0 / runs) << " times too " << (runs < 1.0 ? "slow" : "fast");
  for (const auto& [unit, ns] : {Unit{"us", 1e3}, {"ms", 1e6}, {"s", 1e9}})
    if (std::abs(runs * ns - 1.0) < kErrs) out << " (perhaps in " << unit << ", expected ns)";
  return out.str();
}

std::optional<UnitConversion> convert_unit(std::string_view from, std::string_view wanted) {
  if (from == wanted) return UnitConversion{};
  const std::string a = plain(from), b = plain(wanted);
  for (const Quantity& quantity : kQuantities) {
    const QuantityUnit* const to = find_in(quantity, b);
    if (to == nullptr) continue;
    const QuantityUnit* const is = find_in(quantity, a);
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
    if (find_in(quantity, name) != nullptr) return std::string(quantity.shown);
  if (time_unit(wanted)) return "s, ms, us, ns, min, h, d";
  return angle_unit(wanted, true, false) ? "rad/s, deg/s, deg/h, rpm" : "";
}

}  // namespace ifog
