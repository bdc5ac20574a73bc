// SPDX-License-Identifier: Apache-2.0
// Sockets of the driver and of the simulated robot. Each error is one line that names the other end.
#include "fovea/franka/sockets.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace fovea::franka {
namespace {

using testing::HasSubstr;

constexpr Endpoint kAny{0x7F000001, 0};
constexpr std::int64_t kPatienceNs = 2'000'000'000;

std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const NetworkError& error) {
    return error.what();
  }
  return "";
}

TEST(Sockets, FailuresNameHostOrPort) {
  const std::string name(300, 'x');  // too long for a host name: no DNS query
  EXPECT_THAT(ErrorOf([&] { Resolve(name, 1337); }), HasSubstr("\"" + name + "\" is not a known host"));
  EXPECT_EQ(Resolve("127.0.0.1", 1337), (Endpoint{0x7F000001, 1337}));

  const UdpSocket udp(kAny);
  EXPECT_THAT(ErrorOf([&] {
                UdpSocket second({kAny.ip, udp.port()});
              }),
              HasSubstr("cannot listen on 127.0.0.1:" + std::to_string(udp.port())));
  EXPECT_THAT(ErrorOf([] {
                TcpListener elsewhere({0xC0000201, 0});
              }),
              HasSubstr("cannot listen on 192.0.2.1:0"))
      << "an address reserved for documentation";

  std::uint16_t left = 0;
  {
    const TcpListener listener(kAny);
    left = listener.port();
    EXPECT_THAT(ErrorOf([&] {
                  TcpListener second({kAny.ip, left});
                }),
                HasSubstr("cannot listen on 127.0.0.1:" + std::to_string(left)));
  }
  EXPECT_THAT(ErrorOf([&] {
                TcpConnection::Connect({kAny.ip, left}, 1000);
              }),
              HasSubstr("no connection to 127.0.0.1:" + std::to_string(left)));
}

TEST(Sockets, BothEndsExchangeBytesAndDetectTheClose) {
  TcpListener listener(kAny);
  EXPECT_FALSE(listener.Accept().has_value()) << "no client yet";
  TcpConnection client = TcpConnection::Connect({kAny.ip, listener.port()}, 1000);
  const std::array waited{listener.fd(), -1};
  WaitReadable(waited, kPatienceNs);
  std::optional<TcpConnection> server = listener.Accept();
  ASSERT_TRUE(server.has_value());
  EXPECT_EQ(server->peer(), client.own());
  EXPECT_EQ(client.peer(), server->own());

  std::array<std::byte, 8> room{};
  std::size_t size = 0;
  EXPECT_EQ(server->Receive(room, size), Received::kNothing);
  ASSERT_TRUE(client.Send(std::array{std::byte{7}, std::byte{9}}));
  WaitReadable(std::array{server->fd()}, kPatienceNs);
  ASSERT_EQ(server->Receive(std::span(room).first(1), size), Received::kSome);
  EXPECT_EQ(size, 1U);
  EXPECT_EQ(server->Receive(std::span(room).first(0), size), Received::kNothing)
      << "an empty buffer does not mean closed";
  client.Close();
  WaitReadable(std::array{server->fd()}, kPatienceNs);
  ASSERT_EQ(server->Receive(room, size), Received::kSome) << "bytes sent before the close";
  EXPECT_EQ(room[0], std::byte{9});
  EXPECT_EQ(server->Receive(room, size), Received::kClosed);
}

// The peer does not read: Send fails when the buffer is full, and does not wait.
TEST(Sockets, SendToAFullBufferFailsWithoutWaiting) {
  TcpListener listener(kAny);
  TcpConnection client = TcpConnection::Connect({kAny.ip, listener.port()}, 1000);
  const std::vector<std::byte> much(1 << 20U);
  std::size_t sent = 0;
  std::size_t last = 1;
  for (int k = 0; k < 1000 && last > 0; ++k) {
    last = client.SendSome(much);
    sent += last;
  }
  EXPECT_EQ(last, 0U) << sent << " bytes were buffered";
  EXPECT_FALSE(client.Send(much));
}

}  // namespace
}  // namespace fovea::franka
