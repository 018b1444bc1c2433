// SPDX-License-Identifier: Apache-2.0
#include "drivers/flight/archive.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string_view>
#include <system_error>
#include <utility>

namespace ifog {
namespace {

constexpr std::string_view kEnding = ".ifr", kOpen = ".open";
// A computer without a battery-backed clock starts in 1970: files written then have an unknown age.
constexpr std::int64_t kClockIsSet_ns = 1'577'836'800LL * 1'000'000'000;  // 2020-01-01

std::uint64_t random_number() {
  std::uint64_t out = 0;
  // Without it the checksums do not detect a recording within a recording.
  if (getrandom(&out, sizeof out, GRND_NONBLOCK) != sizeof out) out = 0;
  return out;
}

std::string file_name(std::uint64_t number, std::int64_t wall_ns) {
  const std::time_t seconds = wall_ns / 1'000'000'000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> date{};
  std::strftime(date.data(), date.size(), "%Y%m%dT%H%M%SZ", &utc);
  std::array<char, 64> name{};
  std::snprintf(name.data(), name.size(), "%08llu-%s%s", static_cast<unsigned long long>(number), date.data(),
                kEnding.data());
  return name.data();
}

// Larger numbers are not from a recorder.
constexpr std::uint64_t kMostFiles = 1'000'000'000'000;

// Number in a file name of this class; 0 for others.
std::uint64_t number_of(std::string_view name) {
  if (!name.ends_with(kEnding)) return 0;
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  const bool made_here = error == std::errc() && end != name.data() + name.size() && *end == '-';
  return made_here && number < kMostFiles ? number : 0;
}

}  // namespace

FlightArchive::FlightArchive(std::unique_ptr<FlightFolder> folder, ArchiveLimits limits, FlightHeader header)
    : folder_(std::move(folder)), limits_(limits), header_(std::move(header)) {
  header_.run = random_number();
}

FlightArchive::~FlightArchive() { close(now_ns_, wall_ns_); }

void FlightArchive::add(const FlightEntryHead& head, std::span<const std::uint8_t> payload,
                        bool begins_delivery) {
  append_entry(waiting_.bytes, head, payload);
  ++waiting_.entries;
  if (head.is_received()) waiting_.load += {begins_delivery ? 1U : 0U, payload.size()};
}

std::string FlightArchive::complaint() const {
  if (error_ == EBUSY) return "another recorder writes into it (expected a folder of its own)";
  const std::string words = std::generic_category().message(error_);
  const bool full = error_ == ENOSPC || error_ == EDQUOT || error_ == EFBIG;
  return full ? words : words + " (expected a folder that can be written)";
}

// Reads the folder and closes files left open by a killed recorder.
int FlightArchive::look() {
  std::vector<FlightFolder::File> files;
  if (const int error = folder_->list(files); error != 0) return error;
  // Known ages are kept, as the wall clock may have been set.
  std::map<std::string, std::int64_t> known;
  for (const Kept& file : kept_.files) known[file.name] = file.last_ns;
  if (!file_.name.empty()) known[file_.name] = now_ns_;
  kept_.files.clear();
  kept_.bytes = 0;
  for (FlightFolder::File& file : files) {
    std::string name = file.name;
    if (name.ends_with(kOpen)) {
      name.resize(name.size() - kOpen.size());
      if (number_of(name) == 0) continue;
      kept_.next_number = std::max(kept_.next_number, number_of(name) + 1);
      if (folder_->take_over(file.name, name) != 0) continue;
    }
    const std::uint64_t number = number_of(name);
    if (number == 0) continue;
    kept_.next_number = std::max(kept_.next_number, number + 1);
    const std::int64_t age_ns =
        file.modified_ns < kClockIsSet_ns ? 0 : std::max<std::int64_t>(0, wall_ns_ - file.modified_ns);
    const auto found = known.find(name);
    const std::int64_t last_ns = found != known.end() ? found->second : now_ns_ - age_ns;
    kept_.files.push_back({number, std::move(name), file.bytes, last_ns});
    kept_.bytes += file.bytes;
  }
  std::ranges::sort(kept_.files, [](const Kept& a, const Kept& b) { return a.number < b.number; });
  kept_.known = true;
  return 0;
}

int FlightArchive::write(BlockType type, std::span<const std::uint8_t> content) {
  std::vector<std::uint8_t> block;
  const BlockPlace place = type == BlockType::header ? BlockPlace{} : BlockPlace{header_.file, file_.bytes};
  append_block(block, type, place, content, deflater_);
  // Space is freed before it is used, so the limit is never exceeded.
  while (!kept_.files.empty() && kept_.bytes + file_.bytes + block.size() > limits_.bytes)
    if (const int error = remove_oldest(); error != 0) return error;
  const int error = folder_->append(block);
  if (error != 0) return error;
  file_.bytes += block.size();
  bytes_written_ += block.size();
  return 0;
}

int FlightArchive::begin_file() {
  if (!kept_.known)
    if (const int error = look(); error != 0) return error;
  if (next_header_) {
    next_header_->run = header_.run;
    header_ = *std::exchange(next_header_, std::nullopt);
  }
  header_.file = random_number();
  header_.number = kept_.next_number;
  header_.began = began_ != 0 ? began_ : kept_.next_number;
  header_.opened_ns = wall_ns_;
  file_.name = file_name(kept_.next_number, wall_ns_);
  if (const int error = folder_->begin(file_.name + std::string(kOpen)); error != 0) {
    if (error == EEXIST) ++kept_.next_number;
    kept_.known = false;
    return error;
  }
  file_.bytes = file_.entries = 0;
  file_.since_ns = now_ns_;
  std::vector<std::uint8_t> state;
  for (const auto& [key, entry] : state_) state.insert(state.end(), entry.begin(), entry.end());
  int error = write(BlockType::header, header_payload(header_));
  if (error == 0 && !state.empty()) error = write(BlockType::data, state);
  if (error != 0) {
    // It contains nothing useful, and its number is free again.
    folder_->leave();
    folder_->remove(file_.name + std::string(kOpen));
    file_.bytes = 0;
    return error;
  }
  file_.entries = state_.size();
  file_.open = true;
  file_.load = {};
  began_ = header_.began;
  ++kept_.next_number;
  return 0;
}

int FlightArchive::end_file(bool run_goes_on) {
  const std::array<std::uint64_t, 3> summary{file_.entries, static_cast<std::uint64_t>(wall_ns_),
                                             run_goes_on ? 1U : 0U};
  std::array<std::uint8_t, sizeof summary> bytes{};
  std::memcpy(bytes.data(), summary.data(), sizeof summary);
  // On an error the file is like that of a killed writer: complete up to its last block.
  int error = write(BlockType::end, bytes);
  if (error == ENOENT) {
    forget_file();
    return error;
  }
  if (const int finished = folder_->finish(file_.name); error == 0) error = finished;
  file_.open = false;
  file_.bytes = 0;
  // Files may have been removed or added meanwhile; one that could not be renamed is adopted.
  kept_.known = false;
  if (const int looked = look(); error == 0) error = looked;
  return error;
}

// The open file was removed with its contents.
void FlightArchive::forget_file() {
  folder_->leave();
  lost_.with_files += std::exchange(file_.load, {});
  file_.open = kept_.known = false;
  file_.bytes = 0;
}

// The next file starts with the waiting state entries.
void FlightArchive::remember_state() {
  std::span<const std::uint8_t> rest = waiting_.bytes;
  FlightEntry entry;
  for (const std::uint8_t* at = rest.data(); take_entry(rest, entry); at = rest.data())
    if (entry.head.kind == FlightKind::channel || entry.head.kind == FlightKind::wall)
      state_[{entry.head.kind, entry.head.index}].assign(at, at + sizeof entry.head + entry.head.length);
}

bool FlightArchive::file_is_full() const {
  return file_.open && (next_header_.has_value() || file_.bytes >= limits_.file_bytes ||
                        now_ns_ - file_.since_ns >= limits_.file_ns);
}

int FlightArchive::write_waiting() {
  if (!file_.open)
    if (const int error = begin_file(); error != 0) return error;
  int error = write(BlockType::data, waiting_.bytes);
  if (error == ENOENT) {
    forget_file();
    error = begin_file();
    if (error == 0) error = write(BlockType::data, waiting_.bytes);
  }
  if (error == EBADF)
    file_.open = kept_.known = false;  // an incomplete block could not be removed: use another file
  if (error != 0) return error;
  file_.entries += waiting_.entries;
  if (header_.carries != FlightHeader::Carries::messages) remember_state();
  waiting_.bytes.clear();
  waiting_.entries = 0;
  file_.load += std::exchange(waiting_.load, {});
  waiting_.since_ns = -1;
  return 0;
}

int FlightArchive::remove_oldest() {
  const int error = folder_->remove(kept_.files.front().name);
  if (error != 0 && error != ENOENT) return error;
  kept_.bytes -= kept_.files.front().bytes;
  kept_.files.pop_front();
  ++kept_.removed;
  return 0;
}

// Prepares files before a write; returns 0 or the disk's error.
int FlightArchive::tidy() {
  if (!kept_.known)
    if (const int error = look(); error != 0) return error;
  // Starts the next file, except for a sensor that is silent.
  const bool silent = now_ns_ - file_.since_ns >= limits_.file_ns + limits_.flush_ns;
  if (file_is_full() && (!waiting_.bytes.empty() || silent))
    if (const int error = end_file(!waiting_.bytes.empty()); error != 0 && error != ENOENT) return error;
  while (!kept_.files.empty() && now_ns_ - kept_.files.front().last_ns > limits_.age_ns)
    if (const int error = remove_oldest(); error != 0) return error;
  return 0;
}

void FlightArchive::turn(std::int64_t now_ns, std::int64_t wall_ns, bool flush) {
  // After an error the disk is tried once a second.
  if (error_ != 0 && !flush && now_ns - now_ns_ < limits_.flush_ns) return;
  now_ns_ = now_ns;
  wall_ns_ = wall_ns;
  const int tidied = tidy();
  if (tidied != 0) error_ = tidied;
  if (waiting_.bytes.empty()) return;
  if (waiting_.since_ns < 0) waiting_.since_ns = now_ns;
  if (error_ == 0 && !flush && !full() && now_ns - waiting_.since_ns < limits_.flush_ns) return;
  const int written = write_waiting();
  error_ = written != 0 ? written : tidied;
}

std::uint64_t FlightArchive::close(std::int64_t now_ns, std::int64_t wall_ns) {
  if (!file_.open && waiting_.bytes.empty()) return 0;  // leaves the folder alone, which may not exist
  turn(now_ns, wall_ns, true);
  // A full disk may still have space for the small end; the error is that of the data.
  if (file_.open)
    if (const int ended = end_file(false); waiting_.entries == 0) error_ = ended;
  waiting_.bytes.clear();
  lost_.waiting += std::exchange(waiting_.load, {});
  return std::exchange(waiting_.entries, 0);
}

}  // namespace ifog
