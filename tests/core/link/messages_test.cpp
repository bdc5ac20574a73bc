// SPDX-License-Identifier: Apache-2.0
// Messages: round trips keep every field, and bytes that are no message are refused.
#include "firmware/core/link/messages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string_view>
#include <vector>

#include "firmware/core/link/frame.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::link {
namespace {

// Add a new field of one of these structs to the message on the line first, then change its size here.
static_assert(sizeof(moves::MotionCommand) == 304);
static_assert(sizeof(hal::ArmState) == 280);
static_assert(sizeof(hal::FeatureMeasurement) == 1016);
static_assert(sizeof(hal::WayNote) == 40);
static_assert(sizeof(trajectory::PlanHead) == 88);
static_assert(sizeof(trajectory::PlanPart) == 432);
static_assert(sizeof(hal::TickRecord) == 2112);
static_assert(sizeof(LineCounters) == 24);
static_assert(sizeof(Outputs) == 2112 + 4 * (kNumStages + 4) + sizeof(LineCounters));

std::array<std::uint8_t, kMaxPayload> storage;

template <class Message>
std::vector<std::uint8_t> BytesOf(const Message& message) {
  const Bytes bytes = Encode(message, storage);
  return {bytes.begin(), bytes.end()};
}

// Decoded bytes must encode to the same bytes: every field is restored.
template <class Message>
void ExpectComesBack(const Message& message) {
  const std::vector<std::uint8_t> bytes = BytesOf(message);
  ASSERT_FALSE(bytes.empty());
  Message back{};
  ASSERT_TRUE(Decode(bytes, back));
  EXPECT_EQ(BytesOf(back), bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(Decode(Bytes(bytes).first(size), back)) << size << " of " << bytes.size();
  }
  std::vector<std::uint8_t> longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(Decode(longer, back));
}

class Values {
 public:
  explicit Values(unsigned seed) : engine_(seed) {}
  double Number() { return std::uniform_real_distribution<double>(-9.0, 9.0)(engine_); }
  template <class Array>
  void Fill(Array& array) {
    for (double& value : array) {
      value = Number();
    }
  }

 private:
  std::mt19937_64 engine_;
};

trajectory::PlanPart SomePart(Values& values) {
  trajectory::PlanPart part;
  part.head.outcome = trajectory::PlanOutcome::kFound;
  part.head.blocker = hal::Limit::kFieldOfView;
  part.head.num_joints = 7;
  part.head.num_points = 200;
  part.head.turn = 3;
  part.head.stamp_ns = -987654321012345;
  part.head.period_s = values.Number();
  values.Fill(part.head.p_BO);
  values.Fill(part.head.q_BO);
  part.first = 1358;
  part.count = trajectory::PlanPart::kMostNumbers;
  values.Fill(part.numbers);
  return part;
}

task::ServoInputs SomeInputs(Values& values) {
  task::ServoInputs in;
  in.arm_status = hal::Status(hal::StatusCode::kTimeout, "arm");
  in.arm.stamp_ns = -123456789012345;
  in.arm.sequence = 0xfedcba9876543210U;
  in.arm.num_joints = 7;
  values.Fill(in.arm.q);
  values.Fill(in.arm.dq);
  values.Fill(in.arm.tau_meas);
  values.Fill(in.arm.tau_applied);
  in.has_feature = true;
  in.feature.stamp_ns = 77;
  in.feature.sequence = 5;
  in.feature.kind = hal::FeatureKind::kTriangle;
  in.feature.found = true;
  in.feature.confidence = std::nan("");
  in.feature.dim = 6;
  values.Fill(in.feature.s);
  values.Fill(in.feature.cov_s);
  in.feature.num_poses = 4;
  for (hal::FlatPose& pose : in.feature.poses) {
    values.Fill(pose.p_CO_C);
    values.Fill(pose.q_CO);
    pose.first = 2;
  }
  in.request = task::Request::kTrack;
  in.motion.kind = moves::MotionKind::kPoseSetpoint;
  values.Fill(in.motion.q);
  values.Fill(in.motion.p_BE);
  in.change_law = true;
  in.law = config::MotionLawKind::kFloat;
  in.tuning = {12, values.Number()};
  in.plan = SomePart(values);
  in.missed_ticks = -3;
  return in;
}

TEST(Messages, RoundTripKeepsEveryField) {
  Values values(3);
  ExpectComesBack(SomeInputs(values));
  ExpectComesBack(task::ServoInputs{});

  Configuration configuration;
  configuration.servo = test::PandaConfig();
  configuration.pacing = Pacing::kTimer;
  configuration.arm_crc = 0xdeadbeef;
  configuration.load.mass = 0.3;
  configuration.servo.guard.obstacles.num_boxes = 3;
  configuration.servo.law.lambda = 1.25;
  ExpectComesBack(configuration);

  Outputs outputs;
  outputs.record.mode = hal::Mode::kMove;
  outputs.record.hold_reason = hal::HoldReason::kNotFollowed;
  outputs.record.fault = hal::Fault::kContact;
  ExpectComesBack(outputs);
  outputs.record.tuning = {hal::TuningResult::kOutOfRange, -5, values.Number(), std::nan("")};
  values.Fill(outputs.record.command.tau_cmd);
  outputs.record.way = {hal::Way::kPlan, hal::PlanEvent::kDone, 5, -6, 7, {}};
  values.Fill(outputs.record.way.normal_B);
  outputs.stage_counts[3] = 4711;
  outputs.link_counts = 12;
  outputs.periods_passed = 13;
  outputs.line = {1, 2, 3, 4, 5, 6};
  ExpectComesBack(outputs);
  Outputs back;
  ASSERT_TRUE(Decode(BytesOf(outputs), back));
  EXPECT_EQ(back.line, outputs.line);
  EXPECT_EQ(back.record.tuning.key, -5);
  EXPECT_EQ(back.record.tuning.before, outputs.record.tuning.before);
  EXPECT_EQ(back.record.way.way, hal::Way::kPlan);
  EXPECT_EQ(back.record.way.event, hal::PlanEvent::kDone);
  EXPECT_EQ(back.record.way.tries, -6);
  EXPECT_EQ(back.record.way.normal_B, outputs.record.way.normal_B);
  EXPECT_EQ(back.link_counts, outputs.link_counts);
  EXPECT_EQ(back.periods_passed, outputs.periods_passed);

  Answer answer;
  answer.code = hal::StatusCode::kOutOfRange;
  std::ranges::copy(std::string_view("law.lambda"), answer.where.data());
  ExpectComesBack(answer);
  ExpectComesBack(Crash{6, 1, 2, 3, 4});
  ExpectComesBack(Provocation::kUsageFault);
}

TEST(Messages, CountsAndEnumsOutOfRangeAreRefused) {
  task::ServoInputs in;
  in.arm.num_joints = hal::kMaxJoints + 1;
  EXPECT_TRUE(BytesOf(in).empty());
  std::vector<std::uint8_t> bytes = BytesOf(task::ServoInputs{});
  task::ServoInputs back;
  bytes[0] = 200;  // not a StatusCode
  EXPECT_FALSE(Decode(bytes, back));
  bytes[0] = 0;
  ASSERT_TRUE(Decode(bytes, back));
  bytes[1 + 16] = 9;  // num_joints
  EXPECT_FALSE(Decode(bytes, back));
  EXPECT_LE(back.arm.num_joints, hal::kMaxJoints);
}

TEST(Messages, PartOfAPlanComesBackWhole) {
  Values values(4);
  task::ServoInputs in;
  in.plan = SomePart(values);
  task::ServoInputs back;
  ASSERT_TRUE(Decode(BytesOf(in), back));
  EXPECT_EQ(back.plan.first, in.plan.first);
  EXPECT_EQ(back.plan.count, in.plan.count);
  EXPECT_EQ(back.plan.numbers, in.plan.numbers);
  EXPECT_EQ(back.plan.head.outcome, in.plan.head.outcome);
  EXPECT_EQ(back.plan.head.num_points, 200);
  EXPECT_EQ(back.plan.head.stamp_ns, in.plan.head.stamp_ns);
  EXPECT_EQ(back.plan.head.q_BO, in.plan.head.q_BO);
  for (const int count : {0, 1, 41}) {
    in.plan.count = count;
    ExpectComesBack(in);
    ASSERT_TRUE(Decode(BytesOf(in), back));
    EXPECT_EQ(back.plan.count, count);
    EXPECT_TRUE(back.plan.IsThere());
  }
  in.plan.count = -1;
  ASSERT_TRUE(Decode(BytesOf(in), back)) << "into inputs that held a part";
  EXPECT_FALSE(back.plan.IsThere());
}

TEST(Messages, PartOfAPlanWithASizeOutOfRangeIsRefused) {
  const auto is_refused = [](const auto& change) {
    Values values(5);
    task::ServoInputs in;
    in.plan = SomePart(values);
    change(in.plan);
    return BytesOf(in).empty();
  };
  EXPECT_FALSE(is_refused([](trajectory::PlanPart&) {}));
  EXPECT_TRUE(is_refused([](trajectory::PlanPart& p) { p.count = trajectory::PlanPart::kMostNumbers + 1; }));
  EXPECT_TRUE(is_refused([](trajectory::PlanPart& p) { p.count = -2; }));
  EXPECT_TRUE(is_refused([](trajectory::PlanPart& p) { p.first = -1; }));
  EXPECT_TRUE(is_refused([](trajectory::PlanPart& p) { p.first = trajectory::Plan::kMostNumbers + 1; }));
  EXPECT_TRUE(is_refused([](trajectory::PlanPart& p) { p.head.num_joints = hal::kMaxJoints + 1; }));
  EXPECT_TRUE(is_refused([](trajectory::PlanPart& p) { p.head.num_joints = -1; }));
  EXPECT_TRUE(is_refused([](trajectory::PlanPart& p) { p.head.turn = 4; }));
  EXPECT_TRUE(is_refused([](trajectory::PlanPart& p) {
    p.head.outcome = static_cast<trajectory::PlanOutcome>(trajectory::kPlanOutcomeWords.size());
  }));
}

// Whatever the bytes are, all decoded values are in range.
TEST(Messages, RandomBytesDecodeOnlyToValuesInRange) {
  std::mt19937 engine(7);
  Values values(9);
  const std::vector<std::uint8_t> sound = BytesOf(SomeInputs(values));
  int taken = 0;
  for (int k = 0; k < test::Repetitions(20'000); ++k) {
    std::vector<std::uint8_t> bytes = sound;
    for (int i = 0; i < 4; ++i) {
      bytes[engine() % bytes.size()] = static_cast<std::uint8_t>(engine());
    }
    task::ServoInputs in;
    taken += Decode(bytes, in) ? 1 : 0;
    EXPECT_LE(in.arm.num_joints, hal::kMaxJoints);
    EXPECT_GE(in.arm.num_joints, 0);
    EXPECT_LE(in.feature.num_poses, hal::kMaxPoses);
    EXPECT_LE(in.feature.dim, hal::kMaxFeatureDim);
    EXPECT_LT(static_cast<int>(in.law), config::kNumMotionLaws);
    EXPECT_GE(in.plan.count, -1);
    EXPECT_LE(in.plan.count, trajectory::PlanPart::kMostNumbers);
    EXPECT_GE(in.plan.first, 0);
    EXPECT_LE(in.plan.first, trajectory::Plan::kMostNumbers);
  }
  EXPECT_GT(taken, 0);
}

TEST(Messages, ArmChecksumChangesWithItsParameters) {
  const model::ArmModel arm = test::Panda().model;
  model::ArmModel other = arm;
  other.joints[6].coulomb = std::nextafter(other.joints[6].coulomb, 1e9);
  EXPECT_NE(ArmCrc(other), ArmCrc(arm));
  other = arm;
  other.joints[6].rotor_inertia = 1e-15;
  EXPECT_NE(ArmCrc(other), ArmCrc(arm));
  other = arm;
  other.q_ready[0] += 1e-15;
  EXPECT_NE(ArmCrc(other), ArmCrc(arm));
  other = arm;
  other.shape.bodies[7].radius += 1e-15;
  EXPECT_NE(ArmCrc(other), ArmCrc(arm));
  other = arm;
  EXPECT_EQ(ArmCrc(other), ArmCrc(arm));
}

}  // namespace
}  // namespace fovea::link
