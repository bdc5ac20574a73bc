// SPDX-License-Identifier: Apache-2.0
// A servo server on a board without a processor: what it sends is kept, and time passes when a test says so.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "firmware/core/link/servo_server.hpp"
#include "tests/core/task/task_on_ideal_arm.hpp"

namespace fovea::link {

struct FakeBoard final : Board {
  void Send(std::span<const std::uint8_t> bytes) noexcept override {
    sent.insert(sent.end(), bytes.begin(), bytes.end());
  }
  std::uint32_t TimerCounts() noexcept override { return counts += 10; }
  std::uint32_t StackBytes() noexcept override { return 1234; }
  [[nodiscard]] LineLosses Lost() noexcept override { return lost; }
  void RunTimer(bool on) noexcept override { timer_runs = on; }
  [[nodiscard]] std::uint32_t Periods() noexcept override { return periods; }
  void Provoke(Provocation /*what*/) noexcept override { ++provoked; }

  std::vector<std::uint8_t> sent;
  LineLosses lost;
  bool timer_runs = false;
  std::uint32_t periods = 0;
  std::uint32_t counts = 0;
  int provoked = 0;
};

class ServoServerTest : public task::ServoTaskTest {
 protected:
  void SetUp() override {
    ServoTaskTest::SetUp();
    arm_model_ = config_.arm;
  }

  void Give(const Frame& frame) { server_.Receive(writer_.Encode(frame)); }
  // Lets `periods` periods of the timer pass.
  void Pass(std::uint32_t periods) {
    board_.periods += periods;
    server_.Poll();
  }

  // Reads the last frame that the server sent since the previous call; false if none.
  bool Answered() {
    bool any = false;
    for (const std::uint8_t byte : board_.sent) {
      any = reader_.Add(byte) || any;
    }
    board_.sent.clear();
    return any;
  }

  Answer Configure(Pacing pacing, const std::function<void(Configuration&)>& change = {}) {
    Configuration c;
    c.pacing = pacing;
    c.servo = config_;
    c.arm_crc = ArmCrc(config_.arm);
    if (change) {
      change(c);
    }
    Give({FrameKind::kConfigure, 1, Encode(c, payload_)});
    Answer answer;
    EXPECT_TRUE(Answered());
    EXPECT_EQ(reader_.frame().kind, FrameKind::kAnswer);
    EXPECT_TRUE(Decode(reader_.frame().payload, answer));
    return answer;
  }

  Outputs Taken() {
    Outputs outputs;
    EXPECT_TRUE(Answered());
    EXPECT_EQ(reader_.frame().kind, FrameKind::kOutputs);
    EXPECT_TRUE(Decode(reader_.frame().payload, outputs));
    return outputs;
  }

  model::ArmModel arm_model_;
  FakeBoard board_;
  ServoServer server_{arm_model_, board_};
  FrameWriter writer_;
  FrameReader reader_;
  std::array<std::uint8_t, kMaxPayload> payload_{};
};

}  // namespace fovea::link
