// SPDX-License-Identifier: Apache-2.0
// One page over HTTP, read only, that whoever sits at this computer opens in a browser. At most kMostClients are answered at
// once and the others wait; each gets one answer, within kPatience and for a request of at most kMostBytes.
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
// Reads [ADDRESS:]PORT: the address is numeric, IPv6 in brackets, or localhost; 127.0.0.1 without it. Nothing: it is none.
std::optional<PageAddress> page_address(const std::string& text);

class PageServer {
 public:
  static constexpr std::size_t kMostClients = 8, kMostBytes = 8192;
  static constexpr std::chrono::seconds kPatience{3};
  // JSON of what the page shows of this sensor; called by several threads.
  using Data = std::function<std::string(const std::string& sensor)>;

  // Throws std::runtime_error with one line: in use, no such address here, no right to it.
  PageServer(const PageAddress& address, Data data);
  // At once, whatever the clients do.
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace ifog::tools
