// SPDX-License-Identifier: Apache-2.0
// The servo's state as bytes: a servo restored from them goes on bit-exactly, and the digest sees changes.
#include "firmware/core/link/state.hpp"

#include <gtest/gtest.h>

#include <array>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "firmware/core/link/frame.hpp"
#include "tests/support/servo_runs.hpp"

namespace fovea::link {
namespace {

// If a tick takes a new field of one of these structs from the tick before, add it to the stored state first
// (state_fields.hpp), then change the size here.
static_assert(sizeof(task::InputState) == 232);
static_assert(sizeof(estimate::ContactState) == 688);
static_assert(sizeof(estimate::PushWatch) == 80);
static_assert(sizeof(estimate::TargetFilter) == 824);
static_assert(sizeof(estimate::PoseHypotheses) == 20008);
static_assert(sizeof(estimate::PredictState) == 62304);
static_assert(sizeof(estimate::EncoderWatch) == 1096);
static_assert(sizeof(estimate::EyeWatch) == 232);
static_assert(sizeof(task::ModeState) == 5);
static_assert(sizeof(control::WayToGoal) == 840);
static_assert(sizeof(trajectory::PlanReceiver) == 14496);
static_assert(sizeof(control::ResolvedMotion) == 88);
static_assert(sizeof(moves::MotionState) == 16160);
static_assert(sizeof(motion_laws::MotionLawState) == 232);
static_assert(sizeof(task::TuningState) == 544);
static_assert(sizeof(task::ServoState) == 103344);

using Buffer = std::vector<std::uint8_t>;

Buffer BytesOf(const task::ServoState& state) {
  Buffer storage(kMaxState);
  const Bytes bytes = Encode(state, storage);
  EXPECT_FALSE(bytes.empty());
  return {bytes.begin(), bytes.end()};
}

Buffer BytesOf(const hal::TickRecord& record) {
  Buffer storage(kMaxPayload);
  Outputs outputs;
  outputs.record = record;
  const Bytes bytes = Encode(outputs, storage);
  EXPECT_FALSE(bytes.empty());
  return {bytes.begin(), bytes.end()};
}

// At every 250th tick of every run a second servo starts from the bytes of the state alone. Its outputs equal
// those of the first, bit by bit, to the end of the run.
TEST(ServoStateTest, RestoredServoContinuesBitExact) {
  constexpr std::size_t kEvery = 250;
  for (const test::ServoRun& run : test::AllServoRuns()) {
    task::ServoTask task;
    ASSERT_TRUE(task.Init(run.config).ok());
    std::vector<Buffer> records;
    std::vector<std::uint64_t> digests;
    std::vector<Buffer> keyframes;
    task::ServoOutputs outputs;
    for (std::size_t k = 0; k < run.inputs.size(); ++k) {
      if (k % kEvery == 0) {
        keyframes.push_back(BytesOf(task.state()));
      }
      task.Step(run.inputs[k], outputs);
      records.push_back(BytesOf(outputs.record));
      digests.push_back(DigestOf(run.config, task.state(), run.inputs[k].has_feature));
    }
    const Buffer end = BytesOf(task.state());
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
      auto next = std::make_unique<task::ServoTask>();
      ASSERT_TRUE(next->Init(run.config).ok());
      auto state = std::make_unique<task::ServoState>(next->state());
      ASSERT_TRUE(Decode(keyframes[i], *state));
      EXPECT_EQ(BytesOf(*state), keyframes[i]);
      next->Restore(*state);
      for (std::size_t k = i * kEvery; k < run.inputs.size(); ++k) {
        next->Step(run.inputs[k], outputs);
        ASSERT_EQ(BytesOf(outputs.record), records[k])
            << run.name << ", from " << i * kEvery << ", tick " << k;
        ASSERT_EQ(DigestOf(run.config, next->state(), run.inputs[k].has_feature), digests[k])
            << run.name << ", from " << i * kEvery << ", tick " << k;
      }
      ASSERT_EQ(BytesOf(next->state()), end) << run.name;
    }
    std::cout << run.name << ": " << end.size() << " bytes\n";
  }
}

TEST(ServoStateTest, BytesOfAnotherLengthAreRefused) {
  task::ServoTask task;
  ASSERT_TRUE(task.Init(test::PandaConfig()).ok());
  const Buffer bytes = BytesOf(task.state());
  auto state = std::make_unique<task::ServoState>(task.state());
  ASSERT_TRUE(Decode(bytes, *state));
  for (std::size_t size = 0; size < bytes.size(); size += 97) {
    EXPECT_FALSE(Decode(Bytes(bytes).first(size), *state)) << size;
  }
  Buffer longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(Decode(longer, *state));
}

// A change of any covered byte must change the digest. Tries every fifth byte whose change still decodes.
// `left_out`: the groups that the digest does not cover at the end of `run`, in `mode`.
void ExpectDigestToSeeAllBut(const std::set<std::string>& left_out, hal::Mode mode,
                             const test::ServoRun& run) {
  task::ServoTask task;
  ASSERT_TRUE(task.Init(run.config).ok());
  task::ServoOutputs outputs;
  for (const task::ServoInputs& inputs : run.inputs) {
    task.Step(inputs, outputs);
  }
  ASSERT_EQ(task.state().mode.mode, mode);
  const std::uint64_t digest = DigestOf(run.config, task.state(), true);
  const Buffer bytes = BytesOf(task.state());
  Buffer storage_a(kMaxState);
  Buffer storage_b(kMaxState);
  auto state = std::make_unique<task::ServoState>(task.state());
  EXPECT_EQ(FirstDifference(*state, task.state(), storage_a, storage_b), nullptr);
  std::set<std::string> tried;
  int seen = 0;
  for (std::size_t i = 0; i < bytes.size(); i += 5) {
    Buffer changed = bytes;
    changed[i] ^= 1U;
    *state = task.state();
    if (!Decode(changed, *state)) {
      continue;
    }
    const char* group = FirstDifference(task.state(), *state, storage_a, storage_b);
    ASSERT_NE(group, nullptr) << i;
    tried.insert(group);
    const bool differs = DigestOf(run.config, *state, true) != digest;
    seen += differs ? 1 : 0;
    if (std::string(group) == "end of the way") {
      EXPECT_FALSE(differs) << "it follows from the end of the plan";
      continue;
    }
    EXPECT_NE(differs, left_out.contains(group)) << "byte " << i << ", " << group;
  }
  std::cout << run.name << ": " << tried.size() << " groups, " << seen << " changes seen\n";
  EXPECT_GE(tried.size(), 14U);
  EXPECT_GT(seen, 350);
  for (const std::string& group : left_out) {
    EXPECT_TRUE(tried.contains(group)) << group;
  }
}

const std::set<std::string> kLeftOutInTrack{"joint history", "planned motion", "momentum", "commanded motion",
                                            "plan"};

// While a key moves, the digest covers the ramps.
TEST(ServoStateTest, DigestChangesWithEachRamp) {
  ExpectDigestToSeeAllBut(kLeftOutInTrack, hal::Mode::kTrack, test::TunedRun(600));
  const test::ServoRun run = test::TunedRun(600);
  task::ServoTask task;
  ASSERT_TRUE(task.Init(run.config).ok());
  task::ServoOutputs outputs;
  for (const task::ServoInputs& inputs : run.inputs) {
    task.Step(inputs, outputs);
  }
  ASSERT_TRUE(task.state().tuning.active);
  const std::uint64_t digest = DigestOf(run.config, task.state(), false);
  const auto changed = [&](const auto& change) {
    auto state = std::make_unique<task::ServoState>(task.state());
    change(state->tuning.ramps[0]);
    return DigestOf(run.config, *state, false) != digest;
  };
  EXPECT_FALSE(changed([](task::TuningState::Ramp&) {}));
  EXPECT_TRUE(changed([](task::TuningState::Ramp& ramp) { ramp.asked = false; }));
  EXPECT_TRUE(changed([](task::TuningState::Ramp& ramp) { ramp.from += 1e-12; }));
  EXPECT_TRUE(changed([](task::TuningState::Ramp& ramp) { ramp.to += 1e-12; }));
  EXPECT_TRUE(changed([](task::TuningState::Ramp& ramp) { ++ramp.ticks; }));
}

TEST(ServoStateTest, DigestChangesWithEachCoveredField) {
  using features::FeatureForm;
  using hal::FeatureKind;
  ExpectDigestToSeeAllBut(kLeftOutInTrack, hal::Mode::kTrack,
                          test::TrackingRun("square", FeatureKind::kSquare, FeatureForm::kCorners, 600));
  ExpectDigestToSeeAllBut(kLeftOutInTrack, hal::Mode::kTrack,
                          test::TrackingRun("sphere", FeatureKind::kSphere, FeatureForm::kSphere, 600));
  ExpectDigestToSeeAllBut({"joint history", "planned motion", "momentum", "way to the goal", "plan"},
                          hal::Mode::kMove, test::CommandedRun(300));
}

// The plan and the pull follow from the inputs and the rest of the way.
TEST(ServoStateTest, DigestChangesWithEachFieldOfTheWayOnAPlan) {
  const test::ServoRun run = test::PlannedRun(900);
  ExpectDigestToSeeAllBut(kLeftOutInTrack, hal::Mode::kTrack, run);
  task::ServoTask task;
  ASSERT_TRUE(task.Init(run.config).ok());
  task::ServoOutputs outputs;
  for (const task::ServoInputs& inputs : run.inputs) {
    task.Step(inputs, outputs);
  }
  ASSERT_EQ(task.state().way.note.way, hal::Way::kPlan);
  const std::uint64_t digest = DigestOf(run.config, task.state(), false);
  const auto changed = [&](const auto& change) {
    auto state = std::make_unique<task::ServoState>(task.state());
    change(state->way);
    return DigestOf(run.config, *state, false) != digest;
  };
  EXPECT_TRUE(changed([](control::WayToGoal& w) { w.t += 1e-12; }));
  EXPECT_TRUE(changed([](control::WayToGoal& w) { w.q_end[6] += 1e-12; }));
  EXPECT_TRUE(changed([](control::WayToGoal& w) { w.shift[0] += 1e-12; }));
  EXPECT_TRUE(changed([](control::WayToGoal& w) { w.held_ns += 1; }));
  EXPECT_TRUE(changed([](control::WayToGoal& w) { w.note.tries += 1; }));
  EXPECT_TRUE(changed([](control::WayToGoal& w) { w.swing.angle += 1e-12; }));
  EXPECT_TRUE(changed([](control::WayToGoal& w) { w.late_ns += 1; }));
}

// A state with an index outside its array is refused.
TEST(ServoStateTest, IndicesOutOfRangeAreRefused) {
  task::ServoTask task;
  ASSERT_TRUE(task.Init(test::PandaConfig()).ok());
  auto state = std::make_unique<task::ServoState>(task.state());
  const auto is_refused = [&](const auto& change) {
    *state = task.state();
    change(*state);
    Buffer storage(kMaxState);
    return Encode(*state, storage).empty();
  };
  EXPECT_FALSE(is_refused([](task::ServoState&) {}));
  EXPECT_TRUE(is_refused([](task::ServoState& s) { s.way.turn = 4; }));
  EXPECT_TRUE(is_refused([](task::ServoState& s) { s.way.turn = -1; }));
  EXPECT_TRUE(is_refused([](task::ServoState& s) { s.way.note.way = static_cast<hal::Way>(hal::kNumWays); }));
  EXPECT_TRUE(
      is_refused([](task::ServoState& s) { s.plans.Restore({}, trajectory::Plan::kMostNumbers + 1); }));
  EXPECT_TRUE(is_refused([](task::ServoState& s) { s.plans.Restore({}, -2); }));
  EXPECT_FALSE(is_refused([](task::ServoState& s) { s.plans.Restore({}, -1); }));
  EXPECT_TRUE(is_refused([](task::ServoState& s) { s.predict.hypotheses.plate.believed = hal::kMaxPoses; }));
}

// A state on a plan needs the whole plan: the next tick reads its points.
TEST(ServoStateTest, StateOnAPlanThatIsNotWholeIsRefused) {
  task::ServoTask task;
  ASSERT_TRUE(task.Init(test::PandaConfig()).ok());
  trajectory::Plan plan;
  plan.outcome = trajectory::PlanOutcome::kFound;
  plan.num_joints = 7;
  plan.num_points = 10;
  plan.period_s = 0.1;
  auto state = std::make_unique<task::ServoState>(task.state());
  auto back = std::make_unique<task::ServoState>(task.state());
  const auto is_taken = [&](const trajectory::Plan& changed, int received) {
    state->plans.Restore(changed, received);
    return Decode(BytesOf(*state), *back);
  };
  EXPECT_TRUE(is_taken(plan, 42)) << "still on its way";
  state->way.note.way = hal::Way::kPlan;
  state->way.q_end.setZero(7);
  state->way.shift.setZero(7);
  EXPECT_TRUE(is_taken(plan, 70));
  EXPECT_EQ(back->plans.plan().num_points, 10);
  EXPECT_FALSE(is_taken(plan, 42));
  EXPECT_FALSE(is_taken(plan, -1));
  trajectory::Plan absurd = plan;
  absurd.num_points = 100'000'000;
  EXPECT_FALSE(is_taken(absurd, 70));
  EXPECT_FALSE(is_taken({}, 0)) << "no motion";
  state->way.shift.setZero(6);
  EXPECT_FALSE(is_taken(plan, 70));
}

TEST(ServoStateTest, DemandRoundTripKeepsEveryField) {
  Demand demand;
  EXPECT_TRUE(demand.IsPlain());
  demand.arm_status = hal::StatusCode::kDisconnected;
  demand.request = task::Request::kReset;
  demand.motion.kind = moves::MotionKind::kPoseSetpoint;
  demand.motion.V_BE_B[5] = -0.0;
  demand.change_law = true;
  demand.law = config::MotionLawKind::kFloat;
  EXPECT_FALSE(demand.IsPlain());
  std::array<std::uint8_t, kMaxDemand> storage{};
  const Bytes bytes = Encode(demand, storage);
  ASSERT_FALSE(bytes.empty());
  Demand back;
  ASSERT_TRUE(Decode(bytes, back));
  std::array<std::uint8_t, kMaxDemand> again{};
  const Bytes same = Encode(back, again);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), same.begin(), same.end()));
  EXPECT_EQ(back.arm_status, demand.arm_status);
  EXPECT_FALSE(Decode(bytes.first(bytes.size() - 1), back));

  // A key that changes comes last. A log without one has the bytes of logs from before such keys existed.
  demand.tuning = {7, 0.25};
  const Bytes longer = Encode(demand, again);
  ASSERT_EQ(longer.size(), bytes.size() + 12);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), longer.begin()));
  ASSERT_TRUE(Decode(longer, back));
  EXPECT_EQ(back.tuning.key, 7);
  EXPECT_EQ(back.tuning.value, 0.25);
  EXPECT_FALSE(Decode(longer.first(longer.size() - 1), back));
  ASSERT_TRUE(Decode(bytes, back));
  EXPECT_FALSE(back.tuning.IsAsked());
  Demand asked;
  asked.tuning = {0, 1.0};
  EXPECT_FALSE(asked.IsPlain());
}

// The plan's part comes after the key, with and without one.
TEST(ServoStateTest, DemandRoundTripKeepsAPartOfAPlan) {
  for (const bool with_key : {false, true}) {
    Demand demand;
    if (with_key) {
      demand.tuning = {7, 0.25};
    }
    demand.plan.head.outcome = trajectory::PlanOutcome::kFound;
    demand.plan.head.num_joints = 7;
    demand.plan.head.num_points = 12;
    demand.plan.head.stamp_ns = 99;
    demand.plan.first = 42;
    demand.plan.count = trajectory::PlanPart::kMostNumbers;
    demand.plan.numbers.fill(-0.0);
    demand.plan.numbers[41] = 1e-300;
    EXPECT_FALSE(demand.IsPlain());
    std::array<std::uint8_t, kMaxDemand> storage{};
    const Bytes bytes = Encode(demand, storage);
    ASSERT_FALSE(bytes.empty()) << "it always fits";
    Demand back;
    back.tuning = {3, 1.0};
    ASSERT_TRUE(Decode(bytes, back));
    EXPECT_EQ(back.tuning.IsAsked(), with_key);
    EXPECT_EQ(back.plan.first, 42);
    EXPECT_EQ(back.plan.head.num_points, 12);
    EXPECT_EQ(back.plan.head.stamp_ns, 99);
    EXPECT_EQ(back.plan.numbers, demand.plan.numbers);
    EXPECT_FALSE(Decode(bytes.first(bytes.size() - 1), back));
    demand.plan = {};
    const Bytes shorter = Encode(demand, storage);
    ASSERT_TRUE(Decode(shorter, back));
    EXPECT_FALSE(back.plan.IsThere()) << "that of the message before does not stay";
  }
}

}  // namespace
}  // namespace fovea::link
