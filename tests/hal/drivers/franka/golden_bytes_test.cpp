// SPDX-License-Identifier: Apache-2.0
// Message layouts. The offsets are typed here a second time, from the interface's table.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "fovea/franka/errors.hpp"
#include "fovea/franka/messages.hpp"

namespace fovea::franka {
namespace {

double DoubleAt(std::span<const std::byte> bytes, std::size_t offset) {
  double value = 0.0;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

std::string Hex(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    constexpr char kDigits[] = "0123456789abcdef";
    text += kDigits[std::to_integer<unsigned>(byte) >> 4U];
    text += kDigits[std::to_integer<unsigned>(byte) & 15U];
  }
  return text;
}

struct Place {
  const char* field;
  std::size_t offset;
  std::size_t count;  // of doubles
};

constexpr Place kStateDoubles[] = {
    {"O_T_EE", 8, 16},
    {"O_T_EE_d", 136, 16},
    {"F_T_EE", 264, 16},
    {"EE_T_K", 392, 16},
    {"F_T_NE", 520, 16},
    {"NE_T_EE", 648, 16},
    {"m_ee", 776, 1},
    {"I_ee", 784, 9},
    {"F_x_Cee", 856, 3},
    {"m_load", 880, 1},
    {"I_load", 888, 9},
    {"F_x_Cload", 960, 3},
    {"elbow", 984, 2},
    {"elbow_d", 1000, 2},
    {"tau_J", 1016, 7},
    {"tau_J_d", 1072, 7},
    {"dtau_J", 1128, 7},
    {"q", 1184, 7},
    {"q_d", 1240, 7},
    {"dq", 1296, 7},
    {"dq_d", 1352, 7},
    {"ddq_d", 1408, 7},
    {"joint_contact", 1464, 7},
    {"cartesian_contact", 1520, 6},
    {"joint_collision", 1568, 7},
    {"cartesian_collision", 1624, 6},
    {"tau_ext_hat_filtered", 1672, 7},
    {"O_F_ext_hat_K", 1728, 6},
    {"K_F_ext_hat_K", 1776, 6},
    {"O_dP_EE_d", 1824, 6},
    {"O_ddP_O", 1872, 3},
    {"elbow_c", 1896, 2},
    {"delbow_c", 1912, 2},
    {"ddelbow_c", 1928, 2},
    {"O_T_EE_c", 1944, 16},
    {"O_dP_EE_c", 2072, 6},
    {"O_ddP_EE_c", 2120, 6},
    {"theta", 2168, 7},
    {"dtheta", 2224, 7},
    {"success rate", 2365, 1},
};

// Each double of the test state holds its own offset and must be decoded into the right field.
TEST(GoldenBytes, StateFieldsAreAtTheirOffsets) {
  std::vector<std::byte> bytes(2373, std::byte{0xEE});
  for (const Place& place : kStateDoubles) {
    for (std::size_t k = 0; k < place.count; ++k) {
      const auto value = static_cast<double>(place.offset + 8 * k);
      std::memcpy(bytes.data() + place.offset + 8 * k, &value, sizeof(value));
    }
  }
  const std::uint64_t id = 0x1122334455667788U;
  std::memcpy(bytes.data(), &id, sizeof(id));
  bytes[2280] = std::byte{2};
  bytes[2281] = std::byte{1};
  for (std::size_t k = 0; k < 41; ++k) {
    bytes[2282 + k] = std::byte(k);
    bytes[2323 + k] = std::byte(100 + k);
  }
  bytes[2364] = std::byte{5};

  RobotState s;
  ASSERT_TRUE(Decode(bytes, s));
  EXPECT_EQ(s.message_id, id);
  EXPECT_EQ(s.O_T_EE[0], 8.0);
  EXPECT_EQ(s.O_T_EE_d[15], 136.0 + 120.0);
  EXPECT_EQ(s.F_T_EE[0], 264.0);
  EXPECT_EQ(s.EE_T_K[0], 392.0);
  EXPECT_EQ(s.F_T_NE[0], 520.0);
  EXPECT_EQ(s.NE_T_EE[0], 648.0);
  EXPECT_EQ(s.m_ee, 776.0);
  EXPECT_EQ(s.I_ee[0], 784.0);
  EXPECT_EQ(s.F_x_Cee[0], 856.0);
  EXPECT_EQ(s.m_load, 880.0);
  EXPECT_EQ(s.I_load[8], 888.0 + 64.0);
  EXPECT_EQ(s.F_x_Cload[0], 960.0);
  EXPECT_EQ(s.elbow[0], 984.0);
  EXPECT_EQ(s.elbow_d[1], 1008.0);
  EXPECT_EQ(s.tau_J[0], 1016.0);
  EXPECT_EQ(s.tau_J_d[0], 1072.0);
  EXPECT_EQ(s.dtau_J[6], 1128.0 + 48.0);
  EXPECT_EQ(s.q[0], 1184.0);
  EXPECT_EQ(s.q_d[0], 1240.0);
  EXPECT_EQ(s.dq[0], 1296.0);
  EXPECT_EQ(s.dq_d[0], 1352.0);
  EXPECT_EQ(s.ddq_d[0], 1408.0);
  EXPECT_EQ(s.joint_contact[0], 1464.0);
  EXPECT_EQ(s.cartesian_contact[0], 1520.0);
  EXPECT_EQ(s.joint_collision[0], 1568.0);
  EXPECT_EQ(s.cartesian_collision[0], 1624.0);
  EXPECT_EQ(s.tau_ext_hat_filtered[0], 1672.0);
  EXPECT_EQ(s.O_F_ext_hat_K[0], 1728.0);
  EXPECT_EQ(s.K_F_ext_hat_K[0], 1776.0);
  EXPECT_EQ(s.O_dP_EE_d[0], 1824.0);
  EXPECT_EQ(s.O_ddP_O[0], 1872.0);
  EXPECT_EQ(s.elbow_c[0], 1896.0);
  EXPECT_EQ(s.delbow_c[0], 1912.0);
  EXPECT_EQ(s.ddelbow_c[0], 1928.0);
  EXPECT_EQ(s.O_T_EE_c[0], 1944.0);
  EXPECT_EQ(s.O_dP_EE_c[0], 2072.0);
  EXPECT_EQ(s.O_ddP_EE_c[0], 2120.0);
  EXPECT_EQ(s.theta[0], 2168.0);
  EXPECT_EQ(s.dtheta[0], 2224.0);
  EXPECT_EQ(s.motion_generator_mode, MotionGeneratorMode::kJointVelocity);
  EXPECT_EQ(s.controller_mode, ControllerMode::kCartesianImpedance);
  EXPECT_EQ(s.errors[40], 40);
  EXPECT_EQ(s.reflex_reason[40], 140);
  EXPECT_EQ(s.robot_mode, RobotMode::kUserStopped);
  EXPECT_EQ(s.control_command_success_rate, 2365.0);

  const auto again = Bytes(s);
  EXPECT_EQ(std::vector<std::byte>(again.begin(), again.end()), bytes);
}

TEST(GoldenBytes, ShortStateIsRefused) {
  std::vector<std::byte> bytes(2372);
  RobotState s;
  s.message_id = 7;
  EXPECT_FALSE(Decode(bytes, s));
  EXPECT_EQ(s.message_id, 7U);
}

TEST(GoldenBytes, CommandFieldsAreAtTheirOffsets) {
  RobotCommand c;
  c.message_id = 0x0102030405060708U;
  for (std::size_t k = 0; k < 7; ++k) {
    c.q_c[k] = 10.0 + static_cast<double>(k);
    c.dq_c[k] = 20.0 + static_cast<double>(k);
    c.tau_J_d[k] = 30.0 + static_cast<double>(k);
  }
  c.O_T_EE_c[15] = 40.0;
  c.O_dP_EE_c[5] = 50.0;
  c.elbow_c = {60.0, 61.0};
  c.valid_elbow = 1;
  c.motion_generation_finished = 2;
  const auto bytes = Bytes(c);
  ASSERT_EQ(bytes.size(), 370U);
  EXPECT_EQ(Hex(std::span(bytes).first(8)), "0807060504030201");
  EXPECT_EQ(DoubleAt(bytes, 8), 10.0);
  EXPECT_EQ(DoubleAt(bytes, 64), 20.0);
  EXPECT_EQ(DoubleAt(bytes, 120 + 15 * 8), 40.0);
  EXPECT_EQ(DoubleAt(bytes, 248 + 5 * 8), 50.0);
  EXPECT_EQ(DoubleAt(bytes, 296), 60.0);
  EXPECT_EQ(DoubleAt(bytes, 304), 61.0);
  EXPECT_EQ(bytes[312], std::byte{1});
  EXPECT_EQ(bytes[313], std::byte{2});
  EXPECT_EQ(DoubleAt(bytes, 314), 30.0);
  EXPECT_EQ(DoubleAt(bytes, 362), 36.0);
}

TEST(GoldenBytes, RequestsMatchByteForByte) {
  EXPECT_EQ(Hex(MakeMessage(Command::kConnect, 0, ConnectRequest{5, 0xABCD})),
            "000000000000000010000000"
            "0500"
            "cdab");
  EXPECT_EQ(Hex(MakeMessage(Command::kStopMove, 3, Nothing{})), "02000000030000000c000000");
  EXPECT_EQ(Hex(MakeMessage(Command::kAutomaticErrorRecovery, 258, Nothing{})), "0c000000020100000c000000");
  EXPECT_EQ(Hex(MakeMessage(Command::kGetCartesianLimit, 1, GetCartesianLimitRequest{-2})),
            "030000000100000010000000"
            "feffffff");
  const std::string move = Hex(MakeMessage(Command::kMove, 9, MoveRequest{}));
  EXPECT_EQ(move.substr(0, 40),
            "010000000900000044000000"
            "02000000"
            "01000000");
  EXPECT_EQ(move.substr(40, 16), "0000000000002440") << "10.0";
  EXPECT_EQ(Hex(MakeMessage(Command::kConnect, 0, ConnectAnswer{ConnectStatus::kIncompatibleVersion, 4})),
            "00000000000000000f000000"
            "01"
            "0400");
}

TEST(GoldenBytes, MessageSizesMatchTheProtocol) {
  struct Row {
    Command command;
    std::size_t request;
  };
  for (const Row& row :
       {Row{Command::kConnect, 16}, Row{Command::kMove, 68}, Row{Command::kStopMove, 12},
        Row{Command::kGetCartesianLimit, 16}, Row{Command::kSetCollisionBehavior, 428},
        Row{Command::kSetJointImpedance, 68}, Row{Command::kSetCartesianImpedance, 60},
        Row{Command::kSetGuidingMode, 19}, Row{Command::kSetEEToK, 140}, Row{Command::kSetNEToEE, 140},
        Row{Command::kSetLoad, 116}, Row{Command::kSetFilters, 52}, Row{Command::kAutomaticErrorRecovery, 12},
        Row{Command::kLoadModelLibrary, 14}}) {
    EXPECT_EQ(RequestSize(row.command), row.request) << Name(row.command);
  }
  EXPECT_EQ(RequestSize(static_cast<Command>(14)), 0U);
  EXPECT_EQ(MakeMessage(Command::kMove, 0, StatusAnswer{}).size(), 13U);
  EXPECT_EQ(MakeMessage(Command::kConnect, 0, ConnectAnswer{}).size(), 15U);
  EXPECT_EQ(MakeMessage(Command::kGetCartesianLimit, 0, GetCartesianLimitAnswer{}).size(), 166U);
}

TEST(GoldenBytes, ErrorNumbersMatchTheirNames) {
  EXPECT_STREQ(Name(static_cast<Error>(0)), "joint_position_limits_violation");
  EXPECT_EQ(static_cast<int>(Error::kJointReflex), 6);
  EXPECT_EQ(static_cast<int>(Error::kJointPositionStartPoseInvalid), 11);
  EXPECT_EQ(static_cast<int>(Error::kCartesianPositionStartPoseInvalid), 16);
  EXPECT_EQ(static_cast<int>(Error::kCommunicationConstraints), 25);
  EXPECT_EQ(static_cast<int>(Error::kCartesianPositionInvalidFrame), 31);
  EXPECT_EQ(static_cast<int>(Error::kControllerTorqueDiscontinuity), 32);
  EXPECT_EQ(static_cast<int>(Error::kTauJRange), 34);
  EXPECT_EQ(static_cast<int>(Error::kBaseAccelerationInvalid), 40);
  EXPECT_STREQ(Name(Error::kCommunicationConstraints), "communication_constraints_violation");
  EXPECT_STREQ(Name(static_cast<Error>(41)), "none");
  ErrorFlags flags{};
  EXPECT_STREQ(FirstError(flags), "none");
  flags[32] = 1;
  EXPECT_STREQ(FirstError(flags), "controller_torque_discontinuity");
}

}  // namespace
}  // namespace fovea::franka
