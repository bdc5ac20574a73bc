// SPDX-License-Identifier: Apache-2.0
#include "sim/panda/session.hpp"

#include <utility>

namespace fovea::sim {

using franka::Command;
using franka::Header;

namespace {

constexpr std::size_t kMostToSend = 64 << 10;  // unsent bytes allowed in addition to a model library

}  // namespace

FciSession::FciSession(FciRobot& robot, franka::TcpConnection client,
                       const std::vector<std::byte>& model_library)
    : robot_(robot), client_(std::move(client)), model_library_(model_library) {}

bool FciSession::Serve() {
  Flush();
  Header header;
  std::span<const std::byte> payload;
  for (;;) {
    if (to_send_.size() > kMostToSend + model_library_.size()) {
      end_reason_ = "it does not read its answers";
      return false;
    }
    switch (stream_.Take(client_, header, payload)) {
      case franka::MessageStream::Next::kNothing: return true;
      case franka::MessageStream::Next::kMessage:
        if (!Do(header, payload)) {
          return false;
        }
        break;
      case franka::MessageStream::Next::kClosed: end_reason_ = "it closed the connection"; return false;
      case franka::MessageStream::Next::kGarbage: end_reason_ = "it sent an invalid message"; return false;
    }
  }
}

bool FciSession::TakeMotionStart() { return std::exchange(motion_started_, false); }

template <typename Payload>
void FciSession::Answer(const Header& header, const Payload& payload) {
  Send(franka::MakeMessage(header.command, header.command_id, payload));
}

void FciSession::Send(std::span<const std::byte> bytes) {
  to_send_.insert(to_send_.end(), bytes.begin(), bytes.end());
  Flush();
}

// Sends as much as the connection takes. The rest waits for the next call.
void FciSession::Flush() {
  const std::size_t sent = client_.SendSome(to_send_);
  to_send_.erase(to_send_.begin(), to_send_.begin() + static_cast<std::ptrdiff_t>(sent));
}

void FciSession::AnswerStatus(const Header& header, std::uint8_t status) {
  Answer(header, franka::StatusAnswer{status});
}

void FciSession::AnswerMoveEnd() {
  if (const auto end = robot_.TakeMoveEnd()) {
    AnswerStatus({Command::kMove, move_id_, 0}, static_cast<std::uint8_t>(*end));
  }
}

bool FciSession::Do(const Header& header, std::span<const std::byte> payload) {
  if (header.size != franka::RequestSize(header.command)) {
    end_reason_ = "it sent a request of the wrong length";
    return false;
  }
  if ((header.command == Command::kConnect) == state_endpoint_.has_value()) {
    end_reason_ = "it did not begin with Connect, or sent it twice";
    return false;
  }
  switch (header.command) {
    case Command::kConnect: return DoConnect(header, payload);
    case Command::kMove: DoMove(header, payload); break;
    case Command::kStopMove: AnswerStatus(header, static_cast<std::uint8_t>(robot_.StopMove())); break;
    case Command::kAutomaticErrorRecovery:
      AnswerStatus(header, static_cast<std::uint8_t>(robot_.Recover()));
      break;
    case Command::kGetCartesianLimit: {
      franka::GetCartesianLimitRequest request;
      franka::GetCartesianLimitAnswer answer;
      if (!franka::Decode(payload, request) || request.id < 0) {
        answer.status = franka::SetterStatus::kInvalidArgument;
      } else if (const auto wall = robot_.Wall(request.id)) {
        answer.size = ToArray(wall->size);
        answer.frame = ToArray(wall->X_BW);
        answer.active = 1;
      }
      Answer(header, answer);
      break;
    }
    case Command::kLoadModelLibrary: DoLoadModel(header, payload); break;
    default: AnswerStatus(header, static_cast<std::uint8_t>(robot_.Set(header.command, payload))); break;
  }
  return true;
}

bool FciSession::DoConnect(const Header& header, std::span<const std::byte> payload) {
  franka::ConnectRequest request;
  if (!franka::Decode(payload, request) || request.version != franka::kVersion) {
    Answer(header, franka::ConnectAnswer{franka::ConnectStatus::kIncompatibleVersion, franka::kVersion});
    end_reason_ = "it uses another protocol version";
    return false;
  }
  Answer(header, franka::ConnectAnswer{});
  state_endpoint_ = client_.peer();
  state_endpoint_->port = request.udp_port;
  return true;
}

void FciSession::DoLoadModel(const Header& header, std::span<const std::byte> payload) {
#if defined(__x86_64__)
  constexpr std::uint8_t kArchitecture = 0;
#elif defined(__aarch64__)
  constexpr std::uint8_t kArchitecture = 3;
#else
  constexpr std::uint8_t kArchitecture = 255;  // the interface has no number for it
#endif
  constexpr std::uint8_t kLinux = 0;
  franka::LoadModelRequest request;
  if (!franka::Decode(payload, request) || request.architecture != kArchitecture ||
      request.system != kLinux || model_library_.empty()) {
    AnswerStatus(header, static_cast<std::uint8_t>(franka::LoadModelStatus::kError));
    return;
  }
  const std::size_t size = franka::kHeaderSize + 1 + model_library_.size();
  Send(franka::Bytes(Header{header.command, header.command_id, static_cast<std::uint32_t>(size)}));
  Send(franka::Bytes(franka::StatusAnswer{}));
  Send(model_library_);
}

void FciSession::DoMove(const Header& header, std::span<const std::byte> payload) {
  franka::MoveRequest request;
  franka::MoveStatus status = franka::MoveStatus::kInvalidArgument;
  if (franka::Decode(payload, request)) {
    status = robot_.Move(request);
  }
  if (status == franka::MoveStatus::kMotionStarted) {
    move_id_ = header.command_id;
    motion_started_ = true;
  }
  AnswerStatus(header, static_cast<std::uint8_t>(status));
}

}  // namespace fovea::sim
