// SPDX-License-Identifier: Apache-2.0
// A small HTTP and WebSocket client on a loopback socket, for tests: it can also send what no client should.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "tests/host/live/live_messages.hpp"

namespace fovea::test {

class LiveClient {
 public:
  struct Frame {
    int op = 0;  // 1 text, 2 binary, 8 close, 9 ping, 10 pong
    std::string payload;
  };
  struct Reply {
    int status = 0;  // 0: the server closed without an answer
    std::string head;
    std::string body;
  };

  explicit LiveClient(std::uint16_t port) : port_(port), socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("cannot connect");
    }
  }
  ~LiveClient() { close(socket_); }
  LiveClient(const LiveClient&) = delete;
  LiveClient& operator=(const LiveClient&) = delete;

  // False when the server does not take the bytes, because it has closed or for the time `limit`.
  bool Send(std::string_view bytes, std::chrono::milliseconds limit = kLimit) const {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!bytes.empty()) {
      const ssize_t sent = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent > 0) {
        bytes.remove_prefix(static_cast<std::size_t>(sent));
        continue;
      }
      pollfd waits{socket_, POLLOUT, 0};
      if ((sent < 0 && errno != EAGAIN) || std::chrono::steady_clock::now() > deadline ||
          (poll(&waits, 1, 100) > 0 && (waits.revents & (POLLERR | POLLHUP)) != 0)) {
        return false;
      }
    }
    return true;
  }

  // One request for a file. `more`: further header lines.
  Reply Get(const std::string& target, const std::string& more = "", const std::string& method = "GET",
            const std::string& host = "") {
    Send(method + " " + target + " HTTP/1.1\r\nHost: " + HostOr(host) + "\r\n" + more + "\r\n");
    return ReadReply();
  }
  Reply ReadReply() {
    Reply reply;
    while (bytes_.find("\r\n\r\n") == std::string::npos && Fill()) {
    }
    const std::size_t end = bytes_.find("\r\n\r\n");
    if (end == std::string::npos) {
      return reply;
    }
    reply.head = bytes_.substr(0, end + 2);
    bytes_.erase(0, end + 4);
    reply.status = std::stoi(reply.head.substr(reply.head.find(' ')));
    if (reply.status != 101) {  // the server closes after each answer
      while (Fill()) {
      }
      reply.body = std::move(bytes_);
    }
    return reply;
  }

  // Asks for a WebSocket. 101: it is open.
  Reply Open(const std::string& target, const std::string& protocol = "foxglove.websocket.v1",
             const std::string& more = "", const std::string& host = "") {
    Send("GET " + target + " HTTP/1.1\r\nHost: " + HostOr(host) +
         "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
         (protocol.empty() ? "" : "Sec-WebSocket-Protocol: " + protocol + "\r\n") + more + "\r\n");
    return ReadReply();
  }
  // A frame's head with this length, masked by zeros, so that the payload stays as it is.
  static std::string Head(int op, std::uint64_t length) {
    std::string head(1, static_cast<char>(0x80 | op));
    int bytes = 8;
    if (length < 126) {
      head += static_cast<char>(0x80 | static_cast<int>(length));
      bytes = 0;
    } else if (length < 65536) {
      head += static_cast<char>(0x80 | 126);
      bytes = 2;
    } else {
      head += static_cast<char>(0x80 | 127);
    }
    while (bytes > 0) {
      head += static_cast<char>(length >> (8 * --bytes));
    }
    return head + std::string(4, '\0');
  }
  bool SendText(const nlohmann::json& message) const {
    const std::string text = message.dump();
    return Send(Head(1, text.size()) + text);
  }
  bool SendBinary(const std::string& bytes) const { return Send(Head(2, bytes.size()) + bytes); }

  // The next frame; none when the server has closed, or when none came for the time limit.
  std::optional<Frame> Read() {
    const auto need = [this](std::size_t size) {
      while (bytes_.size() < size && Fill()) {
      }
      return bytes_.size() >= size;
    };
    if (!need(2)) {
      return std::nullopt;
    }
    std::size_t length = static_cast<unsigned char>(bytes_[1]) & 0x7FU;
    std::size_t at = 2;
    if (length >= 126) {
      const std::size_t size = length == 126 ? 2 : 8;
      if (!need(at + size)) {
        return std::nullopt;
      }
      length = 0;
      for (std::size_t i = 0; i < size; ++i) {
        length = length << 8U | static_cast<unsigned char>(bytes_[at++]);
      }
    }
    if (!need(at + length)) {
      return std::nullopt;
    }
    Frame frame{bytes_[0] & 0x0F, bytes_.substr(at, length)};
    bytes_.erase(0, at + length);
    return frame;
  }
  // The next message with that value in that field, as Readable gives it; null when none comes.
  nlohmann::json Await(const char* field, const nlohmann::json& value) {
    while (const auto frame = Read()) {
      if (frame->op == 1 || frame->op == 2) {
        nlohmann::json message = Readable(frame->op == 1, frame->payload);
        if (message.contains(field) && message[field] == value) {
          return message;
        }
      }
    }
    return nullptr;
  }
  // The close frame's code; 0 when the connection ends without one.
  int AwaitClose() {
    while (const auto frame = Read()) {
      if (frame->op == 8) {
        return frame->payload.size() < 2 ? 0
                                         : static_cast<unsigned char>(frame->payload[0]) * 256 +
                                               static_cast<unsigned char>(frame->payload[1]);
      }
    }
    return 0;
  }
  // Whether the server ends the connection within the limit, whatever it says before.
  bool AwaitEnd() {
    while (Fill()) {
      bytes_.clear();
    }
    return has_ended_;
  }

 private:
  static constexpr std::chrono::milliseconds kLimit{20'000};  // also for a busy machine

  [[nodiscard]] std::string HostOr(const std::string& host) const {
    return host.empty() ? "127.0.0.1:" + std::to_string(port_) : host;
  }
  // Reads more; false at the end, or after the limit.
  bool Fill() {
    pollfd waits{socket_, POLLIN, 0};
    if (poll(&waits, 1, static_cast<int>(kLimit.count())) <= 0) {
      return false;
    }
    char part[65536];
    const ssize_t got = recv(socket_, part, sizeof part, 0);
    has_ended_ = got <= 0;
    if (got > 0) {
      bytes_.append(part, static_cast<std::size_t>(got));
    }
    return got > 0;
  }

  std::uint16_t port_;
  int socket_;
  std::string bytes_;
  bool has_ended_ = false;
};

}  // namespace fovea::test
