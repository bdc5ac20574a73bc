// SPDX-License-Identifier: Apache-2.0
// The servo's image on an emulated Cortex-M7: its contents, and its reaction to failures.
#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <string>

#include "firmware/core/link/frame.hpp"
#include "firmware/core/link/messages.hpp"
#include "sim/mcu/qemu.hpp"
#include "tests/arch/source_tree.hpp"
#include "tests/support/ideal_arm.hpp"
#include "tests/support/panda.hpp"
#include "tools/bench/mcu/link_map.hpp"

namespace fovea {
namespace {

using namespace std::chrono_literals;

class BoardTest : public testing::Test {
 protected:
  // Waits for the next frame of `kind`, kept in reader_. False if none arrives within `limit`.
  bool Await(link::FrameKind kind, std::chrono::seconds limit = 20s) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (std::chrono::steady_clock::now() < end && !board_.gone()) {
      while (!left_.empty()) {
        const std::uint8_t byte = left_.front();
        left_ = left_.subspan(1);
        if (reader_.Add(byte) && reader_.frame().kind == kind) {
          return true;
        }
      }
      left_ = board_.Receive(received_, 100);
    }
    return false;
  }
  void Send(link::FrameKind kind, std::uint32_t sequence, std::span<const std::uint8_t> payload) {
    ASSERT_TRUE(board_.Send(writer_.Encode({kind, sequence, payload})));
  }
  void Configure(link::Pacing pacing) {
    ASSERT_TRUE(Await(link::FrameKind::kHello));
    link::Configuration c;
    c.pacing = pacing;
    c.may_provoke = true;
    c.servo = test::PandaConfig();
    c.arm_crc = link::ArmCrc(c.servo.arm);
    Send(link::FrameKind::kConfigure, 0, link::Encode(c, payload_));
    ASSERT_TRUE(Await(link::FrameKind::kAnswer));
    link::Answer answer;
    ASSERT_TRUE(link::Decode(reader_.frame().payload, answer));
    ASSERT_EQ(answer.code, hal::StatusCode::kOk) << answer.where.data();
  }
  void SendState(std::uint32_t sequence) {
    task::ServoInputs inputs;
    inputs.arm = arm_.State();
    arm_.Step();
    Send(link::FrameKind::kInputs, sequence, link::Encode(inputs, payload_));
  }
  // The next tick's outputs.
  link::Outputs Outputs() {
    link::Outputs outputs;
    EXPECT_TRUE(Await(link::FrameKind::kOutputs));
    EXPECT_TRUE(link::Decode(reader_.frame().payload, outputs));
    return outputs;
  }
  // For the gated timer: the outputs of the next tick.
  link::Outputs Go() {
    Send(link::FrameKind::kGo, ++goes_, {});
    return Outputs();
  }
  // Ticks with states until the servo holds the arm.
  link::Outputs Boot() {
    link::Outputs outputs;
    for (std::uint32_t k = 1; k <= 60; ++k) {
      SendState(k);
      outputs = Go();
    }
    EXPECT_EQ(outputs.record.mode, hal::Mode::kHold);
    EXPECT_EQ(outputs.line, link::LineCounters{});
    return outputs;
  }
  // Checks the reaction to a line without states.
  static void ExpectBrakes(const link::Outputs& outputs) {
    EXPECT_EQ(outputs.record.fault, hal::Fault::kArmLost);
    EXPECT_TRUE(outputs.record.command.engage_brakes);
    for (const double torque : outputs.record.command.tau_cmd) {
      EXPECT_EQ(torque, 0.0);
    }
  }
  static constexpr std::uint32_t kLongest = 3000;  // ticks until the brakes close, with a wide margin

  sim::Qemu board_{{FOVEA_MCU_IMAGE, 4}};
  test::IdealArm arm_{test::PandaConfig().arm, test::Ready()};
  link::FrameWriter writer_;
  link::FrameReader reader_;
  std::array<std::uint8_t, link::kMaxPayload> payload_{};
  std::array<std::uint8_t, 4096> received_{};
  std::span<const std::uint8_t> left_;
  std::uint32_t goes_ = 0;
};

TEST(McuImage, ContainsNoHeapOrStreamSymbols) {
  const std::string symbols = test::OutputOf("arm-none-eabi-nm -C '" FOVEA_MCU_IMAGE "'");
  ASSERT_NE(symbols.find("fovea::task::ServoTask::Step"), std::string::npos) << "no symbols were read";
  for (const char* forbidden : {"malloc", "calloc", "realloc", " free", "operator new", "operator delete",
                                "_sbrk", "printf", "fwrite", "__cxa_throw", "__cxa_guard"}) {
    EXPECT_EQ(symbols.find(forbidden), std::string::npos) << forbidden;
  }
}

// The sizes that fovea-bench mcu prints.
TEST(McuImage, ModuleSizesAddUpToTheSections) {
  const bench::LinkMap map = bench::ReadLinkMap(FOVEA_MCU_MAP);
  bench::ModuleBytes sum;
  for (const auto& [module, bytes] : map.modules) {
    sum.flash += bytes.flash;
    sum.ram += bytes.ram;
    std::cout << module << ": " << bytes.flash << " bytes of flash, " << bytes.ram << " of RAM\n";
  }
  EXPECT_EQ(sum.flash, map.total.flash);
  EXPECT_EQ(sum.ram, map.total.ram);
  EXPECT_GT(map.modules.at("servo").flash, 0U);
  EXPECT_FALSE(map.modules.contains("other"));
}

TEST_F(BoardTest, SilentLineRaisesArmLost) {
  Configure(link::Pacing::kGated);
  link::Outputs outputs = Boot();
  std::uint32_t until_fault = 0;
  std::uint32_t ticks = 0;
  for (; ticks < kLongest && !outputs.record.command.engage_brakes; ++ticks) {
    outputs = Go();
    until_fault += outputs.record.fault == hal::Fault::kNone ? 1U : 0U;
  }
  std::cout << "bridged for " << until_fault << " silent ticks, brakes after " << ticks << '\n';
  EXPECT_EQ(until_fault + 1, static_cast<std::uint32_t>(test::PandaConfig().safety.arm_lost_ticks));
  EXPECT_EQ(outputs.line.silent_ticks, ticks);
  ExpectBrakes(outputs);
}

TEST_F(BoardTest, StormOfBadChecksumsRaisesArmLost) {
  Configure(link::Pacing::kGated);
  link::Outputs outputs = Boot();
  std::uint32_t ticks = 0;
  for (; ticks < kLongest && !outputs.record.command.engage_brakes; ++ticks) {
    task::ServoInputs inputs;
    inputs.arm = arm_.State();
    const auto frame =
        writer_.Encode({link::FrameKind::kInputs, 10'000 + ticks, link::Encode(inputs, payload_)});
    std::vector<std::uint8_t> bad(frame.begin(), frame.end());
    bad[bad.size() / 2] ^= 0x55;
    ASSERT_TRUE(board_.Send(bad));
    outputs = Go();
  }
  std::cout << outputs.line.damaged_frames << " frames damaged, brakes after " << ticks << " ticks\n";
  ExpectBrakes(outputs);
  EXPECT_EQ(outputs.line.damaged_frames, ticks);
  EXPECT_EQ(outputs.line.silent_ticks, ticks);
}

// The free-running timer: the board goes on with or without the host.
TEST_F(BoardTest, OwnTimerTicksWithoutTheHost) {
  Configure(link::Pacing::kTimer);
  const std::uint64_t first = Outputs().record.tick;
  link::Outputs outputs;
  for (int k = 0; k < 50; ++k) {
    outputs = Outputs();
  }
  EXPECT_GE(outputs.record.tick, first + 50);  // outputs without room on the line are skipped
  EXPECT_GE(outputs.line.silent_ticks, 50U);
  EXPECT_EQ(outputs.record.fault, hal::Fault::kArmLost);
}

TEST_F(BoardTest, DisabledFloatingPointUnitReportsACrashAndStops) {
  Configure(link::Pacing::kLockstep);
  SendState(1);
  static_cast<void>(Outputs());
  Send(link::FrameKind::kProvoke, 2, link::Encode(link::Provocation::kUsageFault, payload_));
  ASSERT_TRUE(Await(link::FrameKind::kCrash));
  link::Crash crash;
  ASSERT_TRUE(link::Decode(reader_.frame().payload, crash));
  constexpr std::uint32_t kNoCoprocessor = 1U << 19U;
  EXPECT_EQ(crash.exception, 6U);
  EXPECT_NE(crash.cfsr & kNoCoprocessor, 0U);
  EXPECT_GT(crash.pc, 0U);
  SendState(3);
  EXPECT_FALSE(Await(link::FrameKind::kOutputs, 2s));
}

}  // namespace
}  // namespace fovea
