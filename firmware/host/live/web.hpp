// SPDX-License-Identifier: Apache-2.0
// HTTP and WebSocket on one port: connections, their limits and their time-outs. Knows no protocol above
// them.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/host/live/hub.hpp"
#include "firmware/host/live/outbox.hpp"
#include "firmware/host/live/server.hpp"

namespace fovea::live {

struct WebRequest {
  std::string target;  // path and query
  std::string host;    // these headers; empty where there is none
  std::string origin;
  bool is_get = false;       // GET or HEAD
  std::string subprotocols;  // that a WebSocket's request offers
};

struct WebResponse {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string content;
  std::string policy = "default-src 'none'";  // Content-Security-Policy
};

class Web {
 public:
  // All are called by the thread that runs Run.
  struct Handlers {
    // Answers a request for a file, now or later, from any thread, by calling `reply` once.
    using Reply = std::function<void(WebResponse response)>;
    std::function<void(const WebRequest& request, Reply reply)> get;
    // Whether a WebSocket may open: its subprotocol, or the refusal.
    struct Welcome {
      std::string subprotocol;
      std::optional<WebResponse> refusal;
    };
    std::function<Welcome(const WebRequest& request)> welcome;
    std::function<std::uint64_t()> join;
    std::function<void(std::uint64_t viewer)> leave;
    std::function<std::optional<Closing>(std::uint64_t viewer, bool is_text, std::string_view bytes)> receive;
    std::function<std::optional<Outgoing>(std::uint64_t viewer)> next;
    std::function<void()> pulse;  // each 50 ms
  };

  // Listens. config::InputError when it cannot: see Server.
  Web(const std::string& address, std::uint16_t port, const Limits& limits, Handlers handlers);
  ~Web();

  [[nodiscard]] std::uint16_t port() const;
  // Serves until Stop, which any thread may call, once.
  void Run();
  // Closes all viewers, then returns from Run, after a second at most.
  void Stop(const Closing& closing);
  // From any thread: `job` is run by the thread of Run.
  void Post(std::function<void()> job);

  // The next ones from the thread of Run alone.
  // Writes what waits for the viewers.
  void Flush();
  // Ends a connection without another word to it.
  void Cut(std::uint64_t viewer);
  // Viewers that were cut or closed because they took nothing, too much, or broke a rule.
  [[nodiscard]] std::uint64_t expelled() const;

  struct Parts;

 private:
  struct Io;
  std::unique_ptr<Io> io_;  // destroyed last: open connections refer to it
  std::shared_ptr<Parts> parts_;
};

}  // namespace fovea::live
