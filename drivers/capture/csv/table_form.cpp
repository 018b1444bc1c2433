// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv/table_form.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/csv/text_cells.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/times/row_sink.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"

namespace ifog {
namespace {

constexpr std::size_t kMostAbove = 1000;  // lines before the first row
constexpr std::ptrdiff_t kMostNameLines = 3;

// Column names that start with a capture's time, with any separator.
bool is_capture_header(std::string_view line) {
  constexpr std::string_view kTime = "time_s";
  line = unquoted(line);
  if (line.starts_with('"')) line.remove_prefix(1);
  return line.starts_with(kTime) &&
         (line.size() == kTime.size() ||
          std::string_view(",;\t|\" ").find(line[kTime.size()]) != std::string_view::npos);
}

// Names in the layout; both parts of "sec+nsec".
std::vector<std::string> wanted_names(const CsvLayout& layout) {
  std::vector<std::string> wanted;
  for (const CsvColumn& column : layout.columns) wanted.push_back(column.header);
  if (layout.time) wanted.push_back(layout.time->header);
  if (!layout.only_header.empty()) wanted.push_back(layout.only_header);
  std::erase_if(wanted, [](const std::string& name) { return is_number_of_column(name); });
  return wanted;
}

bool has_names(const std::vector<std::string>& cells, const std::vector<std::string>& wanted) {
  const auto has = [&](const std::string& name) { return std::ranges::find(cells, name) != cells.end(); };
  return std::ranges::all_of(wanted, [&](const std::string& name) {
    const std::vector<std::string> parts = parts_of_time(name, has);
    return std::ranges::all_of(parts, has);
  });
}

// Cells of a line above rows of this width. Names may have another separator than values: "A_X [mg] A_Y [mg]"
// above tabs, where a unit belongs to the preceding name.
std::vector<std::string> names_in(std::string_view line, char separator, const Row& rows) {
  std::vector<std::string> names = cells_of(without_mark(line), separator);
  if (names.size() + 1 == rows.cells.size() && line.ends_with(separator)) names.emplace_back();
  if (rows.is_as_wide(names.size())) return names;
  for (const char other : {',', ';', '\t', ' '}) {
    std::vector<std::string> cells;
    for (std::string& cell : cells_of(without_mark(line), other))
      // "Rate: 100 Hz" is a sentence.
      if (is_value(cell, other))
        cells.clear();
      else if (other == ' ' && !cells.empty() && (cell.starts_with('[') || cell.starts_with('(')))
        cells.back() += ' ' + cell;
      else
        cells.push_back(std::move(cell));
    if (cells.size() > 1 && rows.is_as_wide(cells.size())) return cells;
  }
  return names;
}

bool are_names(const std::vector<std::string>& names) {
  const std::set<std::string> each(names.begin(), names.end());
  return each.size() == names.size() && !each.contains("");
}

// Units of a row of texts below the names: one is known, or half of them if the names may continue in this row.
std::vector<std::string> units_in(std::vector<std::string> units, const std::vector<std::string>& names,
                                  char separator) {
  const auto value = [&](const std::string& cell) { return cell != "1" && is_value(cell, separator); };
  for (std::string& unit : units) unit = without_brackets(unit);
  if (std::ranges::any_of(units, value)) return {};
  const auto known = std::ranges::count_if(units, is_unit);
  for (std::string& unit : units)
    if (unit == "-" || unit == "1") unit.clear();
  const auto said = std::ssize(units) - std::ranges::count(units, "");
  return known == 0 || (2 * known < said && !are_names(names)) ? std::vector<std::string>() : units;
}

// Header line, its names, and the line before the first row, which may be one of units.
struct Header {
  std::size_t at = 0, last = 0;
  std::vector<std::string> names, units;
};

// First line that is a capture's header or has the names in the layout.
std::optional<Header> header_asked_for(const std::vector<Line>& lines, const Grid& grid,
                                       const std::vector<std::string>& wanted) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (is_comment(lines[i].text)) continue;
    Header header{i, i, cells_of(without_mark(lines[i].text), grid.separator()), {}};
    if (!is_capture_header(lines[i].text) && (wanted.empty() || !has_names(header.names, wanted))) continue;
    if (i + 1 == lines.size()) return header;
    std::vector<std::string> below = cells_of(without_mark(lines[i + 1].text), grid.separator());
    if (below.size() == header.names.size())
      header.units = units_in(std::move(below), header.names, grid.separator());
    header.last += header.units.empty() ? 0 : 1;
    return header;
  }
  return std::nullopt;
}

// "Gyro x" from "x" below "Gyro", which may span several columns. "s" below "Time" goes to the units.
std::vector<std::string> joined(const std::vector<std::string>& above, std::vector<std::string> below,
                                std::vector<std::string>& units) {
  std::string over;
  units.resize(below.size());
  for (std::size_t i = 0; i < below.size(); ++i) {
    if (i < above.size() && !above[i].empty()) over = above[i];
    if (units[i].empty() && is_unit(below[i])) units[i] = std::exchange(below[i], "");
    if (!over.empty() && over != below[i]) below[i] = over + (below[i].empty() ? "" : " " + below[i]);
  }
  return below;
}

// Up to three lines above the rows: names, and a row of units. Duplicate names are completed by the line
// above, which may also contain the gyro's name.
std::vector<Header> headers_above(const std::vector<Line>& lines, const Grid& grid) {
  const std::size_t first = *grid.first();
  const Row& row = grid.rows()[first];
  std::vector<std::vector<std::string>> above;  // upwards
  for (std::size_t back = 1; back <= std::min<std::size_t>(first, kMostNameLines); ++back) {
    above.push_back(names_in(lines[first - back].text, grid.separator(), row));
    // Above a row of units, names may be numbers.
    const bool names =
        !grid.rows()[first - back].is_row() || (back == 2 && !is_value(above[1][0], grid.separator()) &&
                                                !units_in(above[0], above[1], grid.separator()).empty());
    if (row.is_as_wide(above.back().size()) && names) continue;
    above.pop_back();
    break;
  }
  Header header{first, first - 1, {}, {}};
  if (above.size() > 1) header.units = units_in(above[0], above[1], grid.separator());
  if (!header.units.empty()) {
    above.erase(above.begin());
    --header.at;
  }
  std::vector<Header> found;
  const auto add = [&](std::size_t up, std::vector<std::string> names) {
    header.names = std::move(names);
    found.push_back(header);
    found.back().at -= up;
  };
  const bool two = above.size() > 1, own = !above.empty() && are_names(above[0]);
  if (two && !own) are_names(above[1]) ? add(2, above[1]) : add(1, joined(above[1], above[0], header.units));
  if (!above.empty()) add(1, above[0]);
  if (two && own && are_names(above[1])) add(2, above[1]);
  return found;
}

// "a[0]" to "a[3]": columns without names of their own, of which more than axes.
bool are_of_one_matrix(const std::vector<std::string>& names) {
  const std::string stem = names[0].substr(0, names[0].rfind('[') + 1);
  return names.size() > 3 && stem.size() > 1 && std::ranges::all_of(names, [&](const auto& name) {
           return name.starts_with(stem) && name.ends_with(']');
         });
}

std::vector<Line> first_lines(std::string_view text, const std::string& path) {
  Lines lines(text);
  std::vector<Line> out;
  std::string_view line;
  std::size_t plain = 0, comments = 0;  // lines, and bytes that are kept
  while (plain < kMostAbove + Grid::kSampleRows && lines.next(line)) {
    if (line.size() > kLongestLine) refuse_long_line(path, lines.number(), line);
    if (trimmed(line).empty()) continue;
    out.push_back({line, lines.number()});
    if (!is_comment(line)) {
      ++plain;
      continue;
    }
    comments += text_of_comment(line).size() + 1;
    if (std::ssize(out) <= kMostNameLines) continue;
    // Of more than are reported as too many only the last ones are kept, which may be names.
    const auto old = out.end() - kMostNameLines - 1;
    const std::size_t size = text_of_comment(old->text).size() + 1;
    if (is_comment(old->text) && comments > 2 * kMostComments + size) comments -= size, out.erase(old);
  }
  return out;
}

// A LabVIEW measurement file has two heads, and a last name, Comment, without cells. Returns its row of
// units. Source: NI, "Specification for the LabVIEW Measurement File (.lvm)".
std::vector<std::string> without_heads(std::vector<Line>& lines, std::vector<std::string>& comments) {
  const auto last = std::find_if(lines.rbegin(), lines.rend(), [&](const Line& line) {
    return line.text.starts_with("***End_of_Header***");
  });
  std::vector<std::string> units;
  if (lines.empty() || !lines[0].text.starts_with("LabVIEW Measurement") || last == lines.rend())
    return units;
  for (auto line = lines.begin(); line != last.base(); ++line) {
    std::vector<std::string> cells = cells_of(line->text, '\t');
    if (cells.size() < 2) continue;
    const auto step_s = finite_number(PointDigits(cells[1], {true}));
    if (cells[0] == "Delta_X" && step_s && *step_s > 0.0)
      comments.push_back("sample rate " + shortest(1.0 / *step_s));
    if (cells[0] == "Y_Unit_Label") {
      units = std::move(cells);
      units[0] = "s";  // of X_Value
    }
  }
  lines.erase(lines.begin(), last.base());
  if (!lines.empty() && lines[0].text.ends_with("\tComment"))
    lines[0].text.remove_suffix(std::string_view("\tComment").size());
  return units;
}

// Drops rows of other kinds than the layout's, which may have any width.
void keep_kind(const CsvLayout& layout, std::vector<Line>& lines, Grid& grid) {
  if (!is_number_of_column(layout.only_header) || layout.only_value.empty()) return;
  const std::size_t place = std::strtoul(layout.only_header.c_str() + 1, nullptr, 10) - 1;
  const auto is_wanted = [&](const Row& row) {
    return place < row.cells.size() && row.cells[place] == layout.only_value;
  };
  if (std::ranges::none_of(grid.rows(), is_wanted)) return;  // reported where the rows are read
  std::size_t i = 0;
  std::erase_if(lines, [&](const Line&) {
    const Row& row = grid.rows()[i++];
    return !row.comment && row.values > 0 && !is_wanted(row);
  });
  grid = Grid(lines, grid.separator());
}

// In a log whose lines have several widths and a text that names their kind, keeps the most frequent kind of
// those as wide as the table. False: there is none.
bool choose_kind(CsvLayout& layout, std::vector<Line>& lines, Grid& grid) {
  for (std::size_t place = 0; place < grid.width(); ++place) {
    std::map<std::string, std::ptrdiff_t> kinds;  // rows as wide as the table, minus others
    for (const Row& row : grid.rows())
      if (row.is_row() && place < row.cells.size())
        kinds[row.cells[place]] += row.is_as_wide(grid.width()) ? 1 : -1;
    const auto is_text = [&](const auto& kind) {
      return !kind.first.empty() && !is_value(kind.first, grid.separator());
    };
    const auto [least, most] = std::ranges::minmax_element(kinds, {}, &decltype(kinds)::value_type::second);
    if (least->second >= 0 || most->second <= 0 || !std::ranges::all_of(kinds, is_text)) continue;
    layout.only_header = "#" + std::to_string(place + 1);
    layout.only_value = most->first;
    keep_kind(layout, lines, grid);
    return true;
  }
  return false;
}

// A cell with both marks, "1,234.5", says which of them is that of thousands in all others.
Notation notation_of(const Grid& grid) {
  Notation by{grid.separator() != ','};
  for (const Row& row : grid.rows())
    for (const std::string& cell : row.cells)
      if (cell.find(',') < cell.size() && cell.find('.') < cell.size() && is_value(cell, grid.separator()) &&
          by.thousands == '\0')
        by.thousands = mark_of_thousands(cell, '\0');
  return by;
}

// Columns of VectorNav's ASCII sentences (VN-100 User Manual, asynchronous outputs); empty for other rows.
std::vector<std::string> names_by_sentence(const std::vector<std::string>& row) {
  std::vector<std::string> names{"sentence"};
  const auto add = [&](std::initializer_list<std::string> more) { names.insert(names.end(), more); };
  if (row[0] == "$VNYMR") add({"yaw_deg", "pitch_deg", "roll_deg"});
  if (names.size() == 1 && row[0] != "$VNIMU") return {};
  add({"mag_x_gauss", "mag_y_gauss", "mag_z_gauss", "accel_x_mps2", "accel_y_mps2", "accel_z_mps2",
       "gyro_x_radps", "gyro_y_radps", "gyro_z_radps"});
  if (row[0] == "$VNIMU") add({"temperature_degC", "pressure_kPa"});
  return names.size() == row.size() ? names : std::vector<std::string>();
}

// Cells of the first rows, by column.
std::vector<std::vector<std::string>> first_cells(const Grid& grid, Notation by, std::size_t from,
                                                  std::size_t columns) {
  std::vector<std::vector<std::string>> cells(columns);
  for (std::size_t i = from; i < grid.rows().size() && cells[0].size() < Grid::kSampleRows; ++i) {
    const Row& row = grid.rows()[i];
    if (row.comment || !row.is_as_wide(columns)) continue;
    for (std::size_t c = 0; c < columns; ++c) {
      const std::string cell = c < row.cells.size() && !is_no_number(row.cells[c]) ? row.cells[c] : "";
      const PointDigits digits(cell, by);
      cells[c].emplace_back(is_date(cell) ? std::string_view(cell) : std::string_view(digits));
    }
  }
  return cells;
}

// Chooses the first possible header with which the table can be read, or that has the requested names. units: of the
// columns, if a head of the file has them. False: no header.
bool take_header(const std::vector<Line>& lines, const Grid& grid, const CsvLayout& layout,
                 const std::vector<std::string>& units, TableForm& form) {
  const auto take = [&](const Header& header) {
    form.header_line = lines[header.at].number;
    form.last_line = lines[header.last].number;
    const std::size_t columns = header.names.size();
    form.sample.named = !are_of_one_matrix(header.names);
    form.sample.set(header.names, units.size() >= columns ? units : header.units,
                    first_cells(grid, form.notation, header.last + 1, columns));
  };
  const std::vector<std::string> wanted = wanted_names(layout);
  const std::vector<Header> above = grid.first() ? headers_above(lines, grid) : std::vector<Header>();
  for (const Header& header : above)
    if (!wanted.empty() && has_names(header.names, wanted)) return take(header), true;
  if (const auto header = header_asked_for(lines, grid, wanted)) return take(*header), true;
  if (above.empty()) return false;
  const bool found = std::ranges::any_of(above, [&](const Header& header) {
    take(header);
    return !readings_of(form.sample, layout).ways.empty();
  });
  if (!found) take(above.front());
  return true;
}

}  // namespace

TableForm table_form(std::string_view text, const std::vector<std::string>& given, const std::string& path,
                     const CsvLayout& layout) {
  std::vector<Line> lines = first_lines(text, path);
  TableForm form;
  form.layout = layout;
  TableSample& sample = form.sample;
  const std::vector<std::string> units = without_heads(lines, sample.comments);
  std::optional<char> separator;
  if (layout.separator != '\0') separator = layout.separator;
  if (!given.empty()) separator = ',';
  // Spreadsheets' separator line above the header.
  if (!lines.empty() && lines[0].text.size() == 5 &&
      (lines[0].text.starts_with("sep=") || lines[0].text.starts_with("SEP="))) {
    if (!separator) separator = lines[0].text[4];
    lines.erase(lines.begin());
  }
  const auto plain = std::ranges::find_if(lines, [](const Line& line) { return !is_comment(line.text); });
  if (plain == lines.end()) fail_at(path, 0, "no header line, expected 'time_s,rate_radps,…'");
  if (!separator && is_capture_header(plain->text) && plain->text.find(',') != std::string_view::npos)
    separator = ',';
  Grid grid = separator ? Grid(lines, *separator) : Grid::of(lines);
  keep_kind(layout, lines, grid);
  form.separator = grid.separator();
  form.notation = notation_of(grid);
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (!grid.rows()[i].comment && grid.rows()[i].cells.size() > kInputLimits.csv_columns)
      fail_at(path, lines[i].number,
              "more than " + std::to_string(kInputLimits.csv_columns) +
                  " columns, expected at most that (cut -d, -f1-9 takes some)");
  bool headed = given.empty() && take_header(lines, grid, layout, units, form);
  if (!headed && given.empty() && grid.first() && layout.only_header.empty())
    headed = choose_kind(form.layout, lines, grid) && take_header(lines, grid, layout, units, form);
  if (!headed && grid.first()) {
    std::vector<std::string> names = given;
    if (given.empty()) names = names_by_sentence(grid.rows()[*grid.first()].cells);
    sample.named = !names.empty();
    for (std::size_t i = 0; !sample.named && i < grid.width(); ++i)
      names.push_back("#" + std::to_string(i + 1));
    form.last_line = lines[*grid.first()].number - 1;
    sample.set(names, {}, first_cells(grid, form.notation, *grid.first(), names.size()));
    if (const Row* const above = *grid.first() > 0 ? &grid.rows()[*grid.first() - 1] : nullptr;
        above != nullptr && !above->comment && above->values == 0 && above->cells.size() > 1) {
      form.header_line = lines[*grid.first() - 1].number;
      form.unused_names = above->cells.size();
    }
  } else if (!headed) {
    fail_at(path, plain->number,
            "no table found, expected a header 'time_s,rate_radps,…' and rows of numbers below; the first "
            "line is " +
                in_quotes(plain->text));
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    const Row& row = grid.rows()[i];
    if (line.number > form.last_line || (headed && line.number == form.header_line)) break;
    if (headed || row.comment || row.values < row.cells.size())
      sample.comments.emplace_back(row.comment ? text_of_comment(line.text) : trimmed(line.text));
  }
  return form;
}

}  // namespace ifog
