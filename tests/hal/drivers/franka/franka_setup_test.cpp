// SPDX-License-Identifier: Apache-2.0
// Connecting to the robot; each refusal is one clear line.
#include <gmock/gmock.h>

#include "tests/hal/drivers/franka/fake_robot.hpp"

namespace fovea::test {
namespace {

using franka::NetworkError;
using testing::HasSubstr;

// The driver's error when `robot` runs `script` during the connection; empty if there is none.
std::string Refusal(FakeRobot& robot, const std::function<void()>& script) {
  std::jthread other(script);
  try {
    const franka::FrankaArm arm(ConfigFor(robot));
  } catch (const NetworkError& error) {
    return error.what();
  }
  return {};
}

TEST(FrankaSetUp, SendsTheConfiguredSettings) {
  FakeRobot robot;
  franka::FrankaConfig config = ConfigFor(robot);
  config.load.mass = 0.7;
  config.load.F_x_Cload = {0.01, 0.02, 0.03};
  config.NE_T_EE[14] = 0.1034;
  config.EE_T_K[12] = 0.05;
  config.collision.upper_force_nominal[5] = 77.0;
  std::jthread other([&] { EXPECT_TRUE(robot.ServeSetUp()); });
  const franka::FrankaArm arm(config);
  other.join();
  ASSERT_EQ(robot.requests.size(), 5U);
  franka::ConnectRequest connect;
  ASSERT_TRUE(franka::Decode(robot.requests[0].payload, connect));
  EXPECT_EQ(connect.version, 5);
  EXPECT_NE(connect.udp_port, 0);
  franka::CollisionBehavior collision;
  franka::FramePose ne_to_ee;
  franka::FramePose ee_to_k;
  franka::Load load;
  ASSERT_TRUE(franka::Decode(robot.requests[1].payload, collision));
  ASSERT_TRUE(franka::Decode(robot.requests[2].payload, ne_to_ee));
  ASSERT_TRUE(franka::Decode(robot.requests[3].payload, ee_to_k));
  ASSERT_TRUE(franka::Decode(robot.requests[4].payload, load));
  EXPECT_EQ(collision.upper_force_nominal[5], 77.0);
  EXPECT_EQ(ne_to_ee.pose[14], 0.1034);
  EXPECT_EQ(ee_to_k.pose[12], 0.05);
  EXPECT_EQ(load.mass, 0.7);
  EXPECT_EQ(load.F_x_Cload[2], 0.03);
  for (std::uint32_t k = 0; k < 5; ++k) {
    EXPECT_EQ(robot.requests[k].header.command_id, k) << "ids count from 0";
    EXPECT_EQ(robot.requests[k].header.size, franka::RequestSize(robot.requests[k].header.command));
  }
  EXPECT_EQ(arm.robot_state().message_id, 1000U);
  EXPECT_TRUE(arm.paces_loop());
  EXPECT_EQ(arm.num_joints(), 7);
}

TEST(FrankaSetUp, NoListenerIsReported) {
  franka::FrankaConfig config;
  config.host = "127.0.0.1";
  {
    const franka::TcpListener gone(kLoopback);
    config.port = gone.port();
  }
  try {
    const franka::FrankaArm arm(config);
    FAIL() << "there is no robot";
  } catch (const NetworkError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("robot 127.0.0.1:" + std::to_string(config.port) + ": no connection"));
  }
}

TEST(FrankaSetUp, UnknownHostIsReported) {
  franka::FrankaConfig config;
  config.host = "no such host";
  try {
    const franka::FrankaArm arm(config);
    FAIL() << "there is no such host";
  } catch (const NetworkError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is not a known host"));
  }
}

TEST(FrankaSetUp, AnotherProtocolVersionIsRefused) {
  FakeRobot robot;
  EXPECT_THAT(Refusal(robot,
                      [&] {
                        robot.Accept();
                        robot.Answer(*robot.Take(),
                                     franka::ConnectAnswer{franka::ConnectStatus::kIncompatibleVersion, 4});
                      }),
              HasSubstr("it speaks version 4 of the Franka Control Interface, this driver speaks version 5"));
}

TEST(FrankaSetUp, SilentRobotTimesOut) {
  FakeRobot robot;
  EXPECT_THAT(Refusal(robot, [&] { robot.Accept(); }), HasSubstr("no answer to Connect within 300 ms"));
}

TEST(FrankaSetUp, IncompleteAnswerTimesOut) {
  FakeRobot robot;
  EXPECT_THAT(Refusal(robot,
                      [&] {
                        robot.Accept();
                        const auto hello = robot.Take();
                        const auto whole =
                            franka::MakeMessage(hello->header.command, 0, franka::ConnectAnswer{});
                        robot.SendRaw({whole.begin(), whole.begin() + 13});
                      }),
              HasSubstr("no whole answer to Connect within 300 ms"));
}

TEST(FrankaSetUp, GarbageAnswerIsRefused) {
  FakeRobot robot;
  EXPECT_THAT(Refusal(robot,
                      [&] {
                        robot.Accept();
                        robot.Take();
                        robot.SendRaw(std::vector<std::byte>(64, std::byte{0xA5}));
                      }),
              HasSubstr("Connect was answered with an invalid message"));
}

TEST(FrankaSetUp, AnswerOfTheWrongLengthIsRefused) {
  FakeRobot robot;
  EXPECT_THAT(Refusal(robot,
                      [&] {
                        robot.Accept();
                        robot.AnswerStatus(*robot.Take(), 0);
                      }),
              HasSubstr("Connect was answered with 13 bytes; 15 are expected"));
}

TEST(FrankaSetUp, ConnectionClosedAtConnectIsReported) {
  FakeRobot robot;
  EXPECT_THAT(Refusal(robot,
                      [&] {
                        robot.Accept();
                        robot.Close();
                      }),
              HasSubstr("it closed the connection at Connect; is another client in control?"));
}

TEST(FrankaSetUp, RefusedSetterIsNamed) {
  FakeRobot robot;
  EXPECT_THAT(Refusal(robot,
                      [&] {
                        robot.Accept();
                        robot.Answer(*robot.Take(), franka::ConnectAnswer{});
                        robot.AnswerStatus(*robot.Take(), 2);
                      }),
              HasSubstr("SetCollisionBehavior is refused: invalid argument"));
}

TEST(FrankaSetUp, RobotSendingNoStatesIsReported) {
  FakeRobot robot;
  EXPECT_THAT(Refusal(robot,
                      [&] {
                        robot.Accept();
                        robot.Answer(*robot.Take(), franka::ConnectAnswer{});
                        for (int k = 0; k < 4; ++k) {
                          robot.AnswerStatus(*robot.Take(), 0);
                        }
                      }),
              HasSubstr("it sends no states to UDP port"));
}

TEST(FrankaSetUp, OccupiedPortIsReported) {
  const franka::TcpListener first(kLoopback);
  try {
    const franka::TcpListener second({kLoopback.ip, first.port()});
    FAIL() << "two cannot listen on one port";
  } catch (const NetworkError& error) {
    EXPECT_THAT(error.what(), HasSubstr("cannot listen on 127.0.0.1:" + std::to_string(first.port())));
  }
}

}  // namespace
}  // namespace fovea::test
