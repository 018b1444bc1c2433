// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv_rows.h"

#include <algorithm>
#include <deque>
#include <future>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "drivers/capture/chosen_columns.h"
#include "drivers/capture/column_names.h"
#include "drivers/capture/csv_header.h"
#include "drivers/capture/csv_piece.h"
#include "drivers/capture/input_file.h"
#include "drivers/capture/leaps.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr double kMostImpossible = 0.01;  // of a column's cells; more are no single fault of a logger
constexpr std::size_t kWorthAThread = std::size_t{1} << 17U;  // bytes

// A text cut behind lines.
class TextPieces {
 public:
  TextPieces(const ReadBytes& read, std::size_t piece)
      : read_(read), piece_(std::max<std::size_t>(1, piece)) {}

  // False at the end. A line longer than any may be comes out without its end, to be refused.
  bool next(std::string& text) {
    text = std::exchange(tail_, {});
    while (!ended_) {
      const std::size_t before = text.size();
      text.resize(before + piece_);
      const std::size_t n = read_(text.data() + before, piece_);
      text.resize(before + n);
      ended_ = n < piece_;
      const std::size_t last = text.rfind('\n');
      if (last == std::string::npos || last < before) {
        if (text.size() > kLongestLine) return true;
        continue;
      }
      tail_ = text.substr(last + 1);
      text.resize(last + 1);
      return true;
    }
    return !text.empty();
  }

 private:
  const ReadBytes& read_;
  std::size_t piece_;
  std::string tail_;
  bool ended_ = false;
};

class CsvRows {
 public:
  CsvRows(const std::string& path, const CsvLayout& layout, RowSink& sink)
      : path_(path), layout_(layout), sink_(sink) {}

  RowNotes read(TextPieces pieces) {
    std::string text;
    begin(pieces, text);
    in_order(pieces, std::move(text));
    finish();
    return std::move(notes_);
  }

 private:
  struct Piece {
    std::string text;
    std::future<std::optional<CsvPiece>> parsed;  // nothing: refused, with lines counted from its own first
  };

  void begin(TextPieces& pieces, std::string& text);
  void in_order(TextPieces& pieces, std::string text);
  void deliver(Piece& piece);
  void merge(const CsvPiece& piece, std::size_t lines_before);
  void convert_and_pass(RowBlock& rows);
  void pass_on(RowBlock& rows);
  void finish();
  void tell_impossible();
  void tell_leaps();

  const std::string& path_;
  const CsvLayout& layout_;
  RowSink& sink_;
  CsvHeader header_;
  RowNotes notes_;
  std::vector<ImpossibleCells> impossible_;  // by cell of a row
  std::vector<std::size_t> rates_;           // columns
  std::optional<Leaps> leaps_;
  std::optional<RowBlock> all_;  // where angles become rates
  WholeTimes times_;
  std::size_t lines_ = 0, rows_ = 0;
  double last_ = std::numeric_limits<double>::quiet_NaN();    // time in the file's unit
  double last_s_ = std::numeric_limits<double>::quiet_NaN();  // and in seconds
  bool decimals_ = false;                                     // in the first time
};

// `text`: what follows the header in its piece.
void CsvRows::begin(TextPieces& pieces, std::string& text) {
  std::string first;
  bool found = false;
  for (bool start = true; !found && pieces.next(first); start = false) {
    std::string_view left = first;
    if (start && (left.starts_with("\xFF\xFE") || left.starts_with("\xFE\xFF")))
      throw std::runtime_error(path_ + ": begins as UTF-16 does, expected UTF-8 or ASCII");
    if (start && left.starts_with("\xEF\xBB\xBF")) left.remove_prefix(3);  // the byte-order mark
    Lines lines(left, lines_);
    found = read_csv_header(lines, path_, layout_, header_);
    lines_ = lines.number();
    if (found) text = lines.rest();
  }
  if (!found) throw std::runtime_error(path_ + ": no header line, expected 'time_s,rate_radps,…'");
  notes_.comments = std::move(header_.comments);
  notes_.header_line = header_.line;
  impossible_.resize(header_.cells.size());
  std::string axis;
  for (std::size_t c = 0; c < header_.names.size(); ++c)
    if (axis_of(header_.names[c], "rate", axis) || axis_of(header_.names[c], "reference_rate", axis))
      rates_.push_back(c);
  leaps_.emplace(rates_, [this](RowBlock& rows) { sink_.take(rows); });
  if (std::any_of(layout_.columns.begin(), layout_.columns.end(), [](const auto& c) { return c.is_angle(); }))
    all_.emplace();
  sink_.begin(header_.names);
}

void CsvRows::in_order(TextPieces& pieces, std::string text) {
  // Each holds its text and its numbers; more than these unpack no quicker than the file is read.
  const std::size_t at_once = std::clamp(std::thread::hardware_concurrency(), 2U, 8U);
  std::deque<Piece> under_way;
  for (bool more = !text.empty() || pieces.next(text); more; more = pieces.next(text)) {
    Piece& piece = under_way.emplace_back();
    piece.text = std::move(text);
    const auto how = piece.text.size() < kWorthAThread ? std::launch::deferred : std::launch::async;
    const auto parse = [this, &piece]() -> std::optional<CsvPiece> {
      try {
        return parse_csv_piece(piece.text, header_, layout_.separator, path_, 0);
      } catch (const std::runtime_error&) {
        return std::nullopt;
      }
    };
    try {
      piece.parsed = std::async(how, parse);
    } catch (const std::system_error&) {  // no room for another thread: then when its turn comes
      piece.parsed = std::async(std::launch::deferred, parse);
    }
    if (under_way.size() < at_once) continue;
    deliver(under_way.front());
    under_way.pop_front();
  }
  for (; !under_way.empty(); under_way.pop_front()) deliver(under_way.front());
}

void CsvRows::deliver(Piece& piece) {
  std::optional<CsvPiece> parsed = piece.parsed.get();
  std::size_t lines_before = lines_;
  if (!parsed || (parsed->rows.size() > 0 && parsed->rows.time_s.front() <= last_)) {
    // Here it is known where the piece stands, and so what to say.
    parsed = parse_csv_piece(piece.text, header_, layout_.separator, path_, lines_, last_);
    lines_before = 0;
  }
  piece.text = {};
  merge(*parsed, lines_before);
  lines_ += parsed->lines;
  RowBlock& rows = parsed->rows;
  if (rows.size() == 0) return;
  if (rows_ == 0) decimals_ = parsed->decimals;
  last_ = rows.time_s.back();
  convert_and_pass(rows);
}

void CsvRows::merge(const CsvPiece& piece, std::size_t lines_before) {
  notes_.comments += piece.comments;
  const std::size_t skipped = notes_.skipped.empty() ? 0 : notes_.skipped.back().lines;
  for (const RowNotes::Skipped& here : piece.skipped) {
    if (notes_.skipped.empty() || notes_.skipped.back().row != rows_ + here.row)
      notes_.skipped.push_back({rows_ + here.row, 0});
    notes_.skipped.back().lines = skipped + here.lines;
  }
  for (std::size_t i = 0; i < impossible_.size(); ++i) {
    const ImpossibleCells& found = piece.impossible[i];
    if (found.count == 0) continue;
    ImpossibleCells& all = impossible_[i];
    if (all.count == 0) all = {0, lines_before + found.first_line, found.first};
    all.count += found.count;
  }
}

void CsvRows::convert_and_pass(RowBlock& rows) {
  if (layout_.chooses()) convert(rows, layout_, notes_, path_, rows_, last_s_);
  last_s_ = rows.time_s.back();
  times_.take(rows.time_s);
  rows_ += rows.size();
  if (!all_) return leaps_->take(rows);
  all_->columns.resize(rows.columns.size());
  all_->time_s.insert(all_->time_s.end(), rows.time_s.begin(), rows.time_s.end());
  for (std::size_t c = 0; c < rows.columns.size(); ++c)
    all_->columns[c].insert(all_->columns[c].end(), rows.columns[c].begin(), rows.columns[c].end());
}

void CsvRows::finish() {
  if (rows_ == 0) throw std::runtime_error(path_ + ": no rows after the header");
  tell_impossible();
  if (all_) {
    as_rates(*all_, layout_, notes_, path_);
    leaps_->take(*all_);
  }
  leaps_->finish();
  tell_leaps();
  if (const auto notice = times_.notice(path_); notice && !layout_.time && !decimals_)
    notes_.notices.push_back(*notice);
}

// A cell here and there is a fault of the logger, and is missing; where many are, a rate is not what its name
// says. A channel is only missing then: a broken thermometer is no reason to know nothing of the rate.
void CsvRows::tell_impossible() {
  for (std::size_t i = 0; i < impossible_.size(); ++i) {
    const ImpossibleCells& found = impossible_[i];
    const CsvCell& cell = header_.cells[i];
    if (found.count == 0) continue;
    std::string axis;
    const bool rate = axis_of(cell.name, "rate", axis) || axis_of(cell.name, "reference_rate", axis);
    const bool few = !rate || found.count == 1 ||
                     static_cast<double>(found.count) <= kMostImpossible * static_cast<double>(rows_);
    const std::string what = what_no_sensor_measures(cell, found.first);
    if ((cell.rate && rows_ == 1) || !few)
      fail_at(
          path_, found.first_line,
          what + (found.count > 1 ? "; nor " + std::to_string(found.count - 1) + " more of its cells" : ""));
    notes_.faults.push_back(path_ + ":" + std::to_string(found.first_line) + ": " + what + "; " +
                            std::to_string(found.count) + (found.count == 1 ? " such cell" : " such cells") +
                            " taken for missing");
  }
}

void CsvRows::tell_leaps() {
  for (std::size_t r = 0; r < rates_.size(); ++r) {
    const Leaps::Found& found = leaps_->found()[r];
    if (found.count == 0) continue;
    notes_.faults.push_back(path_ + ":" + std::to_string(notes_.line_of_row(found.first_row)) + ": " +
                            printable(header_.names[rates_[r]]) +
                            " says more than half a turn within one sample, from standstill to standstill; " +
                            std::to_string(found.count) + (found.count == 1 ? " such cell" : " such cells") +
                            " taken for missing");
  }
}

}  // namespace

RowNotes read_csv_rows(const ReadBytes& read, const std::string& path, const CsvLayout& layout, RowSink& sink,
                       std::size_t piece) {
  return CsvRows(path, layout, sink).read(TextPieces(read, piece));
}

}  // namespace ifog
