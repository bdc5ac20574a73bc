// SPDX-License-Identifier: Apache-2.0
// Client and server over loopback, with and without network faults, and the servo at one end.
#include <gmock/gmock.h>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/host/robots/robot.hpp"
#include "fovea/linux_rt/heap_counter.hpp"
#include "fovea/linux_rt/tick_meter.hpp"
#include "tests/sim/panda/wire_panda.hpp"
#include "tests/support/places.hpp"

namespace fovea::test {
namespace {

using hal::StatusCode;

// Commands a joint goal after half a second.
class GoSlowly final : public moves::MotionSource {
 public:
  explicit GoSlowly(const hal::JointArray& goal) : goal_(goal) {}
  moves::MotionCommand At(std::int64_t now_ns) noexcept override {
    begin_ns_ = begin_ns_ < 0 ? now_ns : begin_ns_;
    moves::MotionCommand command;
    if (now_ns - begin_ns_ > hal::kNsPerSecond / 2) {
      command.kind = moves::MotionKind::kJointGoal;
      command.q = goal_;
    }
    return command;
  }

 private:
  hal::JointArray goal_;
  std::int64_t begin_ns_ = -1;
};

class Keeper final : public hal::Recorder {
 public:
  void Record(const hal::TickRecord& record) noexcept override {
    last = record;
    fault = fault == hal::Fault::kNone ? record.fault : fault;
    ticks.fetch_add(1, std::memory_order_relaxed);
    // A robot at rest waits for nobody, so a slow servo misses states until the first command has arrived.
    // The second tick's Read shows the last of these.
    if (arm != nullptr && arm->counters().commands <= 2) {
      lost_at_rest = arm->counters().lost_states;
    }
  }
  hal::TickRecord last;
  hal::Fault fault = hal::Fault::kNone;  // the first fault
  std::atomic<int> ticks{0};
  const franka::FrankaArm* arm = nullptr;
  std::uint64_t lost_at_rest = 0;
};

// The servo, with the robot on the network as its arm.
struct ServoOnWire {
  explicit ServoOnWire(const ServedPanda& served, std::int64_t state_timeout_ns = 3 * hal::kNsPerSecond)
      : arm(Client(served, state_timeout_ns), &clock) {
    const robots::Robot robot = robots::LoadRobot(test::RobotsFolder() + "/panda.toml");
    config::ServoConfig config;
    config.arm = robot.model;
    EXPECT_TRUE(task.Init(config).ok());
    hal::ArmState now;
    EXPECT_TRUE(arm.Read(now).ok());
    q_start = now.q;
    recorder.arm = &arm;
  }
  static franka::FrankaConfig Client(const ServedPanda& served, std::int64_t state_timeout_ns) {
    franka::FrankaConfig config = served.ClientConfig();
    config.state_timeout_ns = state_timeout_ns;
    return config;
  }
  // Runs for `duration_s` of the robot's time.
  hal::Status Run(double duration_s, moves::MotionSource& motion) {
    task::ServoLoop loop(task, arm, clock, features, recorder, meter);
    loop.UseMotion(motion);
    const hal::Status status = loop.Run(clock.NowNs() + static_cast<std::int64_t>(duration_s * 1e9));
    counters = loop.counters();
    return status;
  }

  franka::RobotClock clock;
  franka::FrankaArm arm;
  task::ServoTask task;
  hal::FeatureMailbox features;
  Keeper recorder;
  linux_rt::TickMeter meter;
  task::LoopCounters counters;
  hal::JointArray q_start{};
};

TEST(ServoOnTheWire, HoldsAndMovesThePandaInLockstep) {
  ServedPanda served(Lockstep());
  ServoOnWire servo(served);
  hal::JointArray goal = servo.q_start;
  for (std::size_t i = 0; i < 7; ++i) {
    goal[i] += i % 2 == 0 ? 0.15 : -0.15;
  }
  GoSlowly motion(goal);
  ASSERT_TRUE(servo.Run(3.0, motion).ok());
  const hal::ArmState& arm = servo.recorder.last.arm;
  double off = 0.0;
  for (std::size_t i = 0; i < 7; ++i) {
    off = std::max(off, std::fabs(arm.q[i] - goal[i]));
  }
  std::cout << "off its goal by " << off << " rad; " << servo.counters.ticks << " ticks, "
            << servo.arm.counters().commands << " commands, " << servo.arm.counters().rate_limited
            << " limited by the torque rate\n";
  EXPECT_LT(off, 3e-3) << "the error that friction leaves";
  EXPECT_EQ(servo.recorder.last.fault, hal::Fault::kNone);
  EXPECT_EQ(servo.counters.arm_read_errors, 0U);
  EXPECT_LE(servo.counters.missed_ticks, servo.arm.counters().skipped_states)
      << "missed before the motion, on a busy machine";
  EXPECT_EQ(servo.arm.counters().lost_states, servo.recorder.lost_at_rest) << "in motion the robot waits";
  EXPECT_GT(servo.arm.counters().commands, 1500U) << "most of the 3 s is motion";
  EXPECT_EQ(servo.arm.counters().rate_limited, 0U);
  EXPECT_EQ(servo.arm.robot_state().control_command_success_rate, 1.0);
#ifndef FOVEA_SANITIZED
  ASSERT_TRUE(linux_rt::HeapCounterActive());
  EXPECT_EQ(servo.meter.heap_calls(), 0U);
#endif
  servo.arm.Stop();
  served.Stop();
  EXPECT_EQ(served.server().counters().missing, 0U);
  EXPECT_EQ(served.panda().robot.state().robot_mode, franka::RobotMode::kIdle) << "stopped in order";
}

TEST(ServoOnTheWire, ReachesItsGoalOverABadNetwork) {
  sim::FciServerConfig config = Lockstep();
  config.faults.loss = 0.05;
  config.faults.jitter_ms = 2.0;
  config.faults.duplicate = 0.05;
  config.faults.reorder = 0.02;
  config.late_ms = 3;
  ServedPanda served(config);
  ServoOnWire servo(served);
  hal::JointArray goal = servo.q_start;
  goal[0] += 0.15;
  GoSlowly motion(goal);
  ASSERT_TRUE(servo.Run(3.0, motion).ok());
  const double off = std::fabs(servo.recorder.last.arm.q[0] - goal[0]);
  const franka::FrankaCounters& c = servo.arm.counters();
  std::cout << "off by " << off << " rad; states lost " << c.lost_states << ", repeated "
            << c.duplicate_states << "; success rate " << servo.arm.robot_state().control_command_success_rate
            << '\n';
  EXPECT_LT(off, 3e-3);
  EXPECT_EQ(servo.recorder.last.fault, hal::Fault::kNone);
  EXPECT_GT(c.lost_states, 50U);
  EXPECT_GT(c.duplicate_states, 50U);
  EXPECT_LT(servo.arm.robot_state().control_command_success_rate, 1.0);
  servo.arm.Stop();
}

TEST(FciWire, UncommandedRobotStopsAndRecoversOnRequest) {
  ServedPanda served(Lockstep());
  franka::FrankaConfig config = served.ClientConfig();
  config.state_timeout_ns = 20 * hal::kNsPerMs;  // some states will be lost
  franka::RobotClock clock;
  franka::FrankaArm arm(config, &clock);
  StartMotion(arm);
  hal::ArmState state;
  hal::ArmCommand command;
  command.num_joints = 7;
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(arm.Read(state).ok());
    ASSERT_TRUE(arm.Write(command).ok());
  }
  // All packets are lost from here on.
  served.server().SetLoss(1.0);
  hal::Status status = hal::Status::Ok();
  for (int k = 0; k < 400 && status.code() != StatusCode::kDeviceFault; ++k) {
    status = arm.Read(state);
    static_cast<void>(arm.Write(command));
    if (k == 5) {  // after 100 ms the robot has stopped, and can report it
      served.server().SetLoss(0.0);
    }
  }
  EXPECT_EQ(status.code(), StatusCode::kDeviceFault);
  EXPECT_STREQ(status.where(), "communication_constraints_violation");
  command.engage_brakes = true;  // the client knows that the motion has ended
  static_cast<void>(arm.Write(command));
  command.engage_brakes = false;
  arm.AskRecovery();
  for (int k = 0; k < 400 && arm.phase() != franka::MotionPhase::kIdle; ++k) {
    static_cast<void>(arm.Read(state));
  }
  StartMotion(arm);
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(arm.Read(state).ok());
    ASSERT_TRUE(arm.Write(command).ok());
  }
}

// A hung robot repeats one state: the number and all values stay the same.
TEST(ServoOnTheWire, HungRobotRaisesArmLostAndClosesTheBrakes) {
  ServedPanda served(Lockstep());
  ServoOnWire servo(served, 20 * hal::kNsPerMs);
  GoSlowly motion(servo.q_start);
  std::thread plug([&] {
    const auto wait_for = [&](int ticks) {
      while (servo.recorder.ticks < ticks) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    };
    wait_for(1000);
    served.server().Hang(true);
    wait_for(servo.recorder.ticks + 40);  // with and without states from before
    served.server().Hang(false);
  });
  ASSERT_TRUE(servo.Run(3.0, motion).ok());
  plug.join();
  const franka::FrankaCounters& c = servo.arm.counters();
  std::cout << c.duplicate_states << " states were repeated, " << c.timeouts
            << " waits for a new state timed out; " << hal::Name(servo.recorder.fault) << '\n';
  EXPECT_GT(c.duplicate_states, 100U);
  EXPECT_GE(c.timeouts, 20U) << "safety.arm_lost_ticks";
  EXPECT_EQ(servo.recorder.fault, hal::Fault::kArmLost);
  EXPECT_TRUE(servo.recorder.last.command.engage_brakes);
  servo.arm.Stop();
  served.Stop();
  EXPECT_EQ(served.panda().robot.state().robot_mode, franka::RobotMode::kIdle);
  EXPECT_EQ(franka::FirstError(served.panda().robot.state().reflex_reason), std::string("none"))
      << "after the hang the motion ended in order";
}

TEST(FciWire, StopButtonIsReportedAsAUserStop) {
  ServedPanda served(Lockstep());
  franka::FrankaArm arm(served.ClientConfig());
  StartMotion(arm);
  served.server().PressStop(true);
  hal::ArmState state;
  hal::ArmCommand command;
  command.num_joints = 7;
  hal::Status status = hal::Status::Ok();
  for (int k = 0; k < 400 && status.ok(); ++k) {
    status = arm.Read(state);
    static_cast<void>(arm.Write(command));
  }
  EXPECT_STREQ(status.where(), "user stop");
}

TEST(FciWire, SecondClientIsRefusedAndTheFirstGoesOn) {
  ServedPanda served(Lockstep());
  franka::FrankaArm first(served.ClientConfig());
  StartMotion(first);
  std::thread second([&] {
    try {
      const franka::FrankaArm arm(served.ClientConfig());
      ADD_FAILURE() << "two clients in control";
    } catch (const franka::NetworkError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("is another client in control?"));
    }
  });
  hal::ArmState state;
  hal::ArmCommand command;
  command.num_joints = 7;
  for (int k = 0; k < 200; ++k) {
    EXPECT_TRUE(first.Read(state).ok());
    EXPECT_TRUE(first.Write(command).ok());
  }
  second.join();
}

TEST(FciWire, VanishedClientLeavesTheRobotHolding) {
  ServedPanda served(Lockstep());
  {
    franka::FrankaArm arm(served.ClientConfig());
    StartMotion(arm);
  }
  franka::FrankaArm next(served.ClientConfig());
  EXPECT_EQ(next.robot_state().robot_mode, franka::RobotMode::kIdle);
  StartMotion(next);
}

// Garbage bytes do not disturb the robot.
TEST(FciWire, ConnectionSendingGarbageIsClosed) {
  ServedPanda served(Lockstep());
  const franka::Endpoint at{0x7F000001, served.port()};
  const std::vector<std::vector<std::byte>> kinds{
      std::vector<std::byte>(200, std::byte{0xFF}),                           // not a message
      std::vector<std::byte>(5, std::byte{0}),                                // half a header, then silence
      {std::byte{1}, {}, {}, {}, {}, {}, {}, {}, std::byte{12}, {}, {}, {}},  // Move before Connect, too
                                                                              // short
  };
  for (const auto& bytes : kinds) {
    franka::TcpConnection connection = franka::TcpConnection::Connect(at, 1000);
    EXPECT_TRUE(connection.Send(bytes));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    connection.Close();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  franka::FrankaArm arm(served.ClientConfig());
  StartMotion(arm);
}

TEST(FciWire, RealPaceSendsAThousandStatesPerSecond) {
  ServedPanda served(sim::FciServerConfig{});
  franka::FrankaArm arm(served.ClientConfig());
  hal::ArmState state;
  ASSERT_TRUE(arm.Read(state).ok());
  const std::uint64_t first = state.sequence;
  const franka::FrankaCounters before = arm.counters();
  const auto begin = std::chrono::steady_clock::now();
  while (state.sequence < first + 1000) {
    ASSERT_TRUE(arm.Read(state).ok());
  }
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::cout << state.sequence - first << " states in " << wall_s << " s, lost " << arm.counters().lost_states
            << ", skipped " << arm.counters().skipped_states << '\n';
  EXPECT_EQ(arm.counters().states - before.states + arm.counters().lost_states - before.lost_states,
            state.sequence - first);
  EXPECT_GT(wall_s, 0.95) << "not faster than real time";
}

}  // namespace
}  // namespace fovea::test
