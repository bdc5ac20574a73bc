// SPDX-License-Identifier: Apache-2.0
// A client that sends arbitrary data to the simulated robot: valid and broken requests, and commands with any
// numbers. The robot's state stays finite, and the robot goes on.
#include <sys/socket.h>

#include <cmath>
#include <vector>

#include "sim/panda/command_intake.hpp"
#include "sim/panda/robot.hpp"
#include "sim/panda/session.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/support/places.hpp"

using fovea::fuzz::Require;
using namespace fovea;

namespace {

constexpr int kMostSteps = 40;

const sim::WorldConfig& PandaWorld() {
  static const sim::WorldConfig config = [] {
    sim::WorldConfig made;
    made.robot = sim::LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
    made.q_start.resize(7);
    made.q_start << 0.0, -0.7, 0.0, -2.2, 0.0, 1.6, 0.7;
    return made;
  }();
  return config;
}

// Both ends of one connection.
struct Line {
  Line() {
    int ends[2];
    Require(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends) == 0, "a pair of sockets");
    client = franka::TcpConnection(franka::Descriptor(ends[0]));
    server = franka::TcpConnection(franka::Descriptor(ends[1]));
  }
  franka::TcpConnection client;
  franka::TcpConnection server;
};

void Judge(const franka::RobotState& state) {
  for (const auto& values : {state.q, state.dq, state.tau_J, state.q_d, state.dq_d, state.tau_J_d}) {
    for (const double value : values) {
      Require(std::isfinite(value), "the robot's state is finite");
    }
  }
}

// A valid command with some bytes overwritten.
franka::RobotCommand SpoiltCommand(fuzz::Bytes& input, const franka::RobotState& state) {
  franka::RobotCommand command;
  command.message_id = state.message_id;
  command.q_c = state.q_d;
  command.O_T_EE_c = state.O_T_EE_d;
  command.elbow_c = state.elbow_d;
  auto bytes = franka::Bytes(command);
  for (int count = input.Byte() % 4; count > 0; --count) {
    const std::size_t at = input.Word() % bytes.size();
    const auto with = std::as_bytes(input.Take(8));
    std::copy_n(with.begin(), std::min(with.size(), bytes.size() - at),
                bytes.begin() + static_cast<std::ptrdiff_t>(at));
  }
  static_cast<void>(franka::Decode(bytes, command));
  return command;
}

std::vector<std::byte> Request(fuzz::Bytes& input, std::uint32_t id) {
  const auto command = static_cast<franka::Command>(input.Byte() % franka::kCommands);
  const std::size_t size = franka::RequestSize(command);
  const franka::Header header{command, id, static_cast<std::uint32_t>(size)};
  const auto head = franka::Bytes(header);
  std::vector<std::byte> bytes(head.begin(), head.end());
  bytes.resize(size);
  const auto payload = std::as_bytes(input.Take(std::min<std::size_t>(input.Byte(), size - head.size())));
  std::copy(payload.begin(), payload.end(), bytes.begin() + static_cast<std::ptrdiff_t>(head.size()));
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes input(data, size);
  sim::World world(PandaWorld());
  sim::FciRobot robot(world, PandaWorld().robot, {});
  Line line;
  static const std::vector<std::byte> library(100);
  sim::FciSession session(robot, std::move(line.server), library);
  sim::CommandIntake intake(5);
  std::uint32_t id = 0;
  const auto hello = franka::MakeMessage(franka::Command::kConnect, id++, franka::ConnectRequest{});
  if (input.Byte() % 16 != 0) {
    static_cast<void>(line.client.Send(hello));
  }
  bool open = true;
  for (int step = 0; step < kMostSteps && !input.empty(); ++step) {
    switch (input.Byte() % 8) {
      case 0: static_cast<void>(line.client.Send(std::as_bytes(input.Take(input.Byte())))); break;
      case 1: static_cast<void>(line.client.Send(Request(input, id++))); break;
      case 2: {
        franka::MoveRequest move;
        const std::uint8_t how = input.Byte();
        move.controller = static_cast<franka::MoveController>(how % 4U);
        move.generator = static_cast<franka::MoveGenerator>(how / 4U % 4U);
        static_cast<void>(line.client.Send(franka::MakeMessage(franka::Command::kMove, id++, move)));
        break;
      }
      case 3: robot.UserStop(input.Byte() % 2 == 0); break;
      case 4: robot.PressGuiding(input.Byte() % 2 == 0); break;
      default: intake.Put(SpoiltCommand(input, robot.state())); break;
    }
    if (open && !session.Serve()) {
      open = false;
      robot.Abandon();
    }
    if (session.TakeMotionStart()) {
      intake.Begin(robot.state().message_id);
    }
    robot.Step(robot.moving() ? intake.Take(robot.state().message_id) : std::nullopt);
    Judge(robot.state());
    if (open) {
      session.AnswerMoveEnd();
    }
    std::array<std::byte, 4096> answers;
    std::size_t got = 0;
    while (line.client.Receive(answers, got) == franka::Received::kSome) {
    }
  }
  return 0;
}
