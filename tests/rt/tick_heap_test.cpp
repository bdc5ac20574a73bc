// SPDX-License-Identifier: Apache-2.0
// No heap call in the whole tick, from reading the arm to the record, in every mode. The interposer counts
// the calls; if it is inactive, these tests fail.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "firmware/core/model/rotation.hpp"
#include "firmware/core/motion_laws/motion_laws.hpp"
#include "firmware/core/task/servo_loop.hpp"
#include "firmware/host/recording/flight/flight_recorder.hpp"
#include "fovea/hal/types.hpp"
#include "fovea/linux_rt/heap_counter.hpp"
#include "fovea/linux_rt/record_ring.hpp"
#include "fovea/linux_rt/tick_meter.hpp"
#include "tests/support/panda.hpp"

namespace fovea {
namespace {

// An arm without heap calls that stays at the ready posture.
class SteadyArm final : public hal::Arm {
 public:
  SteadyArm() : Arm(7, false) {
    state_.num_joints = 7;
    state_.q = test::Panda().model.q_ready;
  }
  void Advance() { state_.stamp_ns += hal::kTickPeriodNs; }
  hal::ArmState& state() { return state_; }

 private:
  hal::Status DoRead(hal::ArmState& state) noexcept override {
    state = state_;
    return hal::Status::Ok();
  }
  hal::Status DoWrite(const hal::ArmCommand& command) noexcept override {
    state_.tau_applied = command.tau_cmd;
    return hal::Status::Ok();
  }
  hal::ArmState state_;
};

class SteppingClock final : public hal::Clock {
 public:
  explicit SteppingClock(std::function<void(std::int64_t)> on_tick) : on_tick_(std::move(on_tick)) {}

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return now_ns_; }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override {
    now_ns_ = deadline_ns;
    on_tick_(now_ns_);
    return hal::Status::Ok();
  }
  std::int64_t now_ns_ = 0;
  std::function<void(std::int64_t)> on_tick_;
};

class TickHeapTest : public testing::Test {
 protected:
  void SetUp() override {
#ifdef FOVEA_SANITIZED
    GTEST_SKIP() << "a sanitizer replaces malloc";
#endif
    ASSERT_TRUE(linux_rt::HeapCounterActive())
        << "the interposer is not linked: a count of 0 would mean nothing";
    ASSERT_TRUE(task_.Init(test::PandaConfig()).ok());
  }

  // The ball is at its goal, so the arm need not move.
  void PutFeature(std::int64_t now_ns) {
    hal::FeatureMeasurement m;
    m.stamp_ns = now_ns - 20 * hal::kNsPerMs;
    m.found = true;
    m.dim = 3;
    m.s = {0.0, 0.0, 10.0};
    for (std::size_t i = 0; i < 3; ++i) {
      m.cov_s[i * hal::kMaxFeatureDim + i] = 1e-4;
    }
    mailbox_.Put(m);
  }

  task::ServoTask task_;
  SteadyArm arm_;
  hal::FeatureMailbox mailbox_;
  linux_rt::RecordRing ring_{8192};
  linux_rt::TickMeter meter_;
};

TEST_F(TickHeapTest, NoHeapCallInAnyMode) {
  int modes_seen = 0;
  SteppingClock clock([&](std::int64_t now_ns) {
    arm_.Advance();
    const std::int64_t ms = now_ns / hal::kNsPerMs;
    // The target is seen, lost for a while and seen again; then an encoder fails.
    if (ms > 60 && ms % 33 == 0 && (ms < 1000 || ms > 2500)) {
      PutFeature(now_ns);
    }
    if (ms > 4000) {
      arm_.state().q[2] = std::nan("");
    }
  });
  task::ServoLoop loop(task_, arm_, clock, mailbox_, ring_, meter_);
  ASSERT_TRUE(loop.Run(5 * hal::kNsPerSecond).ok());
  ring_.Drain([&](const hal::TickRecord& record) { modes_seen |= 1 << static_cast<int>(record.mode); });
  EXPECT_EQ(modes_seen, 0b11111) << "boot, hold, track, coast and fault all occur";
  EXPECT_EQ(meter_.durations().count(), 5000U);
  EXPECT_EQ(meter_.heap_calls(), 0U);
}

// Alternates joint goals and pose goals, about a hundred in all, each near the arm's posture.
class BusySource final : public moves::MotionSource {
 public:
  moves::MotionCommand At(std::int64_t now_ns) noexcept override {
    const std::int64_t ms = now_ns / hal::kNsPerMs;
    moves::MotionCommand command;
    if (ms < 100 || ms % 400 > 350) {
      return command;  // gaps without a command, in which the arm changes to Hold
    }
    command.kind = ms % 800 < 400 ? moves::MotionKind::kJointGoal : moves::MotionKind::kPoseGoal;
    command.q = test::Panda().model.q_ready;
    command.q[static_cast<std::size_t>(ms / 50 % 7)] += 0.005;
    model::ArmPoses poses;
    model::ComputePoses(test::Panda().model, model::ToVector(command.q, 7), poses);
    command.p_BE = {poses.X_BE.p.x(), poses.X_BE.p.y(), poses.X_BE.p.z()};
    const model::Vec3 phi = model::RotationVector(poses.X_BE.R);
    const double half = 0.5 * phi.norm();
    command.quaternion_BE = {std::cos(half), 0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < 3; ++i) {
      command.quaternion_BE[i + 1] = std::sin(half) * phi[static_cast<Eigen::Index>(i)] / phi.norm();
    }
    return command;
  }
};

TEST_F(TickHeapTest, NoHeapCallInCommandedMotionsAndWithAnyLaw) {
  config::ServoConfig config = test::PandaConfig();
  config.auto_track = false;
  config.guard.obstacles.num_planes = 1;
  config.guard.obstacles.num_boxes = 1;
  config.guard.obstacles.boxes[0] = {model::Vec3(0.9, 0.9, 0.0), model::Vec3(1.0, 1.0, 1.0)};
  config.guard.singularity_min = 0.15;  // near enough that each tick checks it
  config.motion_law.integral = 0.5;
  config.safety.contact_torque_fraction = config.safety.contact_sudden_fraction =
      1e3;                                  // the arm ignores its commands
  config.safety.non_finite_ticks = 10'000;  // and its readings never change
  config.safety.following_error = 1.0;
  config.motion_law.friction_compensation = 1.0;
  config.motion_law.k_p.fill(50.0);
  config.motion_law.k_v.fill(5.0);
  config.law.joint_limit_gain = 1.0;
  config.law.manipulability_gain = 0.05;
  ASSERT_TRUE(task_.Init(config).ok());
  task::ServoLoop* running = nullptr;
  SteppingClock clock([&](std::int64_t now_ns) {
    arm_.Advance();
    const std::int64_t ms = now_ns / hal::kNsPerMs;
    if (ms % 300 == 0) {
      running->Ask(
          motion_laws::kMotionLaws[static_cast<std::size_t>(ms / 300 % config::kNumMotionLaws)].kind);
    }
  });
  BusySource source;
  task::ServoLoop loop(task_, arm_, clock, mailbox_, ring_, meter_);
  loop.UseMotion(source);
  running = &loop;
  ASSERT_TRUE(loop.Run(5 * hal::kNsPerSecond).ok());
  int modes_seen = 0;
  ring_.Drain([&](const hal::TickRecord& record) { modes_seen |= 1 << static_cast<int>(record.mode); });
  EXPECT_EQ(modes_seen, (1 << static_cast<int>(hal::Mode::kBoot)) |
                            (1 << static_cast<int>(hal::Mode::kHold)) |
                            (1 << static_cast<int>(hal::Mode::kMove)));
  EXPECT_EQ(meter_.durations().count(), 5000U);
  EXPECT_EQ(meter_.heap_calls(), 0U);
}

// The recorder computes digests and keyframes in the tick.
TEST_F(TickHeapTest, NoHeapCallWithTheFlightRecorder) {
  flight::FlightRecorder recorder(task_, &task_, 4096);
  SteppingClock clock([&](std::int64_t now_ns) {
    arm_.Advance();
    if (now_ns / hal::kNsPerMs % 33 == 0) {
      PutFeature(now_ns);
    }
  });
  task::ServoLoop loop(recorder, arm_, clock, mailbox_, recorder, meter_);
  ASSERT_TRUE(loop.Run(3 * hal::kNsPerSecond).ok());
  int records = 0;
  int keyframes = 0;
  recorder.Drain([&](const flight::FlightRecord& record) { records += record.state_digest ? 1 : 0; },
                 [&](const flight::Keyframe&) { ++keyframes; });
  EXPECT_EQ(records, 3000);
  EXPECT_EQ(keyframes, 3);
  EXPECT_EQ(meter_.heap_calls(), 0U);
}

// A request in each tick: taken, refused, repeated; keys move all the time.
TEST_F(TickHeapTest, NoHeapCallWhileKeysChange) {
  flight::FlightRecorder recorder(task_, &task_, 4096);
  task::ServoLoop* running = nullptr;
  int unasked = 0;
  SteppingClock clock([&](std::int64_t now_ns) {
    arm_.Advance();
    const std::int64_t ms = now_ns / hal::kNsPerMs;
    if (ms % 33 == 0) {
      PutFeature(now_ns);
    }
    const auto key = static_cast<std::int32_t>(ms % config::kMostTunable);
    const double value = ms % 5 == 0 ? std::nan("") : 0.2 + 1e-4 * static_cast<double>(ms);
    unasked += running->Ask(config::Tuning{key, value}) ? 0 : 1;
  });
  task::ServoLoop loop(recorder, arm_, clock, mailbox_, recorder, meter_);
  running = &loop;
  ASSERT_TRUE(loop.Run(3 * hal::kNsPerSecond).ok());
  std::array<int, hal::kNumTuningResults> results{};
  int modes_seen = 0;
  recorder.Drain(
      [&](const flight::FlightRecord& record) {
        ++results.at(static_cast<std::size_t>(record.record.tuning.result));
        modes_seen |= 1 << static_cast<int>(record.record.mode);
      },
      [](const flight::Keyframe&) {});
  EXPECT_EQ(unasked, 0);
  EXPECT_GT(results[static_cast<std::size_t>(hal::TuningResult::kTaken)], 1000);
  EXPECT_GT(results[static_cast<std::size_t>(hal::TuningResult::kNotFinite)], 100);
  EXPECT_GT(results[static_cast<std::size_t>(hal::TuningResult::kUnknownKey)], 100);
  EXPECT_NE(modes_seen & (1 << static_cast<int>(hal::Mode::kTrack)), 0);
  EXPECT_EQ(meter_.durations().count(), 3000U);
  EXPECT_EQ(meter_.heap_calls(), 0U);
}

// Checks the check: a recorder that allocates is detected.
class AllocatingRecorder final : public hal::Recorder {
 public:
  void Record(const hal::TickRecord&) noexcept override {
    void* volatile block = std::malloc(1);
    std::free(block);
  }
};

TEST_F(TickHeapTest, HeapCallInTheTickIsCounted) {
  SteppingClock clock([&](std::int64_t) { arm_.Advance(); });
  AllocatingRecorder recorder;
  task::ServoLoop loop(task_, arm_, clock, mailbox_, recorder, meter_);
  ASSERT_TRUE(loop.Run(10 * hal::kNsPerMs).ok());
  EXPECT_EQ(meter_.heap_calls(), 20U);
}

}  // namespace
}  // namespace fovea
