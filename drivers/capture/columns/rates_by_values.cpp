// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/columns/column_roles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include "drivers/capture/columns/measurable.h"

namespace ifog {
namespace {

constexpr double kGravity_mps2 = 9.80665;

// True if the columns, together or one alone, hold gravity: then they are not the gyro's.
bool holds_gravity(const TableSample& table, const Rates& axes) {
  return is_gravity(table, axes) ||
         std::ranges::any_of(axes, [&](const RateCandidate& axis) { return is_gravity(table, {axis}); });
}

// True if values change little from row to row compared with their range, like an angle. Von Neumann's ratio: mean
// squared difference / variance; 2 for white noise.
bool is_smooth(const std::vector<std::string>& cells) {
  constexpr double kSmooth = 0.5;
  const std::vector<double> values = numbers_in(cells);
  if (values.size() < kFewRows) return false;
  double mean = 0.0, around = 0.0, differences = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    around += (values[i] - mean) * (values[i] - mean);
    if (i > 0) differences += (values[i] - values[i - 1]) * (values[i] - values[i - 1]);
  }
  return differences < kSmooth * around;
}

bool are_neighbours(const Rates& axes) { return axes.back().place - axes.front().place + 1 == axes.size(); }

}  // namespace

bool is_gravity(const TableSample& table, const Rates& columns) {
  std::vector<double> lengths;
  for (std::size_t row = 0; row < table.cells[columns[0].place].size(); ++row) {
    double square = 0.0;
    for (const RateCandidate& column : columns) {
      const std::vector<std::string>& cells = table.cells[column.place];
      const double value = row < cells.size() ? std::strtod(cells[row].c_str(), nullptr) : 0.0;
      square += value * value;
    }
    lengths.push_back(std::sqrt(square));
  }
  if (lengths.empty()) return false;
  std::ranges::sort(lengths);
  const auto at = [&](double share) {
    return lengths[static_cast<std::size_t>(share * static_cast<double>(lengths.size() - 1))];
  };
  const double middle = at(0.5);
  constexpr std::array<double, 7> kGravities{kGravity_mps2, 1.0, 1000.0, 16384.0, 8192.0, 4096.0, 2048.0};
  return at(0.75) - at(0.25) < 0.05 * middle && std::ranges::any_of(kGravities, [&](double gravity) {
           return std::abs(middle / gravity - 1.0) < 0.05;
         });
}

bool are_counts(const TableSample& table, const Rates& rates) {
  return std::ranges::all_of(rates,
                             [&](const RateCandidate& rate) { return is_whole(table.cells[rate.place]); });
}

// Removes units in which no sensor measures one of the cells, unless that leaves none.
template <typename RangeIn>
void keep_possible(std::vector<std::string>& units, const std::vector<std::string>& cells, RangeIn range_in) {
  std::vector<std::string> possible;
  std::ranges::copy_if(units, std::back_inserter(possible), [&](const std::string& unit) {
    const Measurable range = range_in(unit);
    return std::ranges::all_of(cells, [&](const std::string& cell) {
      return range.holds(finite_number(cell).value_or(range.least));
    });
  });
  if (!possible.empty()) units = std::move(possible);
}

// A rate in motion is as smooth as an angle, so only a lone column without a name is offered as an angle first.
std::vector<std::string> units_of(const TableSample& table, const Rates& rates) {
  if (!rates.front().units.empty()) return rates.front().units;
  std::vector<std::string> units{"rad/s", "deg/s", "rad/sample", "deg/sample"};
  const auto is_summed = [&](const RateCandidate& rate) { return is_smooth(table.cells[rate.place]); };
  if (rates.front().increment)
    std::rotate(units.begin(), units.begin() + 2, units.end());
  else if (std::ranges::any_of(rates, is_summed))
    units.insert(!table.named && rates.size() == 1 ? units.begin() : units.end(), {"rad", "deg"});
  for (const RateCandidate& rate : rates)
    keep_possible(units, table.cells[rate.place], [](const std::string& unit) {
      return measurable_in_file(CsvColumn{"rate_radps", "", unit});
    });
  return units;
}

std::vector<std::string> units_of(const TableSample& table, const CsvTime& time) {
  std::vector<std::string> units{"s", "ms", "us", "ns", "d"};
  for (std::size_t i = 0; i < table.names.size(); ++i)
    if (table.header_of(i) == time.header)
      keep_possible(units, table.cells[i], [](const std::string& unit) {
        return measurable_in_file(CsvTime{"", unit});
      });
  return units;
}

// Prefers groups of three without gravity and with similar values (a heading differs from a rate).
std::vector<Rates> rates_by_place(const TableSample& table, const std::optional<CsvTime>& time) {
  Rates found;
  const std::string counted = counting_column(table);
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const bool of_time =
        time && ("+" + time->header + "+").find("+" + table.names[i] + "+") != std::string::npos;
    if (!of_time && varies(table.cells[i]) && table.names[i] != counted) found.push_back({i, "", ""});
  }
  if (found.size() < 3) return {found.empty() ? found : Rates(1, found[0])};
  std::vector<Rates> sensors;
  const std::size_t step = found.size() % 3 == 0 ? 3 : 1;
  for (std::size_t first = 0; first + 3 <= found.size(); first += step) {
    Rates& axes = sensors.emplace_back(found.begin() + static_cast<std::ptrdiff_t>(first),
                                       found.begin() + static_cast<std::ptrdiff_t>(first) + 3);
    for (std::size_t i = 0; i < 3; ++i) axes[i].axis = std::string(1, static_cast<char>('x' + i));
  }
  const auto prefer = [&sensors](auto&& is_likely) {
    if (std::ranges::any_of(sensors, is_likely))
      std::erase_if(sensors, [&](const Rates& axes) { return !is_likely(axes); });
  };
  prefer([](const Rates& axes) { return are_neighbours(axes); });
  prefer([&](const Rates& axes) { return !holds_gravity(table, axes); });
  prefer([&](const Rates& axes) {
    const auto smooth = std::ranges::count_if(
        axes, [&](const RateCandidate& axis) { return is_smooth(table.cells[axis.place]); });
    return smooth == 0 || smooth == 3;
  });
  return sensors;
}

}  // namespace ifog
