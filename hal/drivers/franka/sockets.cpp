// SPDX-License-Identifier: Apache-2.0
#include "fovea/franka/sockets.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace fovea::franka {
namespace {

constexpr std::size_t kMaxWaited = 4;  // descriptors that one call can wait for

sockaddr_in ToSystem(const Endpoint& endpoint) noexcept {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(endpoint.port);
  address.sin_addr.s_addr = htonl(endpoint.ip);
  return address;
}

Endpoint FromSystem(const sockaddr_in& address) noexcept {
  return {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)};
}

std::string Text(const Endpoint& endpoint) {
  const sockaddr_in address = ToSystem(endpoint);
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
  return std::string(text.data()) + ":" + std::to_string(endpoint.port);
}

[[noreturn]] void Fail(const std::string& what) { throw NetworkError(what + ": " + std::strerror(errno)); }

// Calls a socket function of the system, which takes a general address.
template <typename Call>
int WithAddress(const Endpoint& endpoint, Call&& call) noexcept {
  const sockaddr_in address = ToSystem(endpoint);
  sockaddr general{};
  static_assert(sizeof(general) == sizeof(address));
  std::memcpy(&general, &address, sizeof(general));
  return static_cast<int>(call(&general, static_cast<socklen_t>(sizeof(general))));
}

Endpoint OwnEnd(int fd) noexcept {
  sockaddr_in address{};
  sockaddr general{};
  socklen_t size = sizeof(general);
  getsockname(fd, &general, &size);
  std::memcpy(&address, &general, sizeof(address));
  return FromSystem(address);
}

Descriptor Open(int type, const Endpoint& at) {
  Descriptor descriptor(socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!descriptor.open()) {
    Fail("cannot create a socket");
  }
  const int fd = descriptor.get();
  if (type == SOCK_STREAM) {
    const int on = 1;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  }
  if (WithAddress(at, [fd](const sockaddr* a, socklen_t n) { return bind(fd, a, n); }) != 0) {
    Fail("cannot listen on " + Text(at));
  }
  return descriptor;
}

}  // namespace

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (this != &other) {
    Close();
    fd_ = std::exchange(other.fd_, -1);
  }
  return *this;
}

void Descriptor::Close() noexcept {
  if (fd_ >= 0) {
    close(fd_);
    fd_ = -1;
  }
}

Endpoint Resolve(const std::string& host, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int code = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (code != 0) {
    throw NetworkError("\"" + host + "\" is not a known host: " + gai_strerror(code));
  }
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof(address));
  freeaddrinfo(found);
  Endpoint endpoint = FromSystem(address);
  endpoint.port = port;
  return endpoint;
}

TcpConnection::TcpConnection(Descriptor descriptor) noexcept : descriptor_(std::move(descriptor)) {
  const int on = 1;
  setsockopt(descriptor_.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
}

TcpConnection TcpConnection::Connect(const Endpoint& to, int timeout_ms) {
  Descriptor descriptor(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int fd = descriptor.get();
  if (!descriptor.open()) {
    Fail("cannot create a socket");
  }
  const int begun = WithAddress(to, [fd](const sockaddr* a, socklen_t n) { return connect(fd, a, n); });
  if (begun != 0 && errno != EINPROGRESS) {
    Fail("no connection to " + Text(to));
  }
  pollfd wait{fd, POLLOUT, 0};
  if (poll(&wait, 1, timeout_ms) != 1) {
    throw NetworkError("no connection to " + Text(to) + ": no answer within " + std::to_string(timeout_ms) +
                       " ms");
  }
  int error = 0;
  socklen_t size = sizeof(error);
  getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
  if (error != 0) {
    errno = error;
    Fail("no connection to " + Text(to));
  }
  return TcpConnection(std::move(descriptor));
}

bool TcpConnection::Send(std::span<const std::byte> bytes) noexcept {
  return SendSome(bytes) == bytes.size();
}

std::size_t TcpConnection::SendSome(std::span<const std::byte> bytes) noexcept {
  const auto sent = send(descriptor_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  return sent > 0 ? static_cast<std::size_t>(sent) : 0;
}

Received TcpConnection::Receive(std::span<std::byte> room, std::size_t& size) noexcept {
  const auto got = recv(descriptor_.get(), room.data(), room.size(), MSG_DONTWAIT);
  if (got > 0) {
    size = static_cast<std::size_t>(got);
    return Received::kSome;
  }
  const bool later = got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
  return later || room.empty() ? Received::kNothing : Received::kClosed;
}

Endpoint TcpConnection::own() const noexcept { return OwnEnd(descriptor_.get()); }

Endpoint TcpConnection::peer() const noexcept {
  sockaddr_in address{};
  sockaddr general{};
  socklen_t size = sizeof(general);
  getpeername(descriptor_.get(), &general, &size);
  std::memcpy(&address, &general, sizeof(address));
  return FromSystem(address);
}

TcpListener::TcpListener(const Endpoint& at) : descriptor_(Open(SOCK_STREAM, at)) {
  constexpr int kWaiting = 4;
  if (listen(descriptor_.get(), kWaiting) != 0) {
    Fail("cannot listen on " + Text(at));
  }
  port_ = OwnEnd(descriptor_.get()).port;
}

std::optional<TcpConnection> TcpListener::Accept() noexcept {
  Descriptor client(accept4(descriptor_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!client.open()) {
    return std::nullopt;
  }
  return TcpConnection(std::move(client));
}

UdpSocket::UdpSocket(const Endpoint& at) : descriptor_(Open(SOCK_DGRAM, at)) {
  port_ = OwnEnd(descriptor_.get()).port;
}

bool UdpSocket::Send(std::span<const std::byte> bytes, const Endpoint& to) noexcept {
  const int fd = descriptor_.get();
  const int sent = WithAddress(to, [fd, bytes](const sockaddr* a, socklen_t n) {
    return sendto(fd, bytes.data(), bytes.size(), MSG_DONTWAIT, a, n);
  });
  return sent == static_cast<int>(bytes.size());
}

bool UdpSocket::Receive(std::span<std::byte> room, std::size_t& size, Endpoint& from) noexcept {
  sockaddr general{};
  socklen_t general_size = sizeof(general);
  const auto got = recvfrom(descriptor_.get(), room.data(), room.size(), MSG_DONTWAIT | MSG_TRUNC, &general,
                            &general_size);
  if (got < 0) {
    return false;
  }
  sockaddr_in address{};
  std::memcpy(&address, &general, sizeof(address));
  from = FromSystem(address);
  size = static_cast<std::size_t>(got);
  return true;
}

void WaitReadable(std::span<const int> fds, std::int64_t timeout_ns) noexcept {
  std::array<pollfd, kMaxWaited> wait{};
  const std::size_t count = std::min(fds.size(), wait.size());
  for (std::size_t k = 0; k < count; ++k) {
    wait[k] = {fds[k], POLLIN, 0};
  }
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t bounded = timeout_ns > 0 ? timeout_ns : 0;
  const timespec timeout{bounded / kSecond, bounded % kSecond};
  ppoll(wait.data(), static_cast<nfds_t>(count), &timeout, nullptr);
}

}  // namespace fovea::franka
