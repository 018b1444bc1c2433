#include "drivers/plugins/dbc/units.h"

#include <array>
#include <numbers>
#include <utility>

namespace ifog::dbc {
namespace {

using Unit = std::pair<std::string_view, double>;

constexpr double kDegree = std::numbers::pi / 180.0;

// "\xB0" is the degree sign in Latin-1, the encoding DBC editors write.
constexpr std::array kAngles{Unit{"rad", 1.0},
                             Unit{"mrad", 1e-3},
                             Unit{"urad", 1e-6},
                             Unit{"nrad", 1e-9},
                             Unit{"deg", kDegree},
                             Unit{"degree", kDegree},
                             Unit{"degrees", kDegree},
                             Unit{"°", kDegree},
                             Unit{"\xB0", kDegree},
                             Unit{"mdeg", kDegree * 1e-3},
                             Unit{"arcmin", kDegree / 60.0},
                             Unit{"arcsec", kDegree / 3600.0},
                             Unit{"rev", 2.0 * std::numbers::pi}};

constexpr std::array kTimes{Unit{"s", 1.0},   Unit{"sec", 1.0},  Unit{"ms", 1e-3},  Unit{"us", 1e-6},
                            Unit{"ns", 1e-9}, Unit{"min", 60.0}, Unit{"h", 3600.0}, Unit{"hr", 3600.0}};

template <std::size_t N>
std::optional<double> find(const std::array<Unit, N>& units, std::string_view text) {
  for (const auto& [name, value] : units)
    if (name == text) return value;
  return std::nullopt;
}

}  // namespace

std::optional<double> time_unit(std::string_view text) { return find(kTimes, text); }

std::optional<double> angle_unit(std::string_view text, bool rate, bool bare_rate) {
  if (!rate) return find(kAngles, text);
  if (text == "rpm") return 2.0 * std::numbers::pi / 60.0;
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return bare_rate ? find(kAngles, text) : std::nullopt;
  const std::optional<double> angle = find(kAngles, text.substr(0, slash));
  const std::optional<double> time = time_unit(text.substr(slash + 1));
  if (!angle || !time) return std::nullopt;
  return *angle / *time;
}

}  // namespace ifog::dbc
