// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/files/file_kind.h"

#include <array>
#include <set>

namespace ifog {
namespace {

struct Container {
  std::string_view magic, said;
};
// From the formats' descriptions.
constexpr std::string_view kSpreadsheet =
    "is a spreadsheet or another archive, expected CSV; the program that wrote it saves it so";
constexpr std::string_view kRos2 =
    "is a bag of ROS 2, expected CSV; 'ros2 bag play' with 'ros2 topic echo --csv TOPIC' makes it";
constexpr std::array<Container, 16> kContainers{
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
     {"\xFD\x37zXZ", "is packed by xz, expected a plain or gzip file; 'unxz' unpacks it"},
     {"\x28\xB5\x2F\xFD", "is packed by zstd, expected a plain or gzip file; 'unzstd' unpacks it"},
     {"TDSm",
      "is a TDMS file of LabVIEW, expected CSV; 'tdmsinfo' and to_dataframe().to_csv of nptdms make it"},
     {"H Product:Blackbox", "is a log of Betaflight, expected CSV; 'blackbox_decode' makes it"},
     {"version https://git-lfs.",
      "is a pointer of Git LFS, expected the file that it stands for; 'git lfs pull' fetches it"},
     {"PAR1", "is a Parquet file, expected CSV; pandas.read_parquet(FILE).to_csv makes it"}}};

// JSON that is no table: nested, of several kinds, or all in one line.
std::string foreign_json(std::string_view head) {
  const std::size_t first = head.find('{'), inner = head.find('{', first + 1), end = head.find('}');
  if (inner < end)
    return "is JSON with objects inside of objects, expected a table; jq -r '[.t, .gyro.x, .gyro.y, .gyro.z] "
           "| @csv', with the names of this file, makes one";
  const bool one_line = head.find('\n', end) > inner;
  std::set<std::string_view> kinds;
  for (std::size_t at = head.find("\"sensor\":"), behind = 0;
       (behind = head.find_first_of(",}", at)) < head.size(); at = head.find("\"sensor\":", behind))
    kinds.insert(head.substr(at, behind - at));
  const bool several = kinds.size() > 1;
  if (!several && !one_line) return "";
  return std::string("is JSON of ") + (several ? "several sensors" : "all rows in one line") +
         ", expected a table; jq -r '.[] | " + (several ? "select(.sensor == \"Gyroscope\") | " : "") +
         "[.time, .x, .y, .z] | @csv', with the names of this file, makes one";
}

}  // namespace

std::string foreign_text(std::string_view head) {
  const auto has = [&](std::string_view text) { return head.find(text) != std::string_view::npos; };
  if (begins_as_utf16(head)) return "is text in UTF-16, expected UTF-8; 'iconv -f UTF-16 -t UTF-8' makes it";
  if (!has("\n") && std::ranges::count(head, '\r') > 1)
    return "its lines end in a carriage return, expected a line feed; \"tr '\\r' '\\n'\" makes it";
  std::string_view line = head.substr(0, head.find_first_of("\r\n"));
  line = line.substr(0, line.find_last_not_of(' ') + 1);
  if (line.ends_with(':') && has("\n---\n"))
    return "is YAML as rostopic echo prints it, expected a table; rostopic echo -p, or ros2 topic echo "
           "--csv, writes one";
  if (line.starts_with('$') && has("\n$G") && (has("GGA,") || has("RMC,")) && !has("ROT,"))
    return "is NMEA 0183 of a GNSS receiver, which has no rate of a gyro";
  if (line.starts_with("TIMESERIES ") && line.find(", SLIST,") != std::string_view::npos)
    return "is SLIST with several samples a line, expected one a line; the format TSPAIR of the same service "
           "has that";
  const std::size_t begin = head.find_first_not_of(" \t\r\n");
  return begin != std::string_view::npos && (head[begin] == '{' || head[begin] == '[') ? foreign_json(head)
                                                                                       : "";
}

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
  // A six-digit record number, its quality, a blank.
  if (head.size() > 7 && head.find_first_not_of("0123456789") == 6 && head[7] == ' ' &&
      std::string_view("DRQM").find(head[6]) != std::string_view::npos)
    return "is miniSEED, expected CSV; 'mseed2ascii -f 2' makes it";
  for (const Container& one : kContainers)
    if (head.starts_with(one.magic)) return std::string(one.said);
  return "";
}

}  // namespace ifog
