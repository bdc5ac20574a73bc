// SPDX-License-Identifier: Apache-2.0
// The robot's side of one client's TCP connection: receives requests, executes them on the robot, answers.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "fovea/franka/message_stream.hpp"
#include "sim/panda/robot.hpp"

namespace fovea::sim {

class FciSession {
 public:
  // `model_library` is the file sent on LoadModelLibrary; empty: none. It must outlive the session.
  FciSession(FciRobot& robot, franka::TcpConnection client, const std::vector<std::byte>& model_library);

  // Handles all requests that have arrived. False if the session is over; end_reason() says why.
  [[nodiscard]] bool Serve();
  // Sends the second answer to Move if a motion has ended. Call it after sending the state that shows it.
  void AnswerMoveEnd();

  // Destination of the states; none before Connect.
  [[nodiscard]] const std::optional<franka::Endpoint>& state_endpoint() const { return state_endpoint_; }
  // Whether the last Serve started a motion; true only once per motion.
  [[nodiscard]] bool TakeMotionStart();
  [[nodiscard]] int fd() const { return client_.fd(); }
  [[nodiscard]] const char* end_reason() const { return end_reason_; }

 private:
  [[nodiscard]] bool Do(const franka::Header& header, std::span<const std::byte> payload);
  [[nodiscard]] bool DoConnect(const franka::Header& header, std::span<const std::byte> payload);
  void DoLoadModel(const franka::Header& header, std::span<const std::byte> payload);
  void Send(std::span<const std::byte> bytes);
  void Flush();
  void DoMove(const franka::Header& header, std::span<const std::byte> payload);
  template <typename Payload>
  void Answer(const franka::Header& header, const Payload& payload);
  void AnswerStatus(const franka::Header& header, std::uint8_t status);

  FciRobot& robot_;
  franka::TcpConnection client_;
  const std::vector<std::byte>& model_library_;
  franka::MessageStream stream_;
  std::vector<std::byte> to_send_;
  std::optional<franka::Endpoint> state_endpoint_;
  std::uint32_t move_id_ = 0;
  bool motion_started_ = false;
  const char* end_reason_ = "";
};

}  // namespace fovea::sim
