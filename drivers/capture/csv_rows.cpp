// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv_rows.h"

#include <algorithm>
#include <deque>
#include <functional>
#include <future>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "drivers/capture/csv_header.h"
#include "drivers/capture/csv_piece.h"
#include "drivers/capture/date_time.h"
#include "drivers/capture/row_checks.h"

namespace ifog {
namespace {

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
  // were_rows: hears of bytes that were.
  using WereRows = std::function<void(std::size_t)>;
  CsvRows(const std::string& path, const CsvLayout& layout, RowSink& sink, WereRows were_rows)
      : path_(path), layout_(layout), sink_(sink), were_rows_(std::move(were_rows)) {}

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
  void count_from_first(std::string_view text);
  void deliver(Piece& piece);
  void merge(const CsvPiece& piece);
  void finish();
  [[nodiscard]] double unit_s() const { return layout_.time.value_or(CsvTime{}).unit_s; }

  const std::string& path_;
  const CsvLayout& layout_;
  RowSink& sink_;
  const WereRows were_rows_;
  CsvHeader header_;
  RowNotes notes_;
  std::vector<ImpossibleValues> impossible_;  // by column
  std::optional<RowChecks> checks_;
  std::size_t lines_ = 0;
  double last_ = std::numeric_limits<double>::quiet_NaN();  // time as in the pieces
  bool decimals_ = false;                                   // in the first time
  int most_decimals_ = 0;                                   // of a time
  std::optional<TimeStamps> stamps_;                        // once there is a row
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
  notes_.header_line = header_.last_line;
  impossible_.resize(header_.names.size());
  std::vector<FileColumn> columns(header_.names.size());
  for (const CsvCell& cell : header_.cells)
    if (cell.column < columns.size()) columns[cell.column] = {cell.name, cell.range, cell.rate};
  checks_.emplace(path_, layout_, std::move(columns), sink_, notes_);
  sink_.begin(header_.names);
}

// Before the pieces are parsed, each by itself: all count from one origin.
void CsvRows::count_from_first(std::string_view text) {
  if (stamps_) return;
  if (const auto first = first_time(text, header_, layout_.separator))
    stamps_.emplace(TimeDigits(*first, layout_.separator != ','), unit_s());
}

void CsvRows::in_order(TextPieces& pieces, std::string text) {
  // Each holds its text and its numbers; more than these unpack no quicker than the file is read.
  const std::size_t at_once = std::clamp(std::thread::hardware_concurrency(), 2U, 8U);
  std::deque<Piece> under_way;
  for (bool more = !text.empty() || pieces.next(text); more; more = pieces.next(text)) {
    Piece& piece = under_way.emplace_back();
    piece.text = std::move(text);
    const auto how = piece.text.size() < kWorthAThread ? std::launch::deferred : std::launch::async;
    count_from_first(piece.text);
    const auto parse = [this, &piece, stamps = stamps_.value_or(TimeStamps())]() -> std::optional<CsvPiece> {
      try {
        return parse_csv_piece(piece.text, header_, layout_.separator, stamps, unit_s(), path_, 0);
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
  if (!parsed || (parsed->rows.size() > 0 && parsed->rows.time_s.front() <= last_)) {
    // Here it is known where the piece stands, and so what to say.
    parsed = parse_csv_piece(piece.text, header_, layout_.separator, stamps_.value_or(TimeStamps()), unit_s(),
                             path_, lines_, last_);
  }
  piece.text = {};
  merge(*parsed);
  lines_ += parsed->lines;
  were_rows_(parsed->row_bytes);
  RowBlock& rows = parsed->rows;
  if (rows.size() == 0) return;
  if (checks_->rows() == 0) decimals_ = parsed->decimals;
  last_ = rows.time_s.back();
  most_decimals_ = std::max(most_decimals_, parsed->most_decimals);
  checks_->take(rows, ExactSteps(parsed->most_decimals, unit_s()));
}

void CsvRows::merge(const CsvPiece& piece) {
  const std::size_t rows = checks_->rows();
  notes_.comments += piece.comments;
  const std::size_t skipped = notes_.skipped.empty() ? 0 : notes_.skipped.back().lines;
  for (const RowNotes::Skipped& here : piece.skipped) {
    if (notes_.skipped.empty() || notes_.skipped.back().row != rows + here.row)
      notes_.skipped.push_back({rows + here.row, 0});
    notes_.skipped.back().lines = skipped + here.lines;
  }
  for (std::size_t i = 0; i < header_.cells.size(); ++i) {
    const ImpossibleValues& found = piece.impossible[i];
    if (found.count == 0 || header_.cells[i].column >= impossible_.size()) continue;
    ImpossibleValues& all = impossible_[header_.cells[i].column];
    if (all.count == 0) all = {0, rows + found.first_row, found.first};
    all.count += found.count;
  }
}

void CsvRows::finish() {
  if (checks_->rows() == 0) throw std::runtime_error(path_ + ": no rows after the header");
  checks_->finish(impossible_, decimals_, ExactSteps(most_decimals_, unit_s()));
}

}  // namespace

RowNotes read_csv_rows(const ReadBytes& read, const std::string& path, const CsvLayout& layout, RowSink& sink,
                       std::size_t piece) {
  return CsvRows(path, layout, sink, [](std::size_t) {}).read(TextPieces(read, piece));
}

RowNotes read_csv_rows(InputFile& file, const CsvLayout& layout, RowSink& sink) {
  const ReadBytes read = [&file](char* to, std::size_t most) { return file.read(to, most); };
  return CsvRows(file.path(), layout, sink, [&file](std::size_t bytes) { file.were_rows(bytes); })
      .read(TextPieces(read, kCsvPiece));
}

}  // namespace ifog
