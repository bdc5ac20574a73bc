// SPDX-License-Identifier: Apache-2.0
// A robot on the network that a test controls step by step, from its own thread or another.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "fovea/franka/franka_arm.hpp"

namespace fovea::test {

using namespace std::chrono_literals;

inline constexpr franka::Endpoint kLoopback{0x7F000001, 0};
inline constexpr auto kPatience = 2s;  // longest wait in a test

class FakeRobot {
 public:
  struct Request {
    franka::Header header;
    std::vector<std::byte> payload;
  };

  [[nodiscard]] std::uint16_t port() const { return listener_.port(); }

  // Waits for the client.
  bool Accept() {
    return Await([this] {
      if (auto client = listener_.Accept()) {
        tcp_ = std::move(*client);
        return true;
      }
      return false;
    });
  }

  // The next request; none after kPatience.
  std::optional<Request> Take() {
    Request request;
    std::span<const std::byte> payload;
    const bool got = Await(
        [&] { return stream_.Take(tcp_, request.header, payload) == franka::MessageStream::Next::kMessage; });
    if (!got) {
      return std::nullopt;
    }
    request.payload.assign(payload.begin(), payload.end());
    return request;
  }

  template <typename Payload>
  void Answer(const Request& request, const Payload& payload) {
    const auto bytes = franka::MakeMessage(request.header.command, request.header.command_id, payload);
    EXPECT_TRUE(tcp_.Send(bytes));
  }
  void AnswerStatus(const Request& request, int status) {
    Answer(request, franka::StatusAnswer{static_cast<std::uint8_t>(status)});
  }
  void SendRaw(const std::vector<std::byte>& bytes) { EXPECT_TRUE(tcp_.Send(bytes)); }
  void Close() { tcp_.Close(); }

  // Answers the set-up as a robot does, then sends the first state. False when the client stops short.
  bool ServeSetUp() {
    if (!Accept()) {
      return false;
    }
    const auto hello = Take();
    franka::ConnectRequest connect;
    if (!hello || !franka::Decode(hello->payload, connect)) {
      return false;
    }
    client_udp_ = kLoopback;
    client_udp_.port = connect.udp_port;
    requests.push_back(*hello);
    Answer(*hello, franka::ConnectAnswer{});
    for (int k = 0; k < 4; ++k) {
      const auto setter = Take();
      if (!setter) {
        return false;
      }
      requests.push_back(*setter);
      AnswerStatus(*setter, 0);
    }
    SendState();
    return true;
  }

  // Sends `state`, then advances its time by 1 ms.
  void SendState() {
    SendDatagram(franka::Bytes(state));
    ++state.message_id;
  }
  void SendDatagram(std::span<const std::byte> bytes) { EXPECT_TRUE(udp_.Send(bytes, client_udp_)); }

  // Sends, from another address, a state that is later by `ms`.
  void SendForeignState(std::uint64_t ms) {
    franka::RobotState later = state;
    later.message_id += ms;
    franka::UdpSocket elsewhere{franka::Endpoint{0x7F000002, 0}};
    EXPECT_TRUE(elsewhere.Send(franka::Bytes(later), client_udp_));
  }

  // The next command; none after `patience`.
  std::optional<franka::RobotCommand> TakeCommand(std::chrono::milliseconds patience = kPatience) {
    std::array<std::byte, 2048> bytes;
    std::size_t size = 0;
    franka::Endpoint from;
    franka::RobotCommand command;
    const bool got = Await([&] { return udp_.Receive(bytes, size, from); }, patience);
    if (!got || size != 370 || !franka::Decode(std::span<const std::byte>(bytes).first(size), command)) {
      return std::nullopt;
    }
    return command;
  }

  void ShowMove() {
    state.robot_mode = franka::RobotMode::kMove;
    state.controller_mode = franka::ControllerMode::kExternal;
    state.motion_generator_mode = franka::MotionGeneratorMode::kJointVelocity;
  }
  void ShowIdle() {
    state.robot_mode = franka::RobotMode::kIdle;
    state.controller_mode = franka::ControllerMode::kOther;
    state.motion_generator_mode = franka::MotionGeneratorMode::kIdle;
  }
  void ShowReflex(franka::Error error) {
    ShowIdle();
    state.robot_mode = franka::RobotMode::kReflex;
    state.errors[static_cast<std::size_t>(error)] = 1;
  }

  static FakeRobot::Request None() { return {}; }

  franka::RobotState state = FirstState();
  std::vector<Request> requests;  // of the set-up

 private:
  static franka::RobotState FirstState() {
    franka::RobotState first;
    first.message_id = 1000;
    first.robot_mode = franka::RobotMode::kIdle;
    return first;
  }

  template <typename Done>
  static bool Await(Done&& done, std::chrono::milliseconds patience = kPatience) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!done()) {
      if (std::chrono::steady_clock::now() > end) {
        return false;
      }
      std::this_thread::sleep_for(100us);
    }
    return true;
  }

  franka::TcpListener listener_{kLoopback};
  franka::UdpSocket udp_{kLoopback};
  franka::TcpConnection tcp_;
  franka::MessageStream stream_;
  franka::Endpoint client_udp_;
};

inline franka::FrankaConfig ConfigFor(const FakeRobot& robot) {
  franka::FrankaConfig config;
  config.host = "127.0.0.1";
  config.port = robot.port();
  config.answer_timeout_ms = 300;
  config.state_timeout_ns = 50 * hal::kNsPerMs;  // a step on a busy machine must not time out
  return config;
}

}  // namespace fovea::test
