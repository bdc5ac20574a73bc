// SPDX-License-Identifier: Apache-2.0
// The simulated planner answers as its desk does. While its fault acts nothing comes, and nothing is lost.
#include "sim/run/sim_planner.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "sim/scenario/run_description.hpp"

namespace fovea::sim {
namespace {

using namespace std::chrono_literals;

class SimPlannerTest : public testing::Test {
 protected:
  static constexpr std::int64_t kNever = -1;

  // A request that is refused at once: the answer's time is the desk's alone.
  static hal::TickRecord Request(std::int64_t ms) {
    hal::TickRecord record;
    record.stamp_ns = ms * hal::kNsPerMs;
    record.command.num_joints = 7;
    record.p_BO[0] = std::nan("");
    record.way.way = hal::Way::kAwaitPlan;
    record.way.plans_asked = 1;
    record.way.tries = 1;
    return record;
  }
  [[nodiscard]] std::unique_ptr<SimPlanner> Planner(const PlannerFaults& faults) const {
    return std::make_unique<SimPlanner>(servo_, planning::EyeReach{}, faults);
  }
  // In lockstep from `from_ms` until `to_ms`: the time at which a plan comes [ms], which is then in plan_.
  std::int64_t Await(SimPlanner& planner, std::int64_t from_ms, std::int64_t to_ms) {
    for (std::int64_t ms = from_ms; ms < to_ms; ++ms) {
      planner.Act(ms * hal::kNsPerMs, /*lockstep=*/true);
      if (planner.box().plans.Take(plan_)) {
        return ms;
      }
    }
    return kNever;
  }

  const config::ServoConfig servo_ = DescribeRun(LoadScenario("ball", {})).servo;
  trajectory::Plan plan_;
};

TEST_F(SimPlannerTest, AnswersAtTheModelledTime) {
  const auto planner = Planner({});
  planner->box().requests.Put(Request(20));
  EXPECT_EQ(Await(*planner, 20, 1000), 20 + planning::PlanDesk::ModelledNs(0) / hal::kNsPerMs);
  EXPECT_EQ(plan_.stamp_ns, 20 * hal::kNsPerMs);
  EXPECT_EQ(Await(*planner, 26, 1000), kNever) << "one answer for a request";
}

TEST_F(SimPlannerTest, AnswersAfterItsFaultWhatWasAskedInIt) {
  const auto planner = Planner({.loss = {0.010, 0.050}});
  planner->box().requests.Put(Request(20));
  EXPECT_EQ(Await(*planner, 20, 30), kNever);
  planner->box().requests.Put(Request(30));
  EXPECT_EQ(Await(*planner, 30, 1000), 50 + planning::PlanDesk::ModelledNs(0) / hal::kNsPerMs);
  EXPECT_EQ(plan_.stamp_ns, 30 * hal::kNsPerMs) << "the newest request wins";
  EXPECT_EQ(Await(*planner, 56, 1000), kNever);
}

TEST_F(SimPlannerTest, PlanThatIsDueInItsFaultComesAtItsEnd) {
  const auto planner = Planner({.loss = {0.010, 0.050}});
  planner->box().requests.Put(Request(8));
  EXPECT_EQ(Await(*planner, 8, 1000), 50);
  EXPECT_EQ(plan_.stamp_ns, 8 * hal::kNsPerMs);
}

TEST_F(SimPlannerTest, NeverAnswersIfItsFaultHasNoEnd) {
  const auto planner = Planner({.loss = {0.0, 1e6}});
  planner->box().requests.Put(Request(0));
  EXPECT_EQ(Await(*planner, 0, 10'000), kNever);
}

TEST_F(SimPlannerTest, ThreadsAnswerWaitsForTheEndOfItsFault) {
  const auto planner = Planner({});
  planner->Begin();
  planner->box().requests.Put(Request(1));
  planner->Act(1 * hal::kNsPerMs, /*lockstep=*/false);  // the thread has the request
  planner->SetFaults({.loss = {0.0, 1e6}});
  for (int i = 2; i < 50; ++i) {
    planner->Act(i * hal::kNsPerMs, /*lockstep=*/false);
    EXPECT_FALSE(planner->box().plans.Take(plan_));
    std::this_thread::sleep_for(1ms);
  }
  planner->SetFaults({});
  bool came = false;
  for (int i = 50; i < 20'000 && !came; ++i) {
    planner->Act(i * hal::kNsPerMs, /*lockstep=*/false);
    came = planner->box().plans.Take(plan_);
    std::this_thread::sleep_for(1ms);
  }
  ASSERT_TRUE(came);
  EXPECT_EQ(plan_.stamp_ns, 1 * hal::kNsPerMs);
}

}  // namespace
}  // namespace fovea::sim
