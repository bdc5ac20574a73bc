// SPDX-License-Identifier: Apache-2.0
// A robot that sends arbitrary bytes: during the set-up, as states and as answers. The driver refuses them
// with a one-line error or goes on. Its torque commands stay finite.
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "fovea/franka/franka_arm.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"

using fovea::fuzz::Require;
using namespace fovea;
using namespace fovea::franka;

namespace {

constexpr Endpoint kLoopback{0x7F000001, 0};
constexpr int kMostSteps = 60;

std::vector<std::byte> Some(fuzz::Bytes& input, std::size_t size) {
  const auto taken = input.Take(size);
  const auto bytes = std::as_bytes(taken);
  return {bytes.begin(), bytes.end()};
}

class AnyRobot {
 public:
  explicit AnyRobot(fuzz::Bytes& input) : input_(input) { state_.robot_mode = RobotMode::kIdle; }

  [[nodiscard]] std::uint16_t port() const { return listener_.port(); }

  // Answers the driver's requests during the set-up; wrongly where the input says so.
  void ServeSetUp() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    for (int answered = 0; answered < 5 && std::chrono::steady_clock::now() < end;) {
      if (!tcp_.open()) {
        if (auto client = listener_.Accept()) {
          tcp_ = std::move(*client);
        }
        continue;
      }
      Header header;
      std::span<const std::byte> payload;
      switch (stream_.Take(tcp_, header, payload)) {
        case MessageStream::Next::kMessage: break;
        case MessageStream::Next::kNothing: std::this_thread::yield(); continue;
        default: return;
      }
      if (ConnectRequest hello; answered == 0 && Decode(payload, hello)) {
        driver_ = kLoopback;
        driver_.port = hello.udp_port;
      }
      ++answered;
      if (!AnswerSetUp(header)) {
        tcp_.Close();
        return;
      }
    }
    SendState(/*spoilt=*/false);
  }

  void Step() {
    switch (input_.Byte() % 8) {
      case 0: SendState(/*spoilt=*/true); break;
      case 1: Datagram(Some(input_, input_.Byte() * 8U)); break;
      case 2: Send(Some(input_, input_.Byte())); break;
      case 3: {
        const auto command = static_cast<Command>(input_.Byte() % kCommands);
        Send(MakeMessage(command, input_.Byte(), StatusAnswer{input_.Byte()}));
        break;
      }
      case 4: state_.message_id += input_.Byte(); break;
      case 5: {
        const std::uint8_t what = input_.Byte();
        state_.robot_mode = static_cast<RobotMode>(what % 8U);
        state_.controller_mode = ControllerMode::kExternal;
        state_.motion_generator_mode = MotionGeneratorMode::kJointVelocity;
        state_.errors[what % state_.errors.size()] = what >> 7U;
        SendState(/*spoilt=*/false);
        break;
      }
      default: SendState(/*spoilt=*/false); break;
    }
  }

  // Closed here, so that the driver does not wait for the end of a motion.
  void Close() { tcp_.Close(); }

  void JudgeCommands() {
    std::array<std::byte, 2048> bytes;
    std::size_t size = 0;
    Endpoint from;
    while (udp_.Receive(bytes, size, from)) {
      RobotCommand command;
      Require(size == kCommandSize && Decode(std::span<const std::byte>(bytes).first(size), command),
              "a command has the right length");
      for (const double torque : command.tau_J_d) {
        Require(std::isfinite(torque), "a torque is finite");
      }
    }
  }

 private:
  bool AnswerSetUp(const Header& header) {
    switch (const std::uint8_t how = input_.Byte(); how % 16) {
      case 1: Send(Some(input_, input_.Byte())); return true;
      case 2: return false;
      case 3: Send(MakeMessage(header.command, header.command_id, StatusAnswer{input_.Byte()})); return true;
      case 4: Send(MakeMessage(header.command, header.command_id + 1, StatusAnswer{})); return true;
      case 5: SendState(/*spoilt=*/true); [[fallthrough]];
      default:
        if (header.command == Command::kConnect) {
          ConnectAnswer hello;
          hello.version = how % 16 == 6 ? std::uint16_t{4} : hello.version;
          Send(MakeMessage(header.command, header.command_id, hello));
        } else {
          Send(MakeMessage(header.command, header.command_id, StatusAnswer{}));
        }
        return true;
    }
  }
  void SendState(bool spoilt) {
    ++state_.message_id;
    auto bytes = Bytes(state_);
    for (int count = spoilt ? 1 + input_.Byte() % 4 : 0; count > 0; --count) {
      const std::size_t at = input_.Word() % bytes.size();
      const auto with = Some(input_, 8);
      std::copy_n(with.begin(), std::min(with.size(), bytes.size() - at),
                  bytes.begin() + static_cast<std::ptrdiff_t>(at));
    }
    Datagram(bytes);
  }
  void Datagram(std::span<const std::byte> bytes) { static_cast<void>(udp_.Send(bytes, driver_)); }
  void Send(std::span<const std::byte> bytes) {
    if (tcp_.open()) {
      static_cast<void>(tcp_.Send(bytes));
    }
  }

  fuzz::Bytes& input_;
  TcpListener listener_{kLoopback};
  UdpSocket udp_{kLoopback};
  TcpConnection tcp_;
  MessageStream stream_;
  Endpoint driver_ = kLoopback;
  RobotState state_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes input(data, size);
  AnyRobot robot(input);
  FrankaConfig config;
  config.host = "127.0.0.1";
  config.port = robot.port();
  config.answer_timeout_ms = 20;
  config.state_timeout_ns = 0;
  std::jthread server([&robot] { robot.ServeSetUp(); });
  try {
    FrankaArm arm(config);
    server.join();
    hal::ArmState state;
    hal::ArmCommand command;
    command.num_joints = kJoints;
    for (int step = 0; step < kMostSteps && !input.empty(); ++step) {
      robot.Step();
      if (arm.Read(state).ok()) {
        Require(state.num_joints == kJoints, "a state has the robot's number of joints");
      }
      const std::uint8_t wish = input.Byte();
      command.tau_cmd[wish % kJoints] = wish - 128.0;
      command.engage_brakes = wish % 16 == 0;
      static_cast<void>(arm.Write(command));
      if (wish % 32 == 1) {
        arm.AskRecovery();
      }
      robot.JudgeCommands();
    }
    robot.Close();
  } catch (const NetworkError& error) {
    const std::string words = error.what();
    Require(!words.empty() && words.find('\n') == std::string::npos, "an error message is one line");
  }
  return 0;
}
