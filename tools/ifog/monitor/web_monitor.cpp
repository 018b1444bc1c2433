// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/monitor/web_monitor.h"

#include <arpa/inet.h>
#include <httplib.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <semaphore>
#include <system_error>
#include <thread>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "msgs/axis_name.h"
#include "page_source.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/monitor/sensor_view.h"

namespace ifog::tools {
namespace {

using Clock = std::chrono::steady_clock;

// At most kMostClients are served in parallel; others wait. Each gets one answer, within kPatience and for a
// request of at most kMostBytes.
constexpr std::size_t kMostClients = 8, kMostBytes = 8192;
constexpr std::chrono::seconds kPatience{3};

// A client's socket with a limit for the whole request, because httplib limits only each read.
class Client final : public httplib::Stream {
 public:
  Client(int socket, const std::atomic<bool>& stop) : socket_(socket), stop_(stop) {}
  bool is_readable() const override { return at_ < held_ || wait(POLLIN); }
  bool is_writable() const override { return wait(POLLOUT); }
  ssize_t read(char* out, std::size_t size) override {
    if (at_ == held_) {
      // Full: browsers send shorter requests.
      if (held_ == buffer_.size() || !wait(POLLIN)) return -1;
      const ssize_t got = ::recv(socket_, buffer_.data() + held_, buffer_.size() - held_, 0);
      if (got <= 0) return got;
      held_ += static_cast<std::size_t>(got);
    }
    const std::size_t given = std::min(size, held_ - at_);
    std::copy_n(buffer_.data() + at_, given, out);
    at_ += given;
    return static_cast<ssize_t>(given);
  }
  ssize_t write(const char* data, std::size_t size) override {
    for (std::size_t sent = 0; sent < size;) {
      if (!wait(POLLOUT)) return -1;
      const ssize_t put = ::send(socket_, data + sent, size - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (put < 0 && errno != EAGAIN) return -1;
      sent += static_cast<std::size_t>(std::max<ssize_t>(put, 0));
    }
    return static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  int socket() const override { return socket_; }

 private:
  bool wait(short events) const {
    while (!stop_ && Clock::now() < end_) {
      pollfd wanted{socket_, events, 0};
      if (::poll(&wanted, 1, 50) > 0) return true;
    }
    return false;
  }

  int socket_;
  const std::atomic<bool>& stop_;
  Clock::time_point end_ = Clock::now() + kPatience;
  std::array<char, kMostBytes> buffer_{};
  std::size_t at_ = 0, held_ = 0;
};

// Like httplib's own, but with a limit: further clients wait in the kernel's queue.
class Clients final : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> answer) override {
    free_.acquire();
    pool_.enqueue([this, answer = std::move(answer)] {
      answer();
      free_.release();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  httplib::ThreadPool pool_{kMostClients};
  std::counting_semaphore<> free_{kMostClients};
};

bool is_loopback(const std::string& host) {
  in_addr address{};
  return host == "localhost" || host == "[::1]" || host == "::1" ||
         (::inet_pton(AF_INET, host.c_str(), &address) == 1 && host.starts_with("127."));
}

using nlohmann::ordered_json;

ordered_json of_axis(const SensorView& sensor, std::size_t a) {
  constexpr std::size_t kMostOctaves = 64;
  const std::size_t all = sensor.axis_count();
  ordered_json out{
      {"name", axis_name(a, all)}, {"seconds", ordered_json::array()}, {"allan", ordered_json::array()}};
  if (a < sensor.axes().size()) {
    const AxisView& now = sensor.axes()[a];
    out.update({{"rate_radps", now.rate_radps},
                {"noise_radps", now.noise_radps},
                {"raw_noise_radps", now.raw_noise_radps},
                {"angle_rad", now.angle_rad}});
  }
  for (const SensorView::Second& each : sensor.history(a))
    out["seconds"].push_back({each.raw_low_radps, each.raw_high_radps, each.rate_radps});
  if (const status_t* const status = sensor.live_status();
      status != nullptr && a < status->allan_rate_radps.size()) {
    const auto& allan = status->allan_rate_radps[a];
    out["allan"] = std::vector(
        allan.begin(), allan.begin() + static_cast<std::ptrdiff_t>(std::min(kMostOctaves, allan.size())));
  }
  return out;
}

ordered_json of_sensor(const std::string& name, const SensorView& sensor, const KnownSensor* known) {
  constexpr std::size_t kMostAxes = 3;
  ordered_json lines = ordered_json::array(), axes = ordered_json::array();
  for (const ShownLine& line : view_lines(name, sensor, {}, known))
    if (line.tone != Tone::figure) lines.push_back({tone_name(line.tone), line.text});
  for (std::size_t a = 0; a < std::min(kMostAxes, sensor.axis_count()); ++a)
    axes.push_back(of_axis(sensor, a));
  const double tau0_s = sensor.live_status() != nullptr ? sensor.live_status()->allan_tau0_s : 0.0;
  return {{"lines", lines}, {"allan_tau0_s", tau0_s}, {"axes", axes}};
}

}  // namespace

std::optional<PageAddress> page_address(const std::string& text) {
  PageAddress out{"127.0.0.1", 0};
  const std::size_t colon = text.rfind(':');
  if (colon != std::string::npos) {
    out.host = text.substr(0, colon);
    const bool bracketed = out.host.size() > 2 && out.host.front() == '[' && out.host.back() == ']';
    if (bracketed) out.host = out.host.substr(1, out.host.size() - 2);
    if (out.host == "localhost") out.host = "127.0.0.1";
    std::array<unsigned char, sizeof(in6_addr)> bytes{};
    if (::inet_pton(bracketed ? AF_INET6 : AF_INET, out.host.c_str(), bytes.data()) != 1) return {};
  }
  const auto port = whole_in(colon == std::string::npos ? text : text.substr(colon + 1));
  if (!port || *port < 1 || *port > 65535) return {};
  out.port = static_cast<int>(*port);
  return out;
}

class WebMonitor::Server final : public httplib::Server {
 public:
  Server(const PageAddress& address, WebMonitor& monitor)
      : monitor_(monitor), local_(is_loopback(address.host)) {
    // httplib's own options would let a second monitor share the port.
    set_socket_options([](int socket) {
      const int on = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    });
    new_task_queue = [] { return new Clients; };
    set_default_headers(
        {{"Content-Security-Policy",
          "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; base-uri 'none'; "
          "form-action 'none'; frame-ancestors 'none'"},
         {"X-Content-Type-Options", "nosniff"},
         {"Referrer-Policy", "no-referrer"},
         {"Cache-Control", "no-store"}});
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      answer(request, response);
      return HandlerResponse::Handled;
    });
    errno = 0;
    if (!bind_to_port(address.host, address.port, AI_NUMERICHOST))
      throw refusal("--web {} port {}: cannot listen: {}", address.host, address.port,
                    std::generic_category().message(errno));
    thread_ = std::thread([this] {
      listen_after_bind();
      ended_ = true;
    });
    // Before listening, stop() would have no effect.
    while (!is_running() && !ended_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ~Server() override {
    stop_ = true;
    stop();
    thread_.join();
  }

 private:
  void answer(const httplib::Request& request, httplib::Response& response) const {
    const std::string host = request.get_header_value("Host");
    const std::size_t end = host.starts_with('[') ? host.find(']') + 1 : host.find(':');
    const auto refuse = [&](int status, const char* why) {
      response.status = status;
      response.set_content(why, "text/plain");
    };
    // Protects against DNS rebinding: another site's name may resolve to this address.
    if (local_ && !is_loopback(host.substr(0, end)))
      return refuse(403, "expected this computer's own name: localhost\n");
    if (request.method != "GET" && request.method != "HEAD") return refuse(405, "read only\n");
    if (request.path == "/data")
      return response.set_content(monitor_.data(request.get_param_value("sensor")), "application/json");
    if (request.path == "/") return response.set_content(kPageHtml, "text/html; charset=utf-8");
    if (request.path == "/page.css") return response.set_content(kPageStyle, "text/css; charset=utf-8");
    if (request.path == "/page.js")
      return response.set_content(kPageScript, "text/javascript; charset=utf-8");
    refuse(404, "expected /\n");
  }

  // As httplib does for TLS, with a stream class of its own.
  bool process_and_close_socket(int socket) override {
    bool done = false;
    try {
      Client client(socket, stop_);
      bool closed = false;
      done = process_request(client, true, closed, [](httplib::Request& request) { request.ranges.clear(); });
    } catch (const std::exception&) {  // of this client only
    }
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return done;
  }

  WebMonitor& monitor_;
  bool local_;
  std::atomic<bool> stop_ = false, ended_ = false;
  std::thread thread_;
};

WebMonitor::WebMonitor(const PageAddress& address, const std::map<std::string, SensorView>& sensors,
                       const KnownHere& known, std::function<std::string()> waiting)
    : sensors_(sensors),
      known_(known),
      waiting_(std::move(waiting)),
      server_(std::make_unique<Server>(address, *this)) {}

WebMonitor::~WebMonitor() = default;

std::string WebMonitor::data(const std::string& wanted) {
  const std::lock_guard held(guard_);
  ordered_json out{{"age_s", std::chrono::duration<double>(Clock::now() - interval_ended_).count()},
                   {"waiting", sensors_.empty() ? waiting_() : ""},
                   {"sensors", ordered_json::array()}};
  const auto asked = sensors_.find(wanted);
  const auto shown = asked != sensors_.end() ? asked : sensors_.begin();
  for (const auto& [name, sensor] : sensors_)
    out["sensors"].push_back({name, tone_name(tone_of(sensor)), printable(name)});
  if (shown != sensors_.end()) {
    out["chosen"] = shown->first;
    out["sensor"] = of_sensor(shown->first, shown->second, known_.of(shown->first));
  }
  return json_text(out, -1);
}

}  // namespace ifog::tools
