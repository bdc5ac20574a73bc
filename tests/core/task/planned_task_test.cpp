// SPDX-License-Identifier: Apache-2.0
// The servo with a planner on its line: one that answers, one that is dead, and one that sends anything.
#include <array>
#include <functional>
#include <iostream>
#include <tuple>
#include <vector>

#include "tests/core/task/planned_task.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::task {
namespace {

using hal::Mode;
using hal::PlanEvent;
using hal::Way;
using trajectory::Plan;
using PlannedTaskTest = PlannedTask;

TEST_F(PlannedTaskTest, PlanLeadsToTheGoalAndTheLawKeepsIt) {
  ASSERT_TRUE(RunUntil(PlanEvent::kAsked));
  EXPECT_EQ(outputs_.record.mode, Mode::kTrack);
  const hal::JointArray q = outputs_.record.q_cmd;
  Run(40);
  EXPECT_EQ(outputs_.record.q_cmd, q) << "the arm stands exactly where the plan begins";
  ASSERT_TRUE(task_.state().way.asked_ns > 0);
  hal::TickRecord asked = outputs_.record;
  asked.stamp_ns = task_.state().way.asked_ns;
  outputs_.record = asked;
  EXPECT_EQ(Send(PlanToGoal()).way.event, PlanEvent::kTaken);
  ReferenceWatch watch(config_);
  int ticks = 0;
  for (; Tick().way.way == Way::kPlan && ticks < 10'000; ++ticks) {
    watch.Look(outputs_.record);
  }
  EXPECT_EQ(outputs_.record.way.event, PlanEvent::kDone);
  EXPECT_LT(ticks, 3500);
  watch.ExpectAllHeld();
  EXPECT_LT(Error(), 0.02);
  Run(1500);
  EXPECT_LT(Error(), 1e-3);
  EXPECT_EQ(outputs_.record.mode, Mode::kTrack);
  EXPECT_EQ(outputs_.record.way.plans_asked, 1);
}

TEST_F(PlannedTaskTest, WithADeadPlannerTheLawGoesAlone) {
  ASSERT_TRUE(RunUntil(PlanEvent::kAsked));
  const int asked = ticks_;
  ASSERT_TRUE(RunUntil(PlanEvent::kLate));
  EXPECT_NEAR(ticks_ - asked, 2000, 5) << "and says so";
  int late = 0;
  for (int i = 0; i < 6000; ++i) {
    late += Tick().way.event == PlanEvent::kLate ? 1 : 0;
    ASSERT_EQ(outputs_.record.mode, Mode::kTrack);
  }
  EXPECT_LT(Error(), 1e-3);
  EXPECT_EQ(late, 0) << "said once for each request";
}

// All of a record that a plan could change.
auto EssenceOf(const hal::TickRecord& r) {
  return std::tuple(r.mode, r.hold_reason, r.fault, r.limits_active, r.way.way, r.way.event,
                    r.way.plans_asked, r.way.tries, r.way.outcome, r.s, r.e, r.V_BC_C_cmd, r.q_cmd, r.dq_cmd,
                    r.ddq_cmd, r.command.tau_cmd);
}

Plan AnyPlan(test::RandomStates& random, const hal::TickRecord& record) {
  Plan plan;
  plan.outcome = static_cast<trajectory::PlanOutcome>(random.Uniform(0.0, 1.0) < 0.5 ? 0 : 4);
  plan.num_joints = 7;
  plan.num_points = plan.IsFound() ? 5 : 0;
  plan.period_s = 0.1;
  const double kind = random.Uniform(0.0, 4.0);
  plan.stamp_ns = kind < 1.0   ? -1
                  : kind < 2.0 ? 0
                               : record.stamp_ns - static_cast<std::int64_t>(kind - 2.0) * 1'000'000;
  plan.p_BO = record.p_BO;
  for (int i = 0; i < 35; ++i) {
    plan.points[static_cast<std::size_t>(i)] = record.q_cmd[static_cast<std::size_t>(i % 7)];
  }
  return plan;
}

// A hostile line that sends plans all the time changes no bit of the run, except while one is awaited.
TEST_F(PlannedTaskTest, PartsThatWereNotAskedForChangeNothing) {
  std::vector<ServoInputs> inputs;
  std::vector<hal::TickRecord> records;
  std::vector<bool> open;  // a plan is awaited in this tick
  const auto tick = [&](const std::function<void(ServoInputs&)>& change) {
    open.push_back(task_.state().way.asked_ns >= 0);
    Tick([&](ServoInputs& in) {
      change(in);
      inputs.push_back(in);
    });
    records.push_back(outputs_.record);
  };
  trajectory::PlanSender sender;
  std::array<int, hal::kNumModes> modes{};
  std::array<int, hal::kNumWays> ways{};
  for (int i = 0; i < 6000; ++i) {
    tick([&](ServoInputs& in) {
      in.plan = sender.Next();
      in.request = i == 2000 ? Request::kHold : i == 2300 ? Request::kTrack : Request::kNone;
    });
    if (outputs_.record.way.event == PlanEvent::kAsked) {
      sender.Begin(PlanToGoal());
    }
    ++modes[static_cast<std::size_t>(outputs_.record.mode)];
    ++ways[static_cast<std::size_t>(outputs_.record.way.way)];
  }
  EXPECT_GT(modes[static_cast<std::size_t>(Mode::kHold)], 100);
  EXPECT_GT(ways[static_cast<std::size_t>(Way::kLaw)], 100);
  EXPECT_GT(ways[static_cast<std::size_t>(Way::kPlan)], 1000);

  ServoTask attacked;
  ASSERT_TRUE(attacked.Init(config_).ok());
  test::RandomStates random(21);
  ServoOutputs outputs;
  trajectory::PlanSender hostile;
  int sent = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (!open[i]) {
      if (hostile.IsDone()) {
        hostile.Begin(AnyPlan(random, outputs.record));
      }
      inputs[i].plan = hostile.Next();
      sent += inputs[i].plan.IsThere() ? 1 : 0;
    }
    attacked.Step(inputs[i], outputs);
    ASSERT_TRUE(EssenceOf(outputs.record) == EssenceOf(records[i])) << "tick " << i;
  }
  EXPECT_GT(sent, 3000);
}

// Plans of the right start and stamp, with anything in between.
Plan HostilePlan(test::RandomStates& random, const Plan& fits, const config::ServoConfig& config, int kind) {
  Plan plan = fits;
  plan.num_points = 4 + static_cast<int>(random.Uniform(0.0, 60.0));
  plan.period_s = std::pow(10.0, random.Uniform(-3.5, -0.5));
  for (int i = 0; i < plan.num_points; ++i) {
    const model::VecN q = random.Position(config.arm);
    for (int j = 0; j < plan.num_joints; ++j) {
      double& number = plan.points[static_cast<std::size_t>(i * plan.num_joints + j)];
      if (i < 3) {
        number = fits.Point(0, j);
        continue;
      }
      switch (kind) {
        case 0: number = q[j]; break;
        case 1: number = 20.0 * q[j]; break;
        case 2: number = random.Uniform(0.0, 1.0) < 0.2 ? 1e3 * q[j] : fits.Point(0, j); break;
        case 3: number = fits.Point(0, j) + (i % 2 == 0 ? 0.3 : -0.3); break;
        default: number = (random.Uniform(0.0, 1.0) < 0.5 ? 1e308 : -1e308); break;
      }
    }
  }
  return plan;
}

TEST_F(PlannedTaskTest, HostilePlanExceedsNoLimit) {
  test::RandomStates random(22);
  std::array<int, hal::kNumPlanEvents> events{};
  int faults = 0;
  for (int k = 0; k < test::Repetitions(40); ++k) {
    ticks_ = 0;
    pending_.clear();
    task_ = ServoTask();
    StartFar();
    ASSERT_TRUE(RunUntil(PlanEvent::kAsked));
    const int kind = k % 5;
    ReferenceWatch watch(config_);
    Send(HostilePlan(random, PlanToGoal(), config_, kind));
    ++events[static_cast<std::size_t>(outputs_.record.way.event)];
    for (int i = 0; i < 2500 && outputs_.record.mode != Mode::kFault; ++i) {
      watch.Look(outputs_.record);
      Tick();
      ++events[static_cast<std::size_t>(outputs_.record.way.event)];
    }
    watch.ExpectAllHeld();
    faults += outputs_.record.mode == Mode::kFault ? 1 : 0;
    ASSERT_FALSE(HasFailure()) << k;
  }
  std::cout << "taken " << events[static_cast<std::size_t>(PlanEvent::kTaken)] << ", held "
            << events[static_cast<std::size_t>(PlanEvent::kHeld)] << ", done "
            << events[static_cast<std::size_t>(PlanEvent::kDone)] << ", faults " << faults << "\n";
  EXPECT_EQ(faults, 0);
  EXPECT_GT(events[static_cast<std::size_t>(PlanEvent::kTaken)], 30) << "all but the absurd ones";
  EXPECT_GT(events[static_cast<std::size_t>(PlanEvent::kHeld)], 0);
}

// Hold in the middle of a plan: all joints slow down in step, and stay.
TEST_F(PlannedTaskTest, HoldStopsThePlanWithAllJointsInStep) {
  BeginPlan();
  Run(1000);
  ASSERT_EQ(outputs_.record.way.way, Way::kPlan);
  const model::VecN dq = model::ToVector(outputs_.record.dq_cmd, 7);
  ASSERT_GT(dq.norm(), 0.03);
  ReferenceWatch watch(config_);
  Tick([](ServoInputs& inputs) { inputs.request = Request::kHold; });
  int ticks = 0;
  for (; ticks < 2000; ++ticks) {
    const model::VecN now = model::ToVector(outputs_.record.dq_cmd, 7);
    watch.Look(outputs_.record);
    ASSERT_EQ(outputs_.record.mode, Mode::kHold);
    if (now.norm() < 1e-9) {
      break;
    }
    if (now.norm() > 0.2 * dq.norm()) {
      EXPECT_LT((now / now.norm() - dq / dq.norm()).norm(), 0.1) << ticks;
    }
    Tick();
  }
  EXPECT_LT(ticks, 1000);
  watch.ExpectAllHeld();
  const hal::JointArray q = outputs_.record.q_cmd;
  Run(500);
  EXPECT_EQ(outputs_.record.q_cmd, q);

  const int before = outputs_.record.way.plans_asked;
  Tick([](ServoInputs& inputs) { inputs.request = Request::kTrack; });
  EXPECT_NE(outputs_.record.way.way, Way::kPlan) << "the old plan is not taken up again";
  ASSERT_TRUE(RunUntil(PlanEvent::kAsked, 50));
  EXPECT_EQ(outputs_.record.way.plans_asked, before + 1);
  EXPECT_EQ(Send(PlanToGoal()).way.event, PlanEvent::kTaken);
  EXPECT_TRUE(RunUntil(PlanEvent::kDone, 6000));
}

TEST_F(PlannedTaskTest, PlanGoesOnWhileTheTargetIsHiddenForAMoment) {
  BeginPlan();
  Run(600);
  camera_on_ = false;
  int coasts = 0;
  for (int i = 0; i < 400; ++i) {
    Tick();
    coasts += outputs_.record.mode == Mode::kCoast ? 1 : 0;
    EXPECT_EQ(outputs_.record.way.way, Way::kPlan);
  }
  EXPECT_GT(coasts, 100);
  camera_on_ = true;
  EXPECT_TRUE(RunUntil(PlanEvent::kDone, 8000));
  EXPECT_EQ(outputs_.record.mode, Mode::kTrack);
  EXPECT_EQ(outputs_.record.way.plans_asked, 1);
}

TEST_F(PlannedTaskTest, LostTargetEndsThePlan) {
  BeginPlan();
  Run(600);
  camera_on_ = false;
  Run(1000);
  EXPECT_EQ(outputs_.record.mode, Mode::kHold);
  EXPECT_EQ(outputs_.record.hold_reason, hal::HoldReason::kTargetLost);
  EXPECT_LT(model::ToVector(outputs_.record.dq_cmd, 7).norm(), 1e-6);
  camera_on_ = true;
  ASSERT_TRUE(RunUntil(PlanEvent::kAsked));
  EXPECT_EQ(outputs_.record.way.plans_asked, 2);
}

}  // namespace
}  // namespace fovea::task
