// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/file/file.h"
#include "drivers/transport/clock.h"

#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <utility>

#include "drivers/capture/candump/candump.h"
#include "drivers/transport/file/byte_file.h"
#include "drivers/transport/file/pace.h"

namespace ifog {
namespace {

constexpr std::size_t kBatch = 64;  // frames per delivery

class FileTransport : public Transport {
 public:
  explicit FileTransport(FileSettings settings)
      : Transport(settings.path == "-" ? "standard input" : settings.path),
        settings_(std::move(settings)),
        pace_(settings_.speed) {}

  [[nodiscard]] bool holds_back() const override { return settings_.pace == FileSettings::Pace::free; }
  [[nodiscard]] bool times_are_recorded() const override {
    return holds_back() &&
           (settings_.format == FileSettings::Format::candump || settings_.bytes_per_second > 0.0);
  }

 protected:
  bool connect(std::string& /*warning*/, std::int64_t /*until_ns*/) override {
    reopen();
    return true;
  }
  Delivery receive(std::int64_t until_ns) noexcept override;

  [[nodiscard]] bool recorded() const { return settings_.pace == FileSettings::Pace::recorded; }

  // Adds to the file's unread bytes, waiting until `until_ns`. False: no data, or end of file.
  bool fill(std::int64_t until_ns) noexcept;
  // Waits until the recorded time is due; false if `until_ns` or stop() comes first.
  bool await(std::int64_t recorded_ns, std::int64_t until_ns) noexcept;

  // Called for a newly opened file.
  virtual void begin() noexcept = 0;
  // Returns one delivery from the unread bytes; empty if there are too few.
  virtual Delivery take(std::int64_t until_ns) noexcept = 0;

  FileSettings settings_;
  ByteFile file_;
  Pace pace_;
  bool at_end_ = false;

 private:
  void reopen();
  void finish() noexcept;

  int read_error_ = 0;
  bool written_ = false;  // data have been written since it was opened
};

// opening() is not sent to a recording.
void FileTransport::reopen() {
  file_.open(settings_.path);
  at_end_ = written_ = false;
  pace_ = Pace(settings_.speed);
  begin();
}

Delivery FileTransport::receive(std::int64_t until_ns) noexcept {
  const Delivery delivery = take(until_ns);
  const bool ends = at_end_ && file_.unread().empty() && state() != TransportState::ended;
  // A FIFO that was made again is another one.
  if (delivery.empty() && (ends || (!written_ && file_.is_removed()))) finish();
  return delivery;
}

// The end was reached.
void FileTransport::finish() noexcept {
  if (!file_.is_fifo() || !settings_.await_writer || read_error_ != 0) {
    file_.close();
    end(read_error_);
    return;
  }
  // The old descriptor would report its hang-up forever, so it is reopened.
  try {
    reopen();
    left();
  } catch (const OpenError& error) {
    file_.close();
    lost(error.reason);
  } catch (const std::exception&) {
    file_.close();
    lost(ENOMEM);
  }
}

bool FileTransport::fill(std::int64_t until_ns) noexcept {
  while (!at_end_) {
    if (file_.poll_fd() >= 0) {
      if (waiting_.wait(file_.poll_fd(), POLLIN, until_ns) != Wake::ready) return false;
      written_ = true;
    }
    switch (file_.fill()) {
      case ByteFile::Fill::more:
        return true;
      case ByteFile::Fill::none:
        break;
      case ByteFile::Fill::truncated:
        report("the gzip stream ends early or is damaged", 0);
        at_end_ = true;
        break;
      case ByteFile::Fill::error:
        read_error_ = errno;
        at_end_ = true;
        break;
      case ByteFile::Fill::end:
        at_end_ = true;
        break;
    }
  }
  return false;
}

bool FileTransport::await(std::int64_t recorded_ns, std::int64_t until_ns) noexcept {
  if (!pace_.started()) pace_.start(recorded_ns, monotonic_ns());
  const std::int64_t due = pace_.due_ns(recorded_ns);
  if (due <= monotonic_ns()) return true;
  return waiting_.wait(-1, 0, std::min(due, until_ns)) != Wake::stopped && due <= until_ns;
}

class BytesFile final : public FileTransport {
 public:
  explicit BytesFile(FileSettings settings) : FileTransport(std::move(settings)) {
    const double rate = settings_.bytes_per_second * settings_.speed;
    block_ = std::min<std::size_t>(settings_.block_bytes, ByteFile::kCapacity);
    if (block_ == 0)
      block_ = static_cast<std::size_t>(std::max(1.0, std::min(rate / 1000.0, ByteFile::kCapacity / 2.0)));
  }

 private:
  void begin() noexcept override {
    opened_ns_ = arrival_clock_ns();
    delivered_ = held_ = 0;
  }
  Delivery take(std::int64_t until_ns) noexcept override;
  // Recorded time of the end of the first n bytes.
  [[nodiscard]] std::int64_t recorded_ns(std::uint64_t n) const {
    return std::llround(static_cast<double>(n) / settings_.bytes_per_second * 1e9);
  }

  std::size_t block_;
  std::size_t held_ = 0;  // part of file_.unread() returned by the previous delivery
  std::int64_t opened_ns_ = 0;
  std::uint64_t delivered_ = 0;
};

Delivery BytesFile::take(std::int64_t until_ns) noexcept {
  file_.consume(std::exchange(held_, 0));
  const std::size_t wanted = recorded() ? block_ : 1;
  while (file_.unread().size() < wanted && fill(until_ns)) {
  }
  std::size_t n = file_.unread().size();
  if (n == 0 || (n < wanted && !at_end_)) return {};
  if (recorded()) {
    n = std::min(n, block_);
    if (!await(recorded_ns(delivered_ + n), until_ns)) return {};
  }
  held_ = n;
  delivered_ += n;
  Delivery delivery;
  delivery.bytes = file_.unread().first(n);
  if (recorded() || settings_.bytes_per_second <= 0.0)
    delivery.arrival_ns = delivery.read_ns = arrival_clock_ns();
  else
    delivery.arrival_ns = opened_ns_ + recorded_ns(delivered_);
  return delivery;
}

class CandumpFile final : public FileTransport {
 public:
  using FileTransport::FileTransport;

 private:
  void begin() noexcept override {
    line_ = 0;
    pending_ = false;
    overlong_ = false;
    shift_ns_ = 0;
    clock_ = CandumpClock();
    buses_ = CandumpBuses();
    refused_ = false;
  }
  Delivery take(std::int64_t until_ns) noexcept override;
  bool next_frame(std::int64_t until_ns) noexcept;
  bool wanted(const CandumpEntry& entry) const noexcept;
  bool of_one_device() noexcept;
  bool next_line(std::string_view& line, std::int64_t until_ns) noexcept;

  CandumpEntry entry_;
  CandumpClock clock_;
  CandumpBuses buses_;
  bool refused_ = false;   // frames of two devices with one id: reading has ended
  bool pending_ = false;   // entry_ was read but not delivered
  bool overlong_ = false;  // within a line longer than the buffer, already reported
  std::uint64_t line_ = 0;
  std::int64_t shift_ns_ = 0;  // from the clock of deadlines to that of arrival times
  std::array<ifog_can_frame, kBatch> batch_{};
};

bool CandumpFile::wanted(const CandumpEntry& entry) const noexcept {
  if (!settings_.interface.empty() && entry.interface != settings_.interface) return false;
  if (settings_.ids.empty()) return true;
  const bool extended = (entry.frame.flags & IFOG_CAN_EXTENDED) != 0;
  return std::any_of(settings_.ids.begin(), settings_.ids.end(),
                     [&](const CanId& id) { return id.id == entry.frame.id && id.extended == extended; });
}

// True if no frame with entry_'s id came from another interface.
bool CandumpFile::of_one_device() noexcept {
  const std::string_view other = buses_.other(entry_.frame, entry_.interface);
  if (other.empty()) return true;
  std::array<char, 60> both{};
  const int n =
      std::snprintf(both.data(), both.size(), "%.*s and %.*s", static_cast<int>(other.size()), other.data(),
                    static_cast<int>(entry_.interface.size()), entry_.interface.data());
  report(
      "frames of one id come on two interfaces, as from two devices, and nothing more is read; expected "
      "sensor.transport.interface with one of them",
      line_, {both.data(), std::min(static_cast<std::size_t>(n), both.size() - 1)});
  refused_ = true;
  return false;
}

// The line stays valid until the next fill().
bool CandumpFile::next_line(std::string_view& line, std::int64_t until_ns) noexcept {
  for (;;) {
    const std::span<const std::uint8_t> bytes = file_.unread();
    const auto* text = reinterpret_cast<const char*>(bytes.data());
    const auto* newline =
        bytes.empty() ? nullptr : static_cast<const char*>(std::memchr(text, '\n', bytes.size()));
    if (newline == nullptr && bytes.size() == ByteFile::kCapacity) {
      if (!std::exchange(overlong_, true))
        report("a line of more than 64 KiB, this is no candump log", line_ + 1);
      file_.consume(bytes.size());
    } else if (newline != nullptr || (at_end_ && !bytes.empty())) {
      const std::size_t length = newline != nullptr ? static_cast<std::size_t>(newline - text) : bytes.size();
      ++line_;
      file_.consume(newline != nullptr ? length + 1 : length);
      if (std::exchange(overlong_, false)) continue;
      line = {text, length};
      return true;
    } else if (!fill(until_ns) && !(at_end_ && !file_.unread().empty())) {
      return false;
    }
  }
}

bool CandumpFile::next_frame(std::int64_t until_ns) noexcept {
  std::string_view line;
  while (!pending_ && !refused_ && next_line(line, until_ns)) {
    const CandumpLine kind = parse_candump_line(line, entry_);
    if (kind != CandumpLine::blank && kind != CandumpLine::malformed && kind != CandumpLine::drops) {
      const bool known = clock_.differences();
      entry_.frame.arrival_ns = clock_.time_ns(entry_);
      if (clock_.differences() != known)
        report("times are differences (candump -t d), expected -t a or -t z", line_);
    }
    switch (kind) {
      case CandumpLine::frame:
        pending_ = wanted(entry_) && of_one_device();
        break;
      case CandumpLine::error:
        counters_.error_frames.add(1);
        break;
      case CandumpLine::malformed:
        report(at_end_ && file_.unread().empty() ? "the log is cut off here" : kCandumpExpected, line_, line);
        break;
      case CandumpLine::drops:
        if (settings_.interface.empty() || entry_.interface == settings_.interface)
          counters_.kernel_drops.add(entry_.dropped);
        break;
      case CandumpLine::remote:
      case CandumpLine::blank:
        break;
    }
  }
  return pending_;
}

Delivery CandumpFile::take(std::int64_t until_ns) noexcept {
  std::size_t n = 0;
  while (n < batch_.size()) {
    // After the first frame only available data are added.
    const std::int64_t until = n == 0 ? until_ns : monotonic_ns();
    if (!next_frame(until)) break;
    const bool timed = entry_.stamp != CandumpStamp::none;
    if (recorded() && timed) {
      if (!pace_.started()) shift_ns_ = arrival_clock_ns() - monotonic_ns();
      if (!await(entry_.frame.arrival_ns, until)) break;
    }
    batch_[n] = entry_.frame;
    if (recorded() && timed) batch_[n].arrival_ns = pace_.due_ns(entry_.frame.arrival_ns) + shift_ns_;
    if (!timed) batch_[n].arrival_ns = arrival_clock_ns();
    ++n;
    pending_ = false;
  }
  if (n == 0 && refused_) end(0);
  Delivery delivery;
  delivery.frames = std::span<const ifog_can_frame>(batch_).first(n);
  return delivery;
}

}  // namespace

std::unique_ptr<Transport> make_file_transport(FileSettings settings) {
  if (settings.format == FileSettings::Format::bytes) return std::make_unique<BytesFile>(std::move(settings));
  return std::make_unique<CandumpFile>(std::move(settings));
}

}  // namespace ifog
