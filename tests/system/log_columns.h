// SPDX-License-Identifier: Apache-2.0
// Input of the comparisons of recorded messages with computed columns.
#pragma once

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <ifog/rate_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

// An independent CSV reader, so that an error in the project's reader cannot cancel out.
inline std::map<std::string, std::vector<double>> read_columns(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  std::map<std::string, std::vector<double>> columns;
  std::vector<std::string> names;
  std::string line, cell;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    std::size_t column = 0;
    const bool header = names.empty();
    while (std::getline(cells, cell, ',')) {
      if (header) {
        names.push_back(cell);
        continue;
      }
      double value = std::nan("");
      std::from_chars(cell.data(), cell.data() + cell.size(), value);
      columns[names.at(column++)].push_back(value);
    }
  }
  return columns;
}

inline std::vector<ifog::rate_t> read_log(const std::string& path, const std::string& channel) {
  lcm::LogFile log(path, "r");
  if (!log.good()) throw std::runtime_error(path + ": cannot be read as an LCM log");
  std::vector<ifog::rate_t> messages;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    if (event->channel != channel) continue;
    ifog::rate_t message;
    if (message.decode(event->data, 0, event->datalen) < 0)
      throw std::runtime_error(path + ": a message on " + channel + " is no ifog.rate_t");
    messages.push_back(message);
  }
  return messages;
}

inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}
