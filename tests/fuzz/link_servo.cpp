// SPDX-License-Identifier: Apache-2.0
// The servo's end of the link: frames of any kind with any payload, valid and broken, in any order, with
// timer periods in between. The servo keeps its torques within their limits and goes on ticking.
#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/core/link/servo_server.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/support/panda.hpp"

using fovea::fuzz::Require;
using namespace fovea;
using namespace fovea::link;

namespace {

// Judges what the servo sends.
class Judge final : public Board {
 public:
  explicit Judge(const model::ArmModel& arm) : arm_(arm) {}
  void Send(std::span<const std::uint8_t> bytes) noexcept override {
    for (const std::uint8_t byte : bytes) {
      if (reader_.Add(byte) && reader_.frame().kind == FrameKind::kOutputs) {
        Require(Decode(reader_.frame().payload, outputs_), "outputs decode as a message");
        for (int i = 0; i < arm_.num_joints; ++i) {
          const auto k = static_cast<std::size_t>(i);
          Require(std::fabs(outputs_.record.command.tau_cmd[k]) <= arm_.joints[k].tau_max,
                  "a torque is within its limit");
        }
      }
    }
    Require(reader_.counters().damaged == 0 && reader_.counters().unknown == 0,
            "the servo sends only valid frames");
  }
  [[nodiscard]] std::uint32_t TimerCounts() noexcept override { return counts_ += 10; }
  [[nodiscard]] std::uint32_t StackBytes() noexcept override { return 0; }
  [[nodiscard]] LineLosses Lost() noexcept override { return {}; }
  void RunTimer(bool on) noexcept override { timer_runs_ = on; }
  [[nodiscard]] std::uint32_t Periods() noexcept override { return periods_; }
  void Provoke(Provocation /*what*/) noexcept override {}
  void Pass(std::uint32_t periods) { periods_ += timer_runs_ ? periods : 0; }

 private:
  const model::ArmModel& arm_;
  FrameReader reader_;
  Outputs outputs_;
  bool timer_runs_ = false;
  std::uint32_t counts_ = 0;
  std::uint32_t periods_ = 0;
};

const config::ServoConfig& Config() {
  static const config::ServoConfig config = test::PandaConfig();
  return config;
}

// A valid state with some bytes overwritten.
std::vector<std::uint8_t> SpoiltInputs(fuzz::Bytes& input, std::int64_t stamp_ns) {
  std::array<std::uint8_t, kMaxPayload> storage;
  task::ServoInputs in;
  in.arm.stamp_ns = stamp_ns;
  in.arm.num_joints = Config().arm.num_joints;
  std::copy_n(Config().arm.q_ready.begin(), in.arm.num_joints, in.arm.q.begin());
  in.has_feature = (input.Byte() & 1U) != 0;
  in.feature.found = true;
  in.feature.dim = 3;
  in.feature.stamp_ns = stamp_ns;
  in.feature.confidence = 1.0;
  in.feature.s = {0.1, 0.1, 10.0};
  const Bytes sound = Encode(in, storage);
  std::vector<std::uint8_t> bytes(sound.begin(), sound.end());
  for (int spoilt = input.Byte() % 4; spoilt > 0; --spoilt) {
    const std::size_t at = input.Word() % bytes.size();
    const std::span<const std::uint8_t> with = input.Take(8);
    std::copy_n(with.begin(), std::min(with.size(), bytes.size() - at),
                bytes.begin() + static_cast<std::ptrdiff_t>(at));
  }
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kMostSteps = 100;
  fuzz::Bytes input(data, size);
  Judge judge(Config().arm);
  ServoServer server(Config().arm, judge);
  FrameWriter writer;
  std::array<std::uint8_t, kMaxPayload> storage;
  Configuration configuration;
  configuration.servo = Config();
  configuration.arm_crc = ArmCrc(Config().arm);
  configuration.pacing = static_cast<Pacing>(input.Byte() % kNumPacings);
  server.Receive(writer.Encode({FrameKind::kConfigure, 0, Encode(configuration, storage)}));
  std::uint32_t sequence = 0;
  for (int step = 0; step < kMostSteps && !input.empty(); ++step) {
    const std::int64_t stamp_ns = step * hal::kTickPeriodNs;
    switch (input.Byte() % 6) {
      case 0:
        server.Receive(writer.Encode({FrameKind::kInputs, ++sequence, SpoiltInputs(input, stamp_ns)}));
        break;
      case 1:
        server.Receive(writer.Encode({FrameKind::kInputs, input.Word(), SpoiltInputs(input, stamp_ns)}));
        break;
      case 2: server.Receive(input.Take(input.Byte())); break;
      case 3: {
        const auto kind = static_cast<FrameKind>(1 + input.Byte() % static_cast<int>(FrameKind::kGo));
        const std::size_t length = 16U * input.Byte();
        server.Receive(writer.Encode({kind, input.Word(), input.Take(length)}));
        break;
      }
      case 4: server.Receive(writer.Encode({FrameKind::kGo, input.Byte(), {}})); break;
      default: judge.Pass(input.Byte() % 32U); break;
    }
    server.Poll();
  }
  return 0;
}
