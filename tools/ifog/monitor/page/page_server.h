// SPDX-License-Identifier: Apache-2.0
// A read-only page over HTTP for a browser. At most kMostClients are served in parallel; others wait. Each
// gets one answer, within kPatience and for a request of at most kMostBytes.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace ifog::tools {

struct PageAddress {
  std::string host;
  int port = 0;
};
// Parses [ADDRESS:]PORT: numeric address, IPv6 in brackets, or localhost; default 127.0.0.1.
std::optional<PageAddress> page_address(const std::string& text);

class PageServer {
 public:
  static constexpr std::size_t kMostClients = 8, kMostBytes = 8192;
  static constexpr std::chrono::seconds kPatience{3};
  // JSON of a sensor for the page; called by several threads.
  using Data = std::function<std::string(const std::string& sensor)>;

  // Throws std::runtime_error with one line: port in use, no such address here, no permission.
  PageServer(const PageAddress& address, Data data);
  // Ends at once, regardless of clients.
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace ifog::tools
