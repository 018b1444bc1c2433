// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/files/file_kind.h"

#include <array>

namespace ifog {
namespace {

struct Container {
  std::string_view magic, said;
};
// As the formats' own descriptions have them.
constexpr std::string_view kSpreadsheet =
    "is a spreadsheet or another archive, expected CSV; the program that wrote it saves it so";
constexpr std::string_view kRos2 =
    "is a bag of ROS 2, expected CSV; 'ros2 bag play' with 'ros2 topic echo --csv TOPIC' makes it";
constexpr std::array<Container, 10> kContainers{
    {{{"PK\x03\x04", 4}, kSpreadsheet},
     {{"\xD0\xCF\x11\xE0", 4}, kSpreadsheet},
     {"MATLAB 5.0 MAT-file", "is a MATLAB file before version 7.3, expected one of 'save -v7.3'"},
     {"#ROSBAG V", "is a bag of ROS 1, expected CSV; 'rostopic echo -p -b BAG TOPIC' makes it"},
     {"\x89MCAP", kRos2},
     {"SQLite format 3", kRos2},
     {"ULog\x01\x12\x35", "is a log of PX4, expected CSV; 'ulog2csv' of pyulog makes it"},
     {"\xA3\x95\x80",
      "is a log of ArduPilot, expected CSV; 'mavlogdump.py --format csv --types IMU' of pymavlink makes it"},
     {"\x93NUMPY", "is an array of NumPy, expected CSV; numpy.savetxt makes it"},
     {"PAR1", "is a Parquet file, expected CSV; pandas.read_parquet(FILE).to_csv makes it"}}};

}  // namespace

std::string foreign_can_log(std::string_view head) {
  const auto has = [&](std::string_view text) { return head.find(text) != std::string_view::npos; };
  if (head.starts_with("date ") && (has("base hex") || has("base dec")))
    return "is a Vector ASC log, expected one of candump; 'asc2log' of can-utils makes it";
  if (has(";$FILEVERSION="))
    return "is a PEAK TRC log, expected one of candump; 'can_logconvert' of python-can makes it";
  if (head.starts_with("Time Stamp,ID,Extended,"))
    return "is a SavvyCAN log, expected one of candump; SavvyCAN saves it so, and 'log2asc' and 'asc2log' of "
           "can-utils convert others";
  return "";
}

std::string foreign_container(std::string_view head) {
  for (const Container& one : kContainers)
    if (head.starts_with(one.magic)) return std::string(one.said);
  return "";
}

}  // namespace ifog
