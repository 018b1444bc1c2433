// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv/csv_rows.h"

#include <algorithm>
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
#include "drivers/capture/csv/text_cells.h"
#include "drivers/capture/files/file_kind.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr std::size_t kWorthAThread = std::size_t{1} << 17U;  // bytes
// Bytes of lines without comments, in which table and form of lines are detected.
constexpr std::size_t kHead = std::size_t{256} << 10U;

class CsvRows {
 public:
  CsvRows(const ReadBytes& read, std::size_t piece, const std::string& path, const CsvLayout& layout,
          RowSink& sink, RowsAre rows, InputFile* file = nullptr)
      : pieces_(read, piece),
        path_(path),
        layout_(layout),
        sink_(sink),
        has_lines_(rows == RowsAre::lines),
        file_(file) {
    notes_.path = path;
  }

  RowNotes read() {
    in_order(begin());
    tell_damaged();
    if (checks_->rows() == 0) notes_.refuse(0, "no rows after the header");
    if (so_far_.untimed > 0)
      notes_.notice(0, std::to_string(so_far_.untimed) + " rows without " +
                           in_quotes(header_.cells[header_.time_place]) +
                           " are of another sensor and dropped");
    if (so_far_.missing > 0)
      notes_.notice(0, "of the rows that " + in_quotes(header_.cells[header_.time_place]) + " counts " +
                           std::to_string(so_far_.missing) + " are missing: gaps in time");
    checks_->finish(impossible_);
    return std::move(notes_);
  }

 private:
  struct Piece : CsvPiece {
    std::future<void> parsed;
  };

  // Beginning of the text, independent of how it is read.
  std::string head() {
    std::string head, piece;
    std::size_t plain = 0;
    while (plain < kHead && pieces_.next(piece)) {
      head += piece;
      if (!piece.starts_with('#')) plain += piece.size();
    }
    const std::string other = foreign_text(std::string_view(head).substr(0, InputFile::kHead));
    if (!other.empty()) notes_.refuse(0, other);
    if (head.starts_with("\xEF\xBB\xBF")) head.erase(0, 3);  // byte-order mark
    return head;
  }

  // The text after the header.
  std::string begin() {
    std::string text = head();
    form_ = LineForm(std::string_view(text).substr(0, kHead), path_);
    if (!form_.is_plain()) text = form_.rows_of(text);
    header_ = read_csv_header(text, form_.names(), path_, layout_, has_lines_);
    Lines lines(text);
    for (std::string_view line; lines.number() < header_.last_line && lines.next(line);) continue;
    so_far_.lines = has_lines_ ? lines.number() : 0;
    for (const std::string& comment : header_.sample.comments) keep_comments(comment + '\n');
    notes_.header_line = so_far_.lines;
    for (const std::string& notice : header_.notices) notes_.notice(0, notice);
    impossible_.resize(header_.columns.size());
    checks_.emplace(header_.layout, header_.columns, sink_, notes_);
    std::vector<std::string> names;
    for (const FileColumn& column : header_.columns) names.push_back(column.name);
    sink_.begin(names);
    return std::string(lines.rest());
  }

  void in_order(std::string text) {
    // One more than there are processors, so that none waits for this thread.
    std::vector<Piece> ring(std::clamp(std::thread::hardware_concurrency() + 1, 2U, 8U));
    std::size_t begun = 0, done = 0;
    for (bool more = !text.empty();; more = false) {
      if (begun - done == ring.size()) deliver(ring[done++ % ring.size()]);
      Piece& piece = ring[begun % ring.size()];
      if (more)
        piece.text = std::exchange(text, {});
      else if (!pieces_.next(piece.text))
        break;
      else if (!form_.is_plain())
        piece.text = form_.rows_of(piece.text);
      if (!stamps_) stamps_ = stamps_from(piece.text, header_);  // common origin of all pieces
      begin_to_parse(piece);
      ++begun;
    }
    while (done < begun) deliver(ring[done++ % ring.size()]);
  }

  void begin_to_parse(Piece& piece) {
    const auto parsed = [this, &piece, stamps = stamps_.value_or(TimeStamps())] {
      parse(piece, header_, stamps);
    };
    const bool worth = piece.text.size() >= kWorthAThread;
    try {
      piece.parsed = std::async(worth ? std::launch::async : std::launch::deferred, parsed);
    } catch (const std::system_error&) {  // no more threads: parsed when needed
      piece.parsed = std::async(std::launch::deferred, parsed);
    }
  }

  void deliver(Piece& piece) {
    piece.parsed.get();
    if (piece.too_long.count > 0)
      refuse_long_line(path_, so_far_.lines + piece.too_long.line, piece.too_long.first);
    keep_comments(piece.comments);
    for (std::size_t c = 0; c < impossible_.size(); ++c)
      impossible_[c].append(piece.impossible[c], so_far_.lines);
    damaged_.append(piece.damaged, so_far_.lines);
    unended_.append(piece.unended, so_far_.lines);
    RowBlock& rows = piece.rows;
    for (std::size_t& line : rows.lines) line += so_far_.lines;
    so_far_.lines += piece.lines;
    so_far_.untimed += piece.untimed;
    const std::size_t places = std::exchange(so_far_.places, so_far_.places + piece.places);
    if (file_ != nullptr) file_->were_rows(piece.row_bytes);
    // limit after which the search ends
    constexpr std::size_t kHopeless = 1000;
    if (damaged_.count > std::max(kHopeless, checks_->rows() + rows.size())) tell_damaged();
    if (rows.size() == 0) return;
    if (header_.layout.sample_rate_hz) {
      if (header_.time_place != CsvHeader::kNone)
        places_by_counter(rows);
      else
        for (double& time : rows.time_s) time += static_cast<double>(places);
      for (double& time : rows.time_s) time /= *header_.layout.sample_rate_hz;
    }
    checks_->take(rows);
  }

  // Counts are times until here. One that does not increase rolled over, was repeated, or is a fault, as one that the next
  // row contradicts.
  void places_by_counter(RowBlock& rows) {
    rows.origin = {};
    if (so_far_.place < 0.0) so_far_.count = rows.time_s[0] - 1.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double count = rows.time_s[i], step = count - so_far_.count;
      const double next = i + 1 < rows.size() ? rows.time_s[i + 1] : -1.0;
      const bool fault = next > so_far_.count && (count >= next || step <= 0.0);
      const bool jumps = step > 1.0 && !fault;
      so_far_.missing += jumps ? static_cast<std::size_t>(step) - 1 : 0;
      so_far_.count = fault ? so_far_.count + 1.0 : count;
      rows.time_s[i] = so_far_.place += jumps ? step : 1.0;
    }
  }

  void keep_comments(std::string_view comments) {
    const std::string_view kept = comments.substr(0, kMostComments - notes_.comments.size());
    notes_.comments += kept.substr(0, kept.rfind('\n') + 1);
    if (kept.size() < comments.size() && !std::exchange(so_far_.too_many_comments, true))
      notes_.notice(0, "of the comments the first " + std::to_string(kMostComments) + " bytes are kept");
  }

  // An incomplete last line is reported separately.
  void tell_damaged() {
    const std::size_t rows = checks_->rows();
    for (const auto& [found, few] :
         {std::pair{&damaged_, rows >= kRowsAFault * damaged_.count}, {&unended_, rows > 0}}) {
      if (found->count == 0) continue;
      if (!few) notes_.refuse(found->line, found->first);
      notes_.dropped(*found, "line");
    }
  }

  TextPieces pieces_;
  const std::string& path_;
  const CsvLayout& layout_;
  RowSink& sink_;
  const bool has_lines_;
  InputFile* const file_;
  LineForm form_;
  CsvHeader header_;
  RowNotes notes_;
  std::vector<Fault> impossible_;  // by column
  std::optional<RowChecks> checks_;
  Fault damaged_, unended_;
  struct Counts {
    std::size_t lines = 0, untimed = 0, places = 0;
    bool too_many_comments = false;
    double count = 0.0, place = -1.0;  // of the last row, if a counter says where rows are missing
    std::size_t missing = 0;
  } so_far_;
  std::optional<TimeStamps> stamps_;  // set by the first row
};

}  // namespace

RowNotes read_csv_rows(const ReadBytes& read, const std::string& path, const CsvLayout& layout, RowSink& sink,
                       std::size_t piece, RowsAre rows) {
  return CsvRows(read, piece, path, layout, sink, rows).read();
}

RowNotes read_csv_rows(InputFile& file, const CsvLayout& layout, RowSink& sink) {
  const ReadBytes read = [&file](char* to, std::size_t most) { return file.read_what_is_there(to, most); };
  RowNotes notes = CsvRows(read, kTextPiece, file.path(), layout, sink, RowsAre::lines, &file).read();
  if (file.ends_early())
    notes.fault(0, "the gzip stream ends early (truncated file); the rows until there are read");
  return notes;
}

}  // namespace ifog
