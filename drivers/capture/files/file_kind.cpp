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
constexpr std::array<Container, 15> kContainers{
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
     {"BZh", "is packed by bzip2, expected a plain or gzip file; 'bunzip2' unpacks it"},
     {{"\xFD"
       "7zXZ",
       5},
      "is packed by xz, expected a plain or gzip file; 'unxz' unpacks it"},
     {"\x28\xB5\x2F\xFD", "is packed by zstd, expected a plain or gzip file; 'unzstd' unpacks it"},
     {"TDSm",
      "is a TDMS file of LabVIEW, expected CSV; 'tdmsinfo' and to_dataframe().to_csv of nptdms make it"},
     {"H Product:Blackbox", "is a log of Betaflight, expected CSV; 'blackbox_decode' makes it"},
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
  // A record's number in six digits, its quality, a blank.
  if (head.size() > 7 && head.find_first_not_of("0123456789") == 6 && head[7] == ' ' &&
      std::string_view("DRQM").find(head[6]) != std::string_view::npos)
    return "is miniSEED, expected CSV; 'mseed2ascii -f 2' makes it";
  for (const Container& one : kContainers)
    if (head.starts_with(one.magic)) return std::string(one.said);
  return "";
}

}  // namespace ifog
