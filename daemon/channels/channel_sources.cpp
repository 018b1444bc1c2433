// SPDX-License-Identifier: Apache-2.0
#include "daemon/channels/channel_sources.h"

#include <fcntl.h>
#include <lcm/lcm.h>
#include <linux/magic.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>
#include <variant>

#include "daemon/channels/can_channel.h"
#include "daemon/channels/lcm_field.h"
#include "daemon/sensor/facts.h"
#include "drivers/ifog/decimal.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/fd.h"
#include "drivers/transport/can/can.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/stoppable_wait.h"
#include "filters/chain/plausibility.h"

namespace ifog {
namespace {

constexpr auto kSourceTurn = std::chrono::milliseconds(250);

// Writes a channel's values into the sensor's table: scaled, or rejected if impossible.
class Entrance {
 public:
  explicit Entrance(ChannelSources::Wanted wanted)
      : wanted_(std::move(wanted)),
        plausible_(channel_limits(wanted_.config.name, wanted_.config.limits), kMostChannel) {}
  [[nodiscard]] const ChannelConfig& config() const { return wanted_.config; }
  [[nodiscard]] const std::shared_ptr<ChannelTable>& table() const { return wanted_.table; }

  // again: the last reading was received again. It confirms nothing and is counted once. True: the value is
  // accepted.
  bool put(double number, std::int64_t time_ns, bool again = false) {
    const double value = number * wanted_.config.scale + wanted_.config.offset;
    again = again && value == last_;
    if (!again) good_ = plausible_.take(value);
    last_ = value;
    const ChannelFault fault{.kind = ChannelFault::Kind::impossible};
    if (good_)
      wanted_.table->set(wanted_.index, value, time_ns);
    else if (again)
      wanted_.table->miss(wanted_.index, fault);
    else
      refuse(fault);
    return good_;
  }
  // Rejects the reading.
  void refuse(const ChannelFault& fault) { wanted_.table->refuse(wanted_.index, fault); }
  // Counted if something other than a number was received; a missing or empty file is not counted.
  void miss(const ChannelFault& fault) {
    if (fault.kind == ChannelFault::Kind::no_number)
      refuse(fault);
    else
      wanted_.table->miss(wanted_.index, fault);
  }

 private:
  ChannelSources::Wanted wanted_;
  PlausibleValue plausible_;
  double last_ = 0.0;
  bool good_ = false;  // last_ is valid
};

// Identifies a version of a file; nothing for files that are generated at each read (sysfs, procfs).
using FileWriting = std::optional<std::tuple<dev_t, ino_t, std::int64_t>>;

FileWriting writing_of(int fd, const struct stat& info) {
  struct statfs system {};
  if (fstatfs(fd, &system) != 0) return std::nullopt;
  const auto type = static_cast<unsigned long>(system.f_type);
  if (type == SYSFS_MAGIC || type == PROC_SUPER_MAGIC || type == DEBUGFS_MAGIC) return std::nullopt;
  return {{info.st_dev, info.st_ino, info.st_mtim.tv_sec * 1'000'000'000LL + info.st_mtim.tv_nsec}};
}

// The single number in a file (hwmon, thermal zones, IIO), or the reason why there is none. Blanks and line ends
// may surround it; other characters make it invalid, such as "21,5". Never blocks: a FIFO would delay all other
// channels and the daemon's end.
std::variant<double, ChannelFault> read_number_file(const std::string& path, FileWriting& writing) {
  using Kind = ChannelFault::Kind;
  writing.reset();
  const Fd fd(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
  if (fd < 0) return ChannelFault{.kind = Kind::unreadable, .error = errno};
  struct stat info {};
  if (fstat(fd, &info) != 0 || !S_ISREG(info.st_mode)) return ChannelFault{.kind = Kind::no_file};
  writing = writing_of(fd, info);
  std::array<char, 128> buffer{};
  const ssize_t length = ::read(fd, buffer.data(), buffer.size());
  if (length < 0) return ChannelFault{.kind = Kind::unreadable, .error = errno};
  std::string_view text(buffer.data(), static_cast<std::size_t>(length));
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t from = text.find_first_not_of(kBlank);
  if (from == std::string_view::npos) return ChannelFault{.kind = Kind::empty};
  // Too long for a number; its end would be missing.
  if (text.size() == buffer.size()) return ChannelFault{.kind = Kind::no_number};
  text = text.substr(from, text.find_last_not_of(kBlank) - from + 1);
  double number = 0.0;
  const auto [end, error] = read_decimal(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return ChannelFault{.kind = Kind::no_number};
  return number;
}

class FileChannel {
 public:
  explicit FileChannel(ChannelSources::Wanted wanted) : in_(std::move(wanted)) {}
  [[nodiscard]] const ChannelConfig& config() const { return in_.config(); }
  [[nodiscard]] std::int64_t due_ns() const { return due_ns_; }
  void read(std::int64_t now_ns) {
    due_ns_ = now_ns + static_cast<std::int64_t>(in_.config().period_s * 1e9);
    const FileWriting before = writing_;
    const auto read = read_number_file(in_.config().path, writing_);
    if (const double* const number = std::get_if<double>(&read))
      in_.put(*number, arrival_clock_ns(), writing_ && writing_ == before);
    else
      in_.miss(std::get<ChannelFault>(read));
  }

 private:
  Entrance in_;
  std::int64_t due_ns_ = 0;
  FileWriting writing_;
};

// LCM interprets names as regular expressions, so special characters are escaped.
std::string as_written(const std::string& name) {
  std::string out;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') out += '\\';
    out += c;
  }
  return out;
}

// One LCM channel and its field.
class LcmChannel {
 public:
  explicit LcmChannel(ChannelSources::Wanted wanted)
      : in_(std::move(wanted)), field_(in_.config().field.empty() ? in_.config().name : in_.config().field) {}
  [[nodiscard]] const std::string& lcm_channel() const { return in_.config().lcm_channel; }

  void take(const lcm_recv_buf_t& message) {
    double value = 0.0;
    std::int64_t utime = 0;
    const std::span bytes(static_cast<const std::uint8_t*>(message.data), message.data_size);
    if (!field_.read(bytes, value, utime)) {
      if (is_message(bytes))
        in_.miss({.kind = ChannelFault::Kind::no_field});
      else
        in_.refuse({.kind = ChannelFault::Kind::no_message});
      return;
    }
    const bool dated = utime > 0 && utime < INT64_MAX / 1000;
    const std::int64_t now_ns = realtime_ns(), measured_ns = (dated ? utime : message.recv_utime) * 1000;
    // A last value dated in the future shows that a clock was set back.
    if (dated && held_ns_ > 0 && held_ns_ <= now_ns && measured_ns < held_ns_ - kSameTime_ns)
      return in_.refuse({.kind = ChannelFault::Kind::late});
    const bool again = dated && last_ns_ > 0 && std::abs(measured_ns - last_ns_) <= kSameTime_ns;
    if (dated && !again) last_ns_ = measured_ns;
    // A measurement dated in the future counts from its first reception; otherwise it would never become old.
    // A rejected value is not stored, whatever its date.
    if (!again) at_ns_ = arrival_clock_ns() - age_ns(now_ns - measured_ns, dated);
    const bool held = in_.put(value, at_ns_, again);
    if (held && dated && !again) held_ns_ = measured_ns;
    if (held && behind_ns_ > kBehind_ns)
      in_.miss(
          {.kind = ChannelFault::Kind::clock_behind, .error = static_cast<int>(behind_ns_ / kSecond_ns)});
  }

 private:
  // A status contains ages, from which the time is recovered to within rounding.
  static constexpr std::int64_t kSameTime_ns = 2'000;
  static constexpr std::int64_t kSecond_ns = 1'000'000'000, kBehind_ns = kSecond_ns;
  static constexpr std::int64_t kFollows_ns = 1'000'000;  // per message; the estimate follows clock drift

  // Age of a measurement. If new values all have a large age, the sender's clock is behind: the smallest age
  // is that of the clock.
  std::int64_t age_ns(std::int64_t by_date_ns, bool dated) noexcept {
    if (!dated) return std::max<std::int64_t>(0, by_date_ns);
    const std::int64_t least_ns = std::min(by_date_ns, least_ns_ + kFollows_ns);
    behind_ns_ = std::exchange(dated_before_, true) ? least_ns : 0;
    least_ns_ = dated_before_ && behind_ns_ != 0 ? least_ns : by_date_ns;
    return std::max<std::int64_t>(0, by_date_ns - (behind_ns_ > kBehind_ns ? behind_ns_ : 0));
  }

  Entrance in_;
  LcmField field_;
  std::int64_t last_ns_ = 0,
               held_ns_ = 0;  // by its own clock, of the last value and the stored one; 0: unknown
  std::int64_t at_ns_ = 0;    // of the last one, arrival clock
  std::int64_t least_ns_ = 0, behind_ns_ = 0;  // smallest age by date, of new values; lag of the clock
  bool dated_before_ = false;
};

// All signals of one CAN interface.
struct CanGroup {
  std::vector<std::pair<Entrance, CanChannel>> channels;
  std::unique_ptr<Transport> transport;
  std::uint64_t drops = 0;  // kernel drops reported to the sensors so far

  void listen() {
    while (!transport->stopped()) {
      const Delivery delivery = transport->read(kSourceTurn);
      for (const ifog_can_frame& frame : delivery.frames)
        for (auto& [in, channel] : channels)
          if (double value = 0.0; channel.decode(frame, value)) in.put(value, frame.arrival_ns);
      tell_drops();
    }
    transport->close_books();
    tell_drops();
  }
  // Once per sensor, regardless of its number of channels on this bus.
  void tell_drops() {
    const std::uint64_t now = transport->counters().kernel_drops;
    if (now == drops) return;
    std::set<ChannelTable*> tables;
    for (const auto& [in, channel] : channels) tables.insert(in.table().get());
    for (ChannelTable* const table : tables) table->lose(now - drops);
    drops = now;
  }
};

}  // namespace

struct ChannelSources::Impl {
  std::vector<FileChannel> files;
  std::vector<LcmChannel> messages;
  std::map<std::string, CanGroup> buses;
  std::string lcm_url;
  lcm_t* lcm = nullptr;
  StoppableWait waiting;
  std::vector<std::thread> threads;

  ~Impl() {
    if (lcm != nullptr) lcm_destroy(lcm);
  }

  static void received(const lcm_recv_buf_t* message, const char* channel, void* user) {
    for (LcmChannel& one : static_cast<Impl*>(user)->messages)
      if (one.lcm_channel() == channel) one.take(*message);
  }

  // Throws std::runtime_error if LCM cannot use the URL now.
  void subscribe() {
    if (lcm != nullptr) lcm_destroy(lcm);
    lcm = lcm_create(lcm_url.c_str());
    if (lcm == nullptr)
      throw std::runtime_error("lcm_url = \"" + printable(lcm_url) + "\": LCM cannot use it");
    std::vector<std::string> names;
    for (const LcmChannel& one : messages) names.push_back(one.lcm_channel());
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    for (const std::string& name : names) lcm_subscribe(lcm, as_written(name).c_str(), &Impl::received, this);
  }

  void listen() {
    constexpr std::int64_t kAgain_ns = 5'000'000'000;
    std::int64_t again_ns = monotonic_ns() + kAgain_ns;
    for (;;) {
      const std::int64_t now_ns = monotonic_ns();
      std::int64_t next_ns = now_ns + 3'600'000'000'000;
      for (FileChannel& file : files) {
        if (file.due_ns() <= now_ns) file.read(now_ns);
        next_ns = std::min(next_ns, file.due_ns());
      }
      // Without a descriptor, the server of tcpq:// is away. LCM itself would wait for it in lcm_handle().
      const int socket = lcm != nullptr ? lcm_get_fileno(lcm) : -1;
      const bool away = socket < 0 && !messages.empty();
      if (away) next_ns = std::min(next_ns, again_ns);
      const StoppableWait::Wake wake = waiting.wait(socket, POLLIN, next_ns);
      if (wake == StoppableWait::Wake::stopped) return;
      if (wake == StoppableWait::Wake::ready) lcm_handle(lcm);
      if (!away || monotonic_ns() < again_ns) continue;
      again_ns = monotonic_ns() + kAgain_ns;
      try {
        subscribe();
      } catch (const std::exception&) {  // tried again later
      }
    }
  }
};

ChannelSources::ChannelSources(std::vector<Wanted> wanted, const std::string& lcm_url,
                               const CanOpener& make_can)
    : impl_(std::make_unique<Impl>()) {
  impl_->lcm_url = lcm_url;
  for (Wanted& one : wanted) {
    switch (one.config.source) {
      case ChannelConfig::Source::frame:
        break;
      case ChannelConfig::Source::file:
        impl_->files.emplace_back(std::move(one));
        break;
      case ChannelConfig::Source::lcm:
        impl_->messages.emplace_back(std::move(one));
        break;
      case ChannelConfig::Source::can: {
        CanChannel channel(one.config);
        auto& on_the_bus = impl_->buses[one.config.interface].channels;
        on_the_bus.emplace_back(Entrance(std::move(one)), std::move(channel));
        break;
      }
    }
  }
  for (auto& [interface, bus] : impl_->buses) {
    CanSettings settings;
    settings.interface = interface;
    for (const auto& [one, channel] : bus.channels) settings.ids.push_back(channel.id());
    bus.transport = make_can(settings);
  }
}

ChannelSources::~ChannelSources() { stop(); }

void ChannelSources::start() {
  if (!impl_->messages.empty()) impl_->subscribe();
  if (!impl_->files.empty() || !impl_->messages.empty())
    impl_->threads.emplace_back([impl = impl_.get()] { impl->listen(); });
  for (auto& [interface, bus] : impl_->buses) {
    try {
      bus.transport->open({});
    } catch (const std::exception&) {
      // read() keeps trying; meanwhile the channel is stale, which is flagged.
    }
    impl_->threads.emplace_back([group = &bus] { group->listen(); });
  }
}

void ChannelSources::stop() {
  impl_->waiting.stop();
  for (auto& [interface, bus] : impl_->buses) bus.transport->stop();
  for (std::thread& thread : impl_->threads) thread.join();
  impl_->threads.clear();
}

}  // namespace ifog
