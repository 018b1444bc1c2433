// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/lcm/lcm_events.h"

#include <algorithm>
#include <array>
#include <boost/endian/conversion.hpp>
#include <cerrno>
#include <cstring>
#include <lcm/lcm-cpp.hpp>
#include <string_view>

#include "drivers/capture/recording.h"
#include "tools/ifog/captures/flight/flight_input.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic{0xED, 0xA1, 0xDA, 0x01};
constexpr std::size_t kHead = 28;
// LCM_MAX_CHANNEL_NAME_LENGTH is 63. LCM's limit of 2^16 fragments would allow messages of 4 GB.
constexpr std::int32_t kLongestName = 255, kLongestData = 1 << 28;
constexpr std::size_t kBlock = std::size_t{1} << 16U;

}  // namespace

std::int64_t type_hash(std::span<const std::uint8_t> message) {
  return message.size() < sizeof(std::int64_t) ? 0 : boost::endian::load_big_s64(message.data());
}

LcmEvents::LcmEvents(const std::string& path) : path_(path), file_(std::fopen(path.c_str(), "rb")) {
  if (!file_) throw refusal("{}: cannot open as an LCM log: {}", path, std::strerror(errno));
  fseeko(file_.get(), 0, SEEK_END);
  size_ = static_cast<std::size_t>(std::max<off_t>(0, ftello(file_.get())));
  std::rewind(file_.get());
}

const LcmEvents::Event* LcmEvents::next() {
  const std::size_t before = at_;
  // Normally the next event begins here.
  for (std::optional<std::size_t> begin = before; begin; begin = magic_in(*begin + 1, size_)) {
    if (!read_event(*begin)) continue;
    if (*begin > before) {
      if (places_++ == 0) first_place_ = before;
      damaged_ += *begin - before;
    }
    return &event_;
  }
  return nullptr;
}

bool LcmEvents::read_event(std::size_t from) {
  std::span<const std::uint8_t> bytes = window(from, kHead);
  if (bytes.size() < kHead || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) return false;
  const std::int32_t name = boost::endian::load_big_s32(&bytes[20]);
  const std::int32_t data = boost::endian::load_big_s32(&bytes[24]);
  if (name < 1 || name > kLongestName || data < 0 || data > kLongestData) return false;
  const std::size_t name_bytes = static_cast<std::size_t>(name);
  const std::size_t whole = kHead + name_bytes + static_cast<std::size_t>(data), end = from + whole;
  if (end > size_) return false;
  bytes = window(from, whole + kMagic.size());
  // If no event follows, this one or its lengths are damaged.
  if (bytes.size() < whole ||
      !std::equal(bytes.begin() + static_cast<std::ptrdiff_t>(whole), bytes.end(), kMagic.begin()))
    return false;
  bytes = bytes.first(whole);
  event_.number = boost::endian::load_big_s64(&bytes[4]);
  event_.timestamp_us = boost::endian::load_big_s64(&bytes[12]);
  event_.channel.assign(bytes.begin() + kHead,
                        bytes.begin() + static_cast<std::ptrdiff_t>(kHead + name_bytes));
  event_.data = bytes.subspan(kHead + name_bytes);
  at_ = end;
  return true;
}

std::optional<std::size_t> LcmEvents::magic_in(std::size_t from, std::size_t to) {
  while (from + kMagic.size() <= to) {
    const std::span<const std::uint8_t> bytes = window(from, std::min(kBlock, to - from));
    const auto found = std::search(bytes.begin(), bytes.end(), kMagic.begin(), kMagic.end());
    if (found != bytes.end()) return from + static_cast<std::size_t>(found - bytes.begin());
    if (bytes.size() < kMagic.size()) break;
    from += bytes.size() - (kMagic.size() - 1);  // the magic may cross the border of two blocks
  }
  return std::nullopt;
}

std::span<const std::uint8_t> LcmEvents::window(std::size_t from, std::size_t bytes) {
  const std::size_t read_to = read_from_ + read_.size();
  if (from < read_from_ || from + bytes > read_to) {
    if (from < read_from_ || from > read_to)
      read_.clear();
    else
      read_.erase(read_.begin(), read_.begin() + static_cast<std::ptrdiff_t>(from - read_from_));
    read_from_ = from;
    const std::size_t kept = read_.size(), wanted = std::max(bytes, kBlock);
    read_.resize(wanted);
    if (fseeko(file_.get(), static_cast<off_t>(from + kept), SEEK_SET) != 0) fail();
    read_.resize(kept + std::fread(read_.data() + kept, 1, wanted - kept, file_.get()));
    if (std::ferror(file_.get()) != 0) fail();
  }
  const std::span<const std::uint8_t> all(read_);
  return all.subspan(from - read_from_, std::min(bytes, all.size() - (from - read_from_)));
}

void LcmEvents::fail() const { throw refusal("{}: {}", path_, std::strerror(errno)); }

void LcmEvents::say_damage(const std::string& path) const {
  if (places_ > 0)
    warn(
        "{}: {} bytes in {} place(s) are no messages and are dropped, the first from byte {} on (is the "
        "file damaged?)\n",
        path, damaged_, places_, first_place_);
  if (size_ > at_)
    warn("{}: its last {} bytes are no whole message (is the file cut off?)\n", path, size_ - at_);
}

NamedLog::NamedLog(InputFile& file) : name_(file.path()) {
  const bool recorded = recorded_messages(file);
  if (file.reopens() && !recorded) return;
  unpacked_.emplace();
  name_ = "/proc/self/fd/" + std::to_string(unpacked_->descriptor());
  if (recorded) {
    unpack_messages(file);
    return;
  }
  std::vector<char> block(std::size_t{1} << 20U);
  for (std::size_t n = 0, at = 0; (n = file.read(block.data(), block.size())) > 0; at += n)
    unpacked_->write(at, block.data(), n);
}

void NamedLog::unpack_messages(InputFile& file) const {
  FlightInput flight(file);
  lcm::LogFile log(name_, "w");
  flight.for_each_entry([&](const FlightEntry& entry) {
    if (entry.head.kind != FlightKind::message || entry.head.index > entry.payload.size()) return;
    std::vector<std::uint8_t> data(entry.payload.begin() + entry.head.index, entry.payload.end());
    lcm::LogEvent event{};
    event.timestamp = entry.head.time_ns / 1000;
    event.channel.assign(reinterpret_cast<const char*>(entry.payload.data()), entry.head.index);
    event.datalen = static_cast<int>(data.size());
    event.data = data.data();
    if (log.writeEvent(&event) != 0) UnnamedFile::fail("cannot write");
  });
}

bool recorded_messages(const InputFile& file) {
  // The header's keys have the order in drivers/flight/format.md, and no value contains a line break.
  return file_kind(file) == FileKind::flight &&
         file.head().find("\ncarries=messages\n") != std::string_view::npos;
}

}  // namespace ifog::tools
