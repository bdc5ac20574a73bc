// SPDX-License-Identifier: Apache-2.0
// Connecting and setting up: once, before the loop. May block, allocate and throw.
#include <chrono>

#include "fovea/franka/franka_arm.hpp"

namespace fovea::franka {
namespace {

using SteadyClock = std::chrono::steady_clock;

std::int64_t LeftNs(SteadyClock::time_point deadline) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(deadline - SteadyClock::now()).count();
}

const char* InWords(SetterStatus status) {
  return status == SetterStatus::kNotPossibleNow    ? "not possible now"
         : status == SetterStatus::kInvalidArgument ? "invalid argument"
                                                    : "an unknown status";
}

}  // namespace

FrankaArm::FrankaArm(const FrankaConfig& config, RobotClock* robot_time)
    : Arm(kJoints, /*paces_loop=*/true),
      robot_("robot " + config.host + ":" + std::to_string(config.port)),
      answer_timeout_ms_(config.answer_timeout_ms),
      state_timeout_ns_(config.state_timeout_ns),
      allow_motion_(config.allow_motion),
      torque_rate_(config.torque_step_max),
      robot_time_(robot_time) {
  try {
    SetUp(config);
  } catch (const NetworkError& error) {
    throw NetworkError(robot_ + ": " + error.what());
  }
}

FrankaArm::~FrankaArm() { Stop(); }

void FrankaArm::SetUp(const FrankaConfig& config) {
  robot_tcp_ = Resolve(config.host, config.port);
  tcp_ = TcpConnection::Connect(robot_tcp_, answer_timeout_ms_);
  udp_ = UdpSocket(Endpoint{tcp_.own().ip, 0});  // only on the robot's network
  const auto hello = Request<ConnectRequest, ConnectAnswer>(Command::kConnect, {kVersion, udp_.port()});
  if (hello.status != ConnectStatus::kSuccess || hello.version != kVersion) {
    throw NetworkError("it speaks version " + std::to_string(hello.version) +
                       " of the Franka Control Interface, this driver speaks version " +
                       std::to_string(kVersion));
  }
  Set(Command::kSetCollisionBehavior, config.collision);
  Set(Command::kSetNEToEE, FramePose{config.NE_T_EE});
  Set(Command::kSetEEToK, FramePose{config.EE_T_K});
  Set(Command::kSetLoad, config.load);
  const auto deadline = SteadyClock::now() + std::chrono::milliseconds(answer_timeout_ms_);
  while (!TakeStates()) {
    if (LeftNs(deadline) <= 0) {
      throw NetworkError("it sends no states to UDP port " + std::to_string(udp_.port()) + " within " +
                         std::to_string(answer_timeout_ms_) + " ms; does a firewall block them?");
    }
    const std::array fds{udp_.fd()};
    WaitReadable(fds, LeftNs(deadline));
  }
  counters_ = FrankaCounters{};  // drop the counts of states that queued during the set-up
}

template <typename Payload, typename Answer>
Answer FrankaArm::Request(Command command, const Payload& payload) {
  std::uint32_t id = 0;
  if (!Post(command, payload, id)) {
    throw NetworkError(std::string(Name(command)) + " could not be sent");
  }
  const auto deadline = SteadyClock::now() + std::chrono::milliseconds(answer_timeout_ms_);
  for (;;) {
    Header header;
    std::span<const std::byte> bytes;
    switch (stream_.Take(tcp_, header, bytes)) {
      case MessageStream::Next::kMessage: {
        Answer answer;
        if (header.command != command || header.command_id != id) {
          break;
        }
        if (bytes.size() != WireSize<Answer>() || !Decode(bytes, answer)) {
          throw NetworkError(std::string(Name(command)) + " was answered with " +
                             std::to_string(bytes.size() + kHeaderSize) + " bytes; " +
                             std::to_string(WireSize<Answer>() + kHeaderSize) + " are expected");
        }
        return answer;
      }
      case MessageStream::Next::kNothing: break;
      case MessageStream::Next::kClosed:
        throw NetworkError(std::string("it closed the connection at ") + Name(command) +
                           "; is another client in control?");
      case MessageStream::Next::kGarbage:
        throw NetworkError(std::string(Name(command)) + " was answered with an invalid message");
    }
    if (LeftNs(deadline) <= 0) {
      throw NetworkError(std::string("no ") + (stream_.HasPart() ? "whole " : "") + "answer to " +
                         Name(command) + " within " + std::to_string(answer_timeout_ms_) + " ms");
    }
    const std::array fds{tcp_.fd()};
    WaitReadable(fds, LeftNs(deadline));
  }
}

template <typename Payload>
void FrankaArm::Set(Command command, const Payload& payload) {
  const auto answer = Request<Payload, StatusAnswer>(command, payload);
  if (const auto status = static_cast<SetterStatus>(answer.status); status != SetterStatus::kSuccess) {
    throw NetworkError(std::string(Name(command)) + " is refused: " + InWords(status));
  }
}

}  // namespace fovea::franka
