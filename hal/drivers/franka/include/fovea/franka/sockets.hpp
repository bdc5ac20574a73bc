// SPDX-License-Identifier: Apache-2.0
// TCP and UDP over IPv4, as far as the robot's interface needs them. Functions that open a socket may block,
// allocate and throw NetworkError; sending and receiving never do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

namespace fovea::franka {

// One line for a person.
class NetworkError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Owns a file descriptor.
class Descriptor {
 public:
  Descriptor() noexcept = default;
  explicit Descriptor(int fd) noexcept : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor() { Close(); }

  void Close() noexcept;
  [[nodiscard]] bool open() const noexcept { return fd_ >= 0; }
  [[nodiscard]] int get() const noexcept { return fd_; }

 private:
  int fd_ = -1;
};

// An IPv4 address and a port, both in the host's byte order.
struct Endpoint {
  std::uint32_t ip = 0;
  std::uint16_t port = 0;

  [[nodiscard]] bool operator==(const Endpoint&) const noexcept = default;
};

// Looks up `host`, a name or a dotted address. NetworkError.
Endpoint Resolve(const std::string& host, std::uint16_t port);

// The result of reading a stream.
enum class Received : std::uint8_t { kSome, kNothing, kClosed };

class TcpConnection {
 public:
  TcpConnection() noexcept = default;
  explicit TcpConnection(Descriptor descriptor) noexcept;

  // NetworkError when `to` does not answer within `timeout_ms`.
  static TcpConnection Connect(const Endpoint& to, int timeout_ms);

  // Sends all of `bytes`. False if the connection is broken or its buffer is full. Real-time: yes.
  [[nodiscard]] bool Send(std::span<const std::byte> bytes) noexcept;
  // Sends as much of `bytes` as there is room for. Returns how many bytes it sent. Real-time: yes.
  [[nodiscard]] std::size_t SendSome(std::span<const std::byte> bytes) noexcept;
  // Takes what has arrived, without waiting; fills `size` bytes of `room`. Real-time: yes.
  [[nodiscard]] Received Receive(std::span<std::byte> room, std::size_t& size) noexcept;

  [[nodiscard]] Endpoint peer() const noexcept;
  [[nodiscard]] Endpoint own() const noexcept;
  void Close() noexcept { descriptor_.Close(); }
  [[nodiscard]] bool open() const noexcept { return descriptor_.open(); }
  [[nodiscard]] int fd() const noexcept { return descriptor_.get(); }

 private:
  Descriptor descriptor_;
};

class TcpListener {
 public:
  // Port 0 takes a free one. NetworkError when the port is taken.
  explicit TcpListener(const Endpoint& at);

  // The next waiting client, if there is one.
  [[nodiscard]] std::optional<TcpConnection> Accept() noexcept;
  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  [[nodiscard]] int fd() const noexcept { return descriptor_.get(); }

 private:
  Descriptor descriptor_;
  std::uint16_t port_ = 0;
};

class UdpSocket {
 public:
  UdpSocket() noexcept = default;
  // Port 0 takes a free one. NetworkError.
  explicit UdpSocket(const Endpoint& at);

  // Real-time: both yes. False: the datagram could not be sent; no datagram is waiting.
  [[nodiscard]] bool Send(std::span<const std::byte> bytes, const Endpoint& to) noexcept;
  [[nodiscard]] bool Receive(std::span<std::byte> room, std::size_t& size, Endpoint& from) noexcept;

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  [[nodiscard]] int fd() const noexcept { return descriptor_.get(); }

 private:
  Descriptor descriptor_;
  std::uint16_t port_ = 0;
};

// Waits until one of `fds` (those below 0 are ignored) has something to read, or `timeout_ns` has passed.
// Real-time: yes; this is where a loop sleeps.
void WaitReadable(std::span<const int> fds, std::int64_t timeout_ns) noexcept;

}  // namespace fovea::franka
