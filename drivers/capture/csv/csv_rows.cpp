// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv/csv_rows.h"

#include <algorithm>
#include <functional>
#include <future>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/capture/checks/row_checks.h"
#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/csv/csv_header.h"
#include "drivers/capture/csv/csv_piece.h"
#include "drivers/capture/csv/line_form.h"
#include "drivers/capture/files/file_kind.h"
#include "drivers/capture/files/text_pieces.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr std::size_t kWorthAThread = std::size_t{1} << 17U;  // bytes
// Bytes of lines that are no comments, to find the table and the form of its lines in.
constexpr std::size_t kHead = std::size_t{256} << 10U;

// Pieces of a text whose lines are rows of cells, or become such.
class CsvText {
 public:
  CsvText(const ReadBytes& read, std::size_t piece) : pieces_(read, piece) {}

  bool next(std::string& to) {
    if (!pieces_.next(to)) return false;
    if (!std::exchange(begun_, true)) begin(to);
    if (!form_.is_plain()) to = form_.rows_of(to);
    return true;
  }
  // Of the lines, once the first piece was handed out.
  [[nodiscard]] const LineForm& form() const { return form_; }

 private:
  // However the text is cut, the same of it shows the form.
  void begin(std::string& first) {
    for (std::string more; first.size() < kHead && pieces_.next(more);) first += more;
    if (first.starts_with("\xEF\xBB\xBF")) first.erase(0, 3);  // the byte-order mark
    form_ = LineForm(std::string_view(first).substr(0, kHead));
  }

  TextPieces pieces_;
  LineForm form_;
  bool begun_ = false;
};

class CsvRows {
 public:
  // were_rows: hears of bytes that were.
  using WereRows = std::function<void(std::size_t)>;
  CsvRows(const std::string& path, const CsvLayout& layout, RowSink& sink, RowsAre rows, WereRows were_rows)
      : path_(path),
        layout_(layout),
        sink_(sink),
        has_lines_(rows == RowsAre::lines),
        were_rows_(std::move(were_rows)) {}

  RowNotes read(CsvText pieces) {
    in_order(pieces, begin(pieces));
    finish();
    return std::move(notes_);
  }

 private:
  // Its memory is used again for later pieces, because new pages cost as much as the reading.
  struct Piece {
    std::string text;
    RowBlock rows;
    std::future<CsvPiece> parsed;
  };

  std::string begin(CsvText& pieces);
  void in_order(CsvText& pieces, std::string text);
  void parse(Piece& piece);
  void deliver(Piece& piece);
  void tell_damaged();
  void finish();

  const std::string& path_;
  const CsvLayout& layout_;
  RowSink& sink_;
  const bool has_lines_;
  const WereRows were_rows_;
  CsvHeader header_;
  RowNotes notes_;
  std::vector<Fault> impossible_;  // by column
  std::optional<RowChecks> checks_;
  Fault damaged_, unended_;
  std::size_t lines_ = 0, untimed_ = 0, places_ = 0;
  std::optional<TimeStamps> stamps_;  // once there is a row
};

// What follows the header.
std::string CsvRows::begin(CsvText& pieces) {
  std::string head, piece;
  std::size_t plain = 0;
  while (plain < kHead && pieces.next(piece)) {
    if (head.empty() && begins_as_utf16(piece))
      throw std::runtime_error(path_ +
                               ": is text in UTF-16, expected UTF-8; 'iconv -f UTF-16 -t UTF-8' makes it");
    if (head.empty() && piece.find('\n') == std::string::npos &&
        std::count(piece.begin(), piece.end(), '\r') > 1)
      throw std::runtime_error(
          path_ +
          ": its lines end in a carriage return, expected a line feed; \"tr '\\r' '\\n'\" "
          "makes it");
    head += piece;
    if (!piece.starts_with('#')) plain += piece.size();
  }
  header_ = read_csv_header(head, pieces.form().names(), path_, layout_, has_lines_);
  Lines lines(head);
  for (std::string_view line; lines.number() < header_.last_line && lines.next(line);) continue;
  lines_ = has_lines_ ? lines.number() : 0;
  notes_.comments = std::move(header_.comments);
  notes_.header_line = lines_;
  notes_.notices = std::move(header_.notices);
  impossible_.resize(header_.names.size());
  checks_.emplace(path_, header_.layout, header_.columns, sink_, notes_);
  sink_.begin(header_.names);
  for (CsvCell& cell : header_.cells)
    if (cell.column < header_.names.size()) cell.kept = sink_.wants(cell.column);
  return std::string(lines.rest());
}

void CsvRows::in_order(CsvText& pieces, std::string text) {
  // One more than there are processors, so that none waits while this thread hands over.
  std::vector<Piece> ring(std::clamp(std::thread::hardware_concurrency() + 1, 2U, 8U));
  std::size_t begun = 0, done = 0;
  for (bool more = !text.empty();; more = false) {
    if (begun - done == ring.size()) deliver(ring[done++ % ring.size()]);
    Piece& piece = ring[begun % ring.size()];
    if (more)
      piece.text = std::move(text);
    else if (!pieces.next(piece.text))
      break;
    if (!stamps_) stamps_ = stamps_from(piece.text, header_);  // all pieces count from one origin
    parse(piece);
    ++begun;
  }
  while (done < begun) deliver(ring[done++ % ring.size()]);
}

void CsvRows::parse(Piece& piece) {
  const auto parsed = [this, &piece, stamps = stamps_.value_or(TimeStamps())] {
    return parse_csv_piece(piece.text, header_, stamps, std::move(piece.rows));
  };
  const bool worth = piece.text.size() >= kWorthAThread;
  try {
    piece.parsed = std::async(worth ? std::launch::async : std::launch::deferred, parsed);
  } catch (const std::system_error&) {  // no room for another thread: then when its turn comes
    piece.parsed = std::async(std::launch::deferred, parsed);
  }
}

void CsvRows::deliver(Piece& piece) {
  CsvPiece parsed = piece.parsed.get();
  if (parsed.too_long.count > 0)
    refuse_long_line(path_, lines_ + parsed.too_long.line, parsed.too_long.first);
  notes_.comments += parsed.comments;
  for (std::size_t c = 0; c < impossible_.size(); ++c) impossible_[c].append(parsed.impossible[c], lines_);
  damaged_.append(parsed.damaged, lines_);
  unended_.append(parsed.unended, lines_);
  piece.rows = std::move(parsed.rows);
  RowBlock& rows = piece.rows;
  for (std::size_t& line : rows.lines) line += lines_;
  lines_ += parsed.lines;
  untimed_ += parsed.untimed;
  const std::size_t places = std::exchange(places_, places_ + parsed.places);
  were_rows_(parsed.row_bytes);
  // So many that nothing is gained by looking on.
  constexpr std::size_t kHopeless = 1000;
  if (damaged_.count > std::max(kHopeless, checks_->rows() + rows.size())) tell_damaged();
  if (rows.size() == 0) return;
  if (header_.layout.sample_rate_hz)
    for (double& time : rows.time_s)
      time = (static_cast<double>(places) + time) / *header_.layout.sample_rate_hz;
  checks_->take(rows);
}

// The last line without its end counts for itself.
void CsvRows::tell_damaged() {
  const std::size_t rows = checks_->rows();
  for (const auto& [found, few] :
       {std::pair{&damaged_, rows >= kRowsAFault * damaged_.count}, {&unended_, rows > 0}}) {
    if (found->count == 0) continue;
    if (!few) fail_at(path_, found->line, found->first);
    notes_.faults.push_back(found->left_out(path_, "line"));
  }
}

void CsvRows::finish() {
  tell_damaged();
  if (checks_->rows() == 0) throw std::runtime_error(path_ + ": no rows after the header");
  if (untimed_ > 0)
    notes_.notices.push_back(path_ + ": " + std::to_string(untimed_) + " rows without " +
                             in_quotes(header_.cells[header_.time_place].name) +
                             " are of another sensor and dropped");
  checks_->finish(impossible_);
}

}  // namespace

RowNotes read_csv_rows(const ReadBytes& read, const std::string& path, const CsvLayout& layout, RowSink& sink,
                       std::size_t piece, RowsAre rows) {
  return CsvRows(path, layout, sink, rows, [](std::size_t) {}).read(CsvText(read, piece));
}

RowNotes read_csv_rows(InputFile& file, const CsvLayout& layout, RowSink& sink) {
  const ReadBytes read = [&file](char* to, std::size_t most) { return file.read_what_is_there(to, most); };
  RowNotes notes = CsvRows(file.path(), layout, sink, RowsAre::lines, [&file](std::size_t bytes) {
                     file.were_rows(bytes);
                   }).read(CsvText(read, kTextPiece));
  if (file.ends_early())
    notes.faults.push_back(file.path() +
                           ": the gzip stream ends early (truncated file); the rows until there are read");
  return notes;
}

}  // namespace ifog
