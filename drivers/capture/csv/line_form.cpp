// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv/line_form.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <system_error>
#include <utility>

#include "drivers/capture/columns/column.h"
#include "drivers/capture/csv/text_cells.h"
#include "drivers/capture/times/date_time.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {
namespace {

constexpr std::string_view kArrow = " -> ";
constexpr const char* kStampName = "stamp_time";
constexpr std::size_t kLongestDate = 64;  // bytes; a bound keeps the cost of a line without blanks linear
constexpr std::size_t kAlike = 3;         // fewest lines of one form in the file's beginning

// "%RAWIMUSXA," of a line with head and checksum (NovAtel OEM7 manual); else "".
std::string_view novatel_log(std::string_view line) {
  constexpr std::size_t kSum = 9;  // "*" and eight digits
  line = trimmed(line);
  const bool is_log = line.size() > kSum && (line[0] == '%' || line[0] == '#') &&
                      line[line.size() - kSum] == '*' && line.find(';') != std::string_view::npos;
  return is_log ? line.substr(0, line.find(',') + 1) : std::string_view();
}

// "UncalGyro," of a line that starts with a word; else "".
std::string_view word_before(std::string_view line) {
  const std::string_view word = line.substr(0, line.find(','));
  const auto in_words = [](char c) { return is_letter(c) || is_digit(c) || c == '_'; };
  const bool is_word =
      word.size() < line.size() && !word.empty() && is_letter(word[0]) && std::ranges::all_of(word, in_words);
  return is_word ? line.substr(0, word.size() + 1) : std::string_view();
}

// Column names of NovAtel's inertial logs; the axes of raw ones are in the order z, -y, x. Source: OEM7 Commands and
// Logs, RAWIMU, RAWIMUS, RAWIMUX, RAWIMUSX, CORRIMUDATA, CORRIMUDATAS.
std::vector<std::string> novatel_names(std::string_view log, std::string_view line) {
  const bool corrected = log.substr(1).starts_with("CORRIMUDATA");
  if (!corrected && !log.substr(1).starts_with("RAWIMU")) return {};
  const bool extended = log.find('X') != std::string_view::npos,
             is_short =
                 log.find("IMUS") != std::string_view::npos || log.find("DATAS") != std::string_view::npos;
  std::vector<std::string> names{"log", "head_week", "head_tow_s"};
  if (!is_short)
    names = {"log",       "port",       "sequence", "idle",     "quality",
             "head_week", "head_tow_s", "receiver", "reserved", "version"};
  if (extended) names.insert(names.end(), {"imu_info", "imu_type"});
  if (corrected)
    names.insert(names.end(), {"gps_week", "tow_s", "delta_angle_x", "delta_angle_y", "delta_angle_z", "dv_x",
                               "dv_y", "dv_z"});
  else
    names.insert(names.end(), {"gps_week", "tow_s", "imu_status", "accel_z", "accel_minus_y", "accel_x",
                               "dtheta_z", "dtheta_minus_y", "dtheta_x"});
  const auto ends = std::ranges::count_if(line, [](char c) { return c == ',' || c == ';'; });
  return static_cast<std::size_t>(ends) + 1 == names.size() ? names : std::vector<std::string>();
}

bool is_of_gyro(const std::string& name) { return lower(name).find("gyr") != std::string::npos; }

// Terminal's time before a line, "10:00:00" or "10:00:00.123", or "".
std::string_view stamp_before(std::string_view line) {
  const std::string_view before = line.substr(0, line.find(kArrow));
  return before.size() < line.size() && is_date(before) ? before : std::string_view();
}

// Date or time of day that fills a line, without blanks; else "".
std::string stamp_alone(std::string_view line) {
  std::string stamp;
  for (const char c : trimmed(line))
    if (c != ' ' && c != '\t')
      stamp += c;
    else if (!stamp.empty() && stamp.back() != 'T')
      stamp += 'T';
  return stamp.find(':') != std::string::npos && is_date(stamp) ? stamp : std::string();
}

// Numbers of a line with the text before each.
struct Values {
  std::string_view begin;  // of the line, before the first number
  std::vector<std::string> labels;
  std::vector<std::string_view> numbers;
};

// End of a number or date that starts at `at`; `at` if there is none, as in "gyro2", "0x68" and "0b11".
std::size_t end_of_number(std::string_view line, std::size_t at) {
  const char before = at > 0 ? line[at - 1] : ' ';
  if (is_letter(before) || is_digit(before) || before == '_' || before == '.') return at;
  std::string_view rest = line.substr(at);
  const std::string_view near = rest.substr(0, kLongestDate);
  const std::string_view word = near.substr(0, near.find_first_of(",;| \t\"}])"));
  if (is_date(word)) return at + word.size();
  if (rest.starts_with("0x") || rest.starts_with("0b")) return at;
  if (rest.starts_with('+')) rest.remove_prefix(1);
  const std::size_t digit = rest.substr(0, 4).find_first_not_of("-.");
  if (digit > 2 || !is_digit(rest[digit])) return at;  // excludes "nan" and "inf"
  double value = 0.0;
  const auto [end, error] = std::from_chars(rest.begin(), rest.end(), value);
  return error == std::errc::invalid_argument ? at : static_cast<std::size_t>(end - line.begin());
}

// "gx" of ", gx: ", "rate (rad)" of "  ok  rate (rad): "; "" if there is no name.
std::string label_in(std::string_view between) {
  if (between.find_first_of(":=") == std::string_view::npos) return "";
  constexpr std::string_view kAround = " \t,;|:={}[]()\"'";
  const std::size_t begin = between.find_first_not_of(kAround);
  if (begin == std::string_view::npos) return "";
  std::size_t behind = between.find_last_not_of(kAround) + 1;
  const bool opened = between.substr(begin, behind - begin).find('(') != std::string_view::npos;
  if (opened && between.substr(behind, 1) == ")") ++behind;
  std::string_view label = between.substr(begin, behind - begin);
  const std::size_t other = label.find_last_of(",;|:="), gap = label.rfind("  ");
  for (const std::size_t end : {other, gap == std::string_view::npos ? gap : gap + 1})
    if (end < label.size())
      label.remove_prefix(std::min(label.find_first_not_of(" \"'", end + 1), label.size()));  // "RAW: gyro"
  return std::ranges::any_of(label, is_letter) ? std::string(label) : "";
}

Values values_in(std::string_view line) {
  Values out;
  std::size_t behind = 0;  // end of the previous number
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t end = end_of_number(line, at);
    if (end == at) {
      ++at;
      continue;
    }
    if (out.numbers.empty()) out.begin = line.substr(0, at);
    out.labels.push_back(label_in(line.substr(behind, at - behind)));
    out.numbers.push_back(line.substr(at, end - at));
    at = behind = end;
  }
  return out;
}

// One name per value, or per three values as axes; empty if a value has no name, except before three that are named.
std::vector<std::string> names_by(const std::vector<std::string>& labels) {
  std::vector<std::string> names;
  const auto named = std::ranges::find_if(labels, [](const std::string& label) { return !label.empty(); });
  const auto first = static_cast<std::size_t>(named - labels.begin());
  if (first > 0 && (labels.end() - named < 3 || named[1] != "" || named[2] != "")) return {};
  for (std::size_t i = 0; i < first; ++i) names.push_back("#" + std::to_string(i + 1));
  for (std::size_t i = first; i < labels.size();) {
    std::size_t end = i + 1;
    while (end < labels.size() && labels[end].empty()) ++end;
    if (labels[i].empty() || (end - i != 1 && end - i != 3)) return {};
    for (std::size_t axis = 0; axis < end - i; ++axis)
      names.push_back(end - i == 1 ? labels[i] : labels[i] + "_" + "xyz"[axis]);
    i = end;
  }
  return names.size() > 1 ? names : std::vector<std::string>();
}

}  // namespace

// Most frequent record type whose cells have names of a gyro: from NovAtel's manual, or from lines like "#
// UncalGyro,utcTimeMillis,…" (GnssLogger) and "FMT, 140, 43, IMU, QBffffff, TimeUS,I,GyrX,…" (ArduPilot).
// Uses two passes.
void LineForm::find_record(std::string_view text, const std::string& path) {
  std::map<std::string, std::pair<std::size_t, std::string_view>> records;  // count, and one of them
  Lines lines(text);
  for (std::string_view line; lines.next(line);) {
    const std::string_view log = novatel_log(line), record = log.empty() ? word_before(line) : log;
    if (record.empty()) continue;
    auto& [count, one] = records[std::string(record)];
    if (count++ == 0) one = line;
  }
  std::size_t most = kAlike - 1;
  std::size_t novatel = 0;
  for (const auto& [record, found] : records) {
    if (novatel_log(found.second).empty()) continue;
    novatel = std::max(novatel, found.first);
    std::vector<std::string> names = novatel_names(record, found.second);
    if (names.empty() || found.first <= most) continue;
    record_ = record;
    names_ = std::move(names);
    most = found.first;
  }
  if (record_.empty() && novatel > most)
    fail_at(path, 0, "logs of NovAtel without rates, expected RAWIMUS or CORRIMUDATAS among them");
  Lines stating(text);
  for (std::string_view line; stating.next(line);) {
    if (!is_of_gyro(std::string(line))) continue;
    const std::vector<std::string> cells = cells_of(without_mark(line), ',');
    for (auto cell = cells.begin(); cell != cells.end(); ++cell) {
      const auto found = records.find(*cell + ",");
      if (found == records.end() || found->second.first <= most || line.starts_with(found->first)) continue;
      const std::ptrdiff_t others = std::ssize(cells_of(found->second.second, ',')) - 1;
      if (cells.end() - cell <= others || std::none_of(cells.end() - others, cells.end(), is_of_gyro))
        continue;
      record_ = found->first;
      names_ = {"record"};
      names_.insert(names_.end(), cells.end() - others, cells.end());
      most = found->second.first;
    }
  }
}

LineForm::LineForm(std::string_view beginning, const std::string& path) {
  find_record(beginning, path);
  if (!record_.empty()) return;
  Lines lines(beginning);
  std::size_t before = 0, alone = 0, looked = 0, alike = 0;
  std::vector<std::string> labels;
  std::map<std::string, std::size_t> begins;  // of lines with labels
  for (std::string_view line; lines.next(line);) {
    if (trimmed(line).empty()) continue;
    ++looked;
    if (const std::string_view stamp = stamp_before(line); !stamp.empty()) {
      ++before;
      line.remove_prefix(stamp.size() + kArrow.size());
    } else if (!stamp_alone(line).empty()) {
      ++alone;
    }
    Values values = values_in(line);
    if (names_by(values.labels).empty()) continue;
    ++begins[lower(std::string(values.begin))];
    if (alike >= kAlike) continue;
    alike = values.labels == labels ? alike + 1 : 1;
    labels = std::move(values.labels);
  }
  if (before >= kAlike && 2 * before >= looked) stamps_ = Stamps::before;
  // A file that contains only times has no rows.
  if (alone >= 2 && 10 * alone < 9 * looked) stamps_ = Stamps::above;
  if (alike < kAlike) return;
  labels_ = std::move(labels);
  names_ = names_by(labels_);
  // If lines differ in their beginning, by sensor, only the gyro's are read.
  const auto gyro = std::ranges::find_if(begins, [](const auto& each) {
    return each.second >= kAlike && each.first.find("gyr") != std::string::npos;
  });
  if (begins.size() > 1 && gyro != begins.end()) begin_ = gyro->first;
  if (stamps_ != Stamps::none) names_.insert(names_.begin(), kStampName);
}

std::string LineForm::rows_of(std::string_view text) {
  std::string out;
  out.reserve(text.size() + text.size() / 8);
  Lines lines(text);
  for (std::string_view line; lines.next(line); out += '\n') append_row(line, out);
  return out;
}

void LineForm::append_row(std::string_view line, std::string& out) {
  if (trimmed(line).empty()) return;
  // Sentences and comments are kept as comments, rows of other kinds are not.
  const auto append_other = [&] {
    const bool kept = is_comment(line) ? novatel_log(line).empty() : values_in(line).numbers.empty();
    if (kept) out.append("# ").append(line);
  };
  std::string_view rest = line;
  if (!record_.empty()) {
    if (!line.starts_with(record_)) return append_other();
    const bool novatel = !novatel_log(line).empty();
    const auto row = static_cast<std::ptrdiff_t>(out.size());
    out += novatel ? line.substr(1, line.rfind('*') - 1) : line;
    if (novatel) std::replace(out.begin() + row, out.end(), ';', ',');
    return;
  }
  if (stamps_ == Stamps::before) {
    stamp_ = stamp_before(line);
    if (!stamp_.empty()) rest.remove_prefix(stamp_.size() + kArrow.size());
  } else if (stamps_ == Stamps::above) {
    if (std::string stamp = stamp_alone(line); !stamp.empty()) {
      stamp_ = std::move(stamp);
      return append_other();
    }
  }
  const Values values = values_in(rest);
  const bool header = labels_.empty() && values.numbers.empty();
  if (stamps_ != Stamps::none && stamp_.empty() && !header) return append_other();
  if (!labels_.empty() && values.labels != labels_) return append_other();
  if (!begin_.empty() && lower(std::string(values.begin)) != begin_) return append_other();
  if (stamps_ != Stamps::none) out += header ? kStampName : stamp_;
  if (labels_.empty()) {
    const std::size_t separator = rest.find_first_of(",;\t");
    out.append(1, separator == std::string_view::npos ? ' ' : rest[separator]).append(rest);
    return;
  }
  for (const std::string_view number : values.numbers) {
    if (!out.empty() && out.back() != '\n') out += ',';
    out += number;
  }
}

}  // namespace ifog
