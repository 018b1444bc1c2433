// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/hdf5/hdf5_text.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <ratio>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/csv/csv_rows.h"
#include "drivers/capture/csv/text_cells.h"
#include "drivers/capture/hdf5/hdf5_columns.h"
#include "drivers/capture/times/date_time.h"

namespace ifog {

namespace {

// Results of the reading process besides the text.
struct Said {
  std::atomic<std::uint64_t> rows_done{0}, rows{0};
  std::array<char, 4096> refusal{}, notices{};  // zero-terminated texts; notices: one per line
};

// Bytes, in addition to the program's own memory and a copy of the file
constexpr rlim_t kMostMemory = 2ULL << 30U;
// Limits of processor time per block and of the speed of unpacking.
constexpr std::size_t kMostSeconds = 5, kLeastUnpacked = 32U << 20U;  // s, bytes/s

std::string reason() { return std::generic_category().message(errno); }

// Private memory of this process, as counted by RLIMIT_DATA.
rlim_t memory_in_use() {
  unsigned long pages = 0;
  if (std::FILE* const file = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(file, "%*u %*u %*u %*u %*u %lu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

// Restricts this process to reading the file: it ends with its parent, writes no core dump, and its only
// output is the pipe.
void shut_in(std::size_t image) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  prctl(PR_SET_DUMPABLE, 0);
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPROF, SIGINT, SIGTERM})
    ::signal(signal, SIG_DFL);
  ::signal(SIGPIPE, SIG_IGN);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const rlim_t most = memory_in_use() + image + kMostMemory;
  const rlimit nothing{0, 0}, memory{most, most};
  setrlimit(RLIMIT_CORE, &nothing);
  setrlimit(RLIMIT_FSIZE, &nothing);
  setrlimit(RLIMIT_DATA, &memory);
  // The library reports a damaged heap on standard error.
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nowhere >= 0)
    for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, fd);
}

void allow_seconds(std::size_t chunk = 0) {
  const itimerval timer{{0, 0}, {static_cast<time_t>(kMostSeconds + chunk / kLeastUnpacked), 0}};
  setitimer(ITIMER_PROF, &timer, nullptr);
}

void put(const std::string& text, std::FILE* out) {
  if (std::fwrite(text.data(), 1, text.size(), out) != text.size())
    throw std::runtime_error("nobody listens");
}

// As in a comment of a CSV file.
std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

void print_head(const Hdf5Columns& columns, std::FILE* out) {
  for (const std::string& comment : columns.comments()) put("# " + one_line(comment) + "\n", out);
  std::string names, units;
  bool any_unit = false;
  for (const Hdf5Column& column : columns.columns()) {
    // An unknown unit could not be mistaken for a row of numbers.
    const bool known = is_unit(column.unit);
    any_unit = any_unit || known;
    names += (names.empty() ? "" : ",") + as_cell(one_line(column.name));
    units += (units.empty() ? "" : ",") + (known ? as_cell(column.unit) : "-");
  }
  put(names + "\n", out);
  if (any_unit) put(units + "\n", out);
}

char* print(char* at, char* end, std::uint64_t bits, Hdf5Value value) {
  const auto whole = static_cast<std::int64_t>(bits);
  if (value == Hdf5Value::real) return std::to_chars(at, end, std::bit_cast<double>(bits)).ptr;
  if (value == Hdf5Value::whole) return std::to_chars(at, end, whole).ptr;
  const std::uint64_t ns = whole < 0 ? 0 - bits : bits;
  if (whole < 0) *at++ = '-';
  at = std::to_chars(at, end, ns / std::nano::den).ptr;
  char* const point = at;
  at = std::to_chars(at, end, std::nano::den + ns % std::nano::den)
           .ptr;  // a one that is replaced by the point, and nine digits
  *point = '.';
  return at;
}

void print_rows(const Hdf5Columns& columns, std::FILE* out, std::atomic<std::uint64_t>& done) {
  const std::size_t count = columns.columns().size(), most = columns.block_rows();
  std::vector<std::vector<std::uint64_t>> values(count);
  std::string line;
  std::array<char, 32> text{};  // the longest double has 24 characters
  for (std::uint64_t first = 0; first < columns.rows(); first += most) {
    for (std::size_t c = 0; c < count; ++c) {
      values[c].resize(std::min<std::uint64_t>(most, columns.rows() - first));
      allow_seconds(std::max(columns.chunk_bytes(), values[c].size() * sizeof(double)));
      columns.read(columns.columns()[c], first, values[c]);
    }
    for (std::size_t row = 0; row < values[0].size(); ++row) {
      line.clear();
      for (std::size_t c = 0; c < count; ++c) {
        char* const end =
            print(text.data(), text.data() + text.size() - 1, values[c][row], columns.columns()[c].value);
        *end = c + 1 == count ? '\n' : ',';
        line.append(text.data(), end + 1);
      }
      put(line, out);
    }
    done = first + values[0].size();
  }
}

void keep(std::string_view text, std::array<char, 4096>& to) {
  text = text.substr(0, to.size() - 1);
  std::copy(text.begin(), text.end(), to.begin());
}

std::string kept(const std::array<char, 4096>& text) { return {text.begin(), std::ranges::find(text, '\0')}; }

// Text of a file, from a separate process that ends with this object.
class Hdf5Text {
 public:
  // The file must outlive this object. Throws std::runtime_error with one line.
  Hdf5Text(InputFile& file, Hdf5Wanted wanted) : file_(file) {
    struct stat info {};
    if (!file.reopens() || stat(file.path().c_str(), &info) != 0) image_ = file.bytes();
    wanted.image = image_;
    wanted.file_bytes = image_.empty() ? static_cast<std::uint64_t>(info.st_size) : image_.size();
    void* const shared =
        mmap(nullptr, sizeof(Said), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) throw std::runtime_error(file.path() + ": no memory: " + reason());
    said_.reset(new (shared) Said);
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(file.path() + ": no pipe: " + reason());
    pipe_ = ends[0];
    reader_ = fork();
    if (reader_ == 0) print(wanted, ends[1]);
    ::close(ends[1]);
    if (reader_ > 0) return;
    ::close(pipe_);
    throw std::runtime_error(file.path() + ": no process to read it: " + reason());
  }
  ~Hdf5Text() {
    ::close(pipe_);
    if (reader_ <= 0) return;
    ::kill(reader_, SIGKILL);
    while (waitpid(reader_, nullptr, 0) < 0 && errno == EINTR) continue;
  }
  Hdf5Text(const Hdf5Text&) = delete;
  Hdf5Text& operator=(const Hdf5Text&) = delete;

  // As InputFile::read. Throws std::runtime_error with one line: unsuitable or damaged file.
  std::size_t read(char* to, std::size_t most) {
    std::size_t done = 0;
    while (done < most && reader_ > 0) {
      const ssize_t n = ::read(pipe_, to + done, most - done);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) break;
      done += static_cast<std::size_t>(n);
    }
    file_.report(said_->rows_done, said_->rows);
    if (done == most || reader_ <= 0) return done;
    int status = 0;
    while (waitpid(reader_, &status, 0) < 0 && errno == EINTR) continue;
    reader_ = -1;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return done;
    if (WIFEXITED(status) && said_->refusal[0] != '\0')
      throw std::runtime_error(file_.path() + ": " + printable(kept(said_->refusal), said_->refusal.size()));
    const bool slow = WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF;
    throw std::runtime_error(file_.path() + ": is damaged: the HDF5 library " +
                             (slow ? "comes to no end with it" : "breaks down over it"));
  }
  // Ignored content; known at the end.
  [[nodiscard]] std::vector<std::string> notices() const { return lines_of(kept(said_->notices)); }

 private:
  struct Unmap {
    void operator()(Said* said) const { munmap(said, sizeof(Said)); }
  };

  // Runs in the separate process. Never returns, so destructors and buffers of the parent are not run twice.
  [[noreturn]] void print(const Hdf5Wanted& wanted, int to) {
    shut_in(wanted.image.size());
    allow_seconds();
    try {
      const Hdf5Columns columns(wanted);
      said_->rows = columns.rows();
      std::string notices;
      for (const std::string& notice : columns.notices()) notices += one_line(notice) + '\n';
      keep(notices, said_->notices);
      std::FILE* const out = fdopen(to, "w");
      print_head(columns, out);
      print_rows(columns, out, said_->rows_done);
      if (std::fflush(out) != 0) throw std::runtime_error("nobody listens");
    } catch (const std::exception& error) {
      keep(error.what(), said_->refusal);
      _exit(1);
    }
    _exit(0);
  }

  InputFile& file_;
  std::string image_;                  // content of a file that cannot be opened by name
  std::unique_ptr<Said, Unmap> said_;  // shared memory
  int pipe_ = -1;
  pid_t reader_ = -1;
};

}  // namespace

RowNotes read_hdf5_rows(InputFile& file, const std::string& group, const CsvLayout& layout, RowSink& sink) {
  Hdf5Wanted wanted{file.path(), {}, group, {}, true, 0};
  const auto ask = [&](const std::string& header) {
    const bool number = is_number_of_column(header);
    if (!header.empty() && !number) wanted.names.push_back(header);
    wanted.others = wanted.others || number;
  };
  // If all columns are chosen, no others need to be unpacked.
  wanted.others = layout.columns.empty() || !layout.time || layout.other_rates;
  if (!layout.columns.empty() && layout.time) ask(layout.time->header);
  for (const CsvColumn& column : layout.columns) ask(column.header);
  ask(layout.only_header);
  Hdf5Text text(file, wanted);
  RowNotes notes = read_csv_rows([&](char* to, std::size_t most) { return text.read(to, most); }, file.path(),
                                 layout, sink, kTextPiece, RowsAre::numbered);
  for (const std::string& notice : text.notices())
    notes.notices.push_back(file.path() + ": " + printable(notice, notice.size()));
  return notes;
}

}  // namespace ifog
