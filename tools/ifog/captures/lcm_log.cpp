#include "tools/ifog/captures/lcm_log.h"

#include <ifog/decode.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <set>
#include <stdexcept>
#include <vector>

#include "drivers/ifog/quoted.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

bool carries_rates(const std::string& channel) {
  return channel.starts_with("IFOG_") && !channel.ends_with("_STATUS");
}

// LCM reads a log by its name and from any place in it. One that comes packed or through a pipe is kept in
// memory, under a name that only this process knows.
class NamedLog {
 public:
  explicit NamedLog(InputFile& file) : name_(file.path()) {
    if (file.reopens()) return;
    fd_ = memfd_create("lcm log", MFD_CLOEXEC);
    if (fd_ < 0) throw std::runtime_error(name_ + ": no memory to unpack it");
    name_ = "/proc/self/fd/" + std::to_string(fd_);
    std::vector<char> block(1U << 20U);
    while (const std::size_t n = file.read(block.data(), block.size()))
      for (std::size_t done = 0; done < n;) {
        const ssize_t wrote = ::write(fd_, block.data() + done, n - done);
        if (wrote < 0 && errno != EINTR) {
          ::close(fd_);
          throw std::runtime_error(file.path() + ": no memory to unpack it");
        }
        done += static_cast<std::size_t>(std::max<ssize_t>(wrote, 0));
      }
  }
  ~NamedLog() {
    if (fd_ >= 0) ::close(fd_);
  }
  NamedLog(const NamedLog&) = delete;
  NamedLog& operator=(const NamedLog&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
  int fd_ = -1;
};

std::string chosen_channel(const std::string& path, const NamedLog& source) {
  lcm::LogFile log(source.name(), "r");
  std::set<std::string> found;
  while (const lcm::LogEvent* event = log.readNextEvent())
    if (carries_rates(event->channel)) found.insert(event->channel);
  if (found.size() == 1) return *found.begin();
  std::string list;
  for (const std::string& each : found) list += (list.empty() ? "" : ", ") + printable(each);
  throw std::runtime_error(path + (found.empty()
                                       ? ": has no channel IFOG_<NAME>"
                                       : ": has several channels, expected --channel with one of " + list));
}

// The message carries no names; three axes are x, y, z.
std::vector<std::string> axis_names(std::size_t axes) {
  if (axes == 1) return {""};
  std::vector<std::string> names{"x", "y", "z"};
  names.resize(std::min(names.size(), axes));
  return names;
}

// Hands each message of the channel to `sink` with its time in s from the first, later than the one before.
void for_each_rate(InputFile& file, const std::string& channel,
                   const std::function<void(const rate_t&, double)>& sink) {
  const std::string& path = file.path();
  const NamedLog source(file);
  if (!lcm::LogFile(source.name(), "r").good())
    throw std::runtime_error(path + ": cannot open as an LCM log");
  const std::string wanted = channel.empty() ? chosen_channel(path, source) : channel;
  lcm::LogFile log(source.name(), "r");
  std::int64_t start_ns = 0;
  std::size_t number = 0, axes = 0;
  double last_s = -1.0;
  long end = 0;  // of the last whole message
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    ++number;
    end = std::ftell(log.getFilePtr());
    if (event->channel != wanted) continue;
    const auto refuse = [&](const std::string& why) {
      throw std::runtime_error(path + ": message " + std::to_string(number) + " on " + wanted + " " + why);
    };
    rate_t message;
    if (!decode_message(event->data, static_cast<std::size_t>(event->datalen), message))
      refuse("is no ifog.rate_t of this version");
    const std::int64_t now_ns = message.sensor_time_ns >= 0 ? message.sensor_time_ns : message.utime * 1000;
    if (last_s < 0.0) {
      start_ns = now_ns;
      axes = message.raw.size();
    }
    if (axes == 0 || axes > 3) refuse("has " + std::to_string(axes) + " axes, expected 1 to 3");
    if (message.raw.size() != axes) refuse("has another number of axes");
    const double time_s = static_cast<double>(now_ns - start_ns) / 1e9;
    if (time_s <= last_s) refuse("is not later than the one before");
    last_s = time_s;
    sink(message, time_s);
  }
  if (last_s < 0.0) throw std::runtime_error(path + ": has no message on channel " + wanted);
  // LCM's reader does not tell the end of the file from a message that is cut off.
  std::fseek(log.getFilePtr(), 0, SEEK_END);
  if (const long left = std::ftell(log.getFilePtr()) - end; left > 0)
    warn("%s: its last %ld bytes are no whole message (is the file cut off?)\n", path.c_str(), left);
}

}  // namespace

Capture read_lcm_log(InputFile& file, const std::string& channel) {
  Capture capture;
  for_each_rate(file, channel, [&capture](const rate_t& message, double time_s) {
    if (capture.time_s.empty()) {
      capture.axes = axis_names(message.raw.size());
      capture.rate_radps.resize(capture.axes.size());
      capture.reference_rate_radps.resize(capture.axes.size());
    }
    capture.time_s.push_back(time_s);
    for (std::size_t i = 0; i < capture.axes.size(); ++i) capture.rate_radps[i].push_back(message.raw[i]);
  });
  return capture;
}

Table read_published(InputFile& file, const std::string& channel) {
  Table table;
  double time_s = 0.0;
  for_each_rate(file, channel, [&](const rate_t& message, double) {
    // The sum of the steps: the sensor's own time also when a recording was played faster.
    if (!table.time_s.empty()) time_s += message.dt;
    if (table.time_s.empty()) {
      for (const std::string& axis : axis_names(message.raw.size()))
        for (const std::string what : {"raw", "compensated", "denoised", "variance"})
          table.columns.push_back(
              {what + (axis.empty() ? "" : "_" + axis) + (what == "variance" ? "_rad2ps2" : "_radps"), {}});
    }
    table.time_s.push_back(time_s);
    auto column = table.columns.begin();
    for (std::size_t i = 0; column != table.columns.end(); ++i)
      for (const double value :
           {message.raw[i], message.compensated[i], message.denoised[i], message.variance[i]})
        (column++)->values.push_back(value);
  });
  return table;
}

}  // namespace ifog::tools
