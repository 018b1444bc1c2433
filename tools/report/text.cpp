// SPDX-License-Identifier: Apache-2.0
#include "tools/report/text.h"

#include <fmt/core.h>
#include <glib.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

#include "drivers/ifog/quoted.h"

namespace ifog::report {
namespace {

std::string with_decimals(double value, int decimals) { return fmt::format("{:.{}f}", value, decimals); }

// With a true minus sign.
std::string typeset(const std::string& plain) { return boost::replace_all_copy(plain, "-", "−"); }

std::string superscript(int exponent) {
  static constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out = exponent < 0 ? "⁻" : "";
  const std::string plain = std::to_string(std::abs(exponent));
  for (const char c : plain) out += kDigits[c - '0'];
  return out;
}

int decade(double value) { return static_cast<int>(std::floor(std::log10(std::abs(value)))); }

}  // namespace

std::string escaped(std::string_view text) {
  // XML allows neither control characters nor invalid UTF-8; they become \xNN.
  const std::string plain = printable(text, std::numeric_limits<std::size_t>::max());
  const std::unique_ptr<char, decltype(&g_free)> markup(
      g_markup_escape_text(plain.data(), static_cast<gssize>(plain.size())), &g_free);
  return markup.get();
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0.0) return "0";
  // Rounding may reach the next decade: 999.9 with three digits is 1000.
  const double rounded = std::strtod(fmt::format("{:.{}e}", value, digits - 1).c_str(), nullptr);
  const int power = decade(rounded);
  if (power >= -4 && power < 6) return typeset(with_decimals(rounded, std::max(0, digits - 1 - power)));
  return at_power(rounded, digits - 1, power);
}

std::string at_power(double value, int decimals, int power) {
  if (value == 0.0) return "0";
  const std::string plain = typeset(with_decimals(value / std::pow(10.0, power), decimals));
  return power == 0 ? plain : plain + " × 10" + superscript(power);
}

std::string with_error(double value, double std_error) {
  if (!(std_error > 0.0) || !std::isfinite(value)) return number(value, 4);
  const double largest = std::max(std::abs(value), std_error);
  const int power = decade(largest);
  const bool plain = power >= -4 && power < 6;
  const double scale = plain ? 1.0 : std::pow(10.0, power);
  const int decimals = std::clamp(1 - decade(std_error / scale), 0, 12);
  const std::string both =
      typeset(with_decimals(value / scale, decimals)) + " ± " + with_decimals(std_error / scale, decimals);
  return plain ? both : "(" + both + ") × 10" + superscript(power);
}

std::vector<double> scaled(std::vector<double> values, double scale) {
  for (double& value : values) value *= scale;
  return values;
}

std::string duration(double seconds) {
  const TimeUnit unit = time_unit(seconds);
  std::string text = number(seconds / unit.seconds, 3);
  while (text.find('.') != std::string::npos && text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text + " " + unit.name;
}

TimeUnit time_unit(double span_s) {
  if (span_s >= 2.0 * 3600.0) return {3600.0, "h"};
  if (span_s >= 10.0 * 60.0) return {60.0, "min"};
  return {1.0, "s"};
}

}  // namespace ifog::report
