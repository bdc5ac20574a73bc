// SPDX-License-Identifier: Apache-2.0
// Each request of an operator has its effect on a running arm, and is recorded.
#include "sim/operator/desk.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "firmware/host/recording/log/record_hash.hpp"
#include "tests/sim/operator/operated_bench.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::sim {
namespace {

using test::OperatedBench;

TEST(OperatorDesk, HoldsAndTracks) {
  OperatedBench bench;
  bench.RunUntil(1.0);
  EXPECT_EQ(bench.desk->State().mode, "track");
  EXPECT_EQ(bench.Ask(live::Hold{}), "");
  bench.RunUntil(1.5);
  EXPECT_EQ(bench.desk->State().mode, "hold");
  EXPECT_EQ(bench.desk->State().hold_reason, "not_asked");
  EXPECT_FALSE(bench.desk->State().hold_reason_words.empty());
  EXPECT_EQ(bench.Ask(live::Track{}), "");
  bench.RunUntil(6.0);
  EXPECT_EQ(bench.desk->State().mode, "track");
  EXPECT_LT(bench.TrueError(), 1e-3);
  EXPECT_EQ(bench.touches, (std::vector<std::string>{"hold: hold the arm", "track: track the target"}));
}

TEST(OperatorDesk, RecoversFromAFaultOnly) {
  OperatedBench bench;
  bench.RunUntil(0.5);
  EXPECT_EQ(bench.Ask(live::Recover{}), "there is no fault to recover from");
  EXPECT_EQ(bench.Ask(live::StartFault{bench.Fault("encoder_nan"), {{"encoder_nan_joint", 2.0}}}), "");
  bench.RunUntil(1.0);
  EXPECT_EQ(bench.desk->State().fault, "non_finite_sensor");
  EXPECT_EQ(bench.desk->State().mode, "fault");
  EXPECT_TRUE(bench.desk->State().faults[bench.Fault("encoder_nan")].active);
  EXPECT_EQ(bench.Ask(live::StopFault{bench.Fault("encoder_nan")}), "");
  bench.RunUntil(3.0);
  EXPECT_EQ(bench.Ask(live::Recover{}), "");
  bench.RunUntil(3.5);
  EXPECT_NE(bench.desk->State().mode, "fault");
  EXPECT_EQ(bench.desk->State().fault, "");
}

TEST(OperatorDesk, ADraggedTargetIsFollowed) {
  OperatedBench bench;
  bench.RunUntil(5.0);
  ASSERT_LT(bench.TrueError(), 1e-3);
  const Eigen::Vector3d from = bench.world->truth().p_BO;
  EXPECT_EQ(bench.Ask(live::HoldTarget{{from.x(), from.y() + 0.1, from.z()}}), "");
  bench.RunUntil(5.1);
  EXPECT_GT((bench.world->truth().p_BO - from).norm(), 0.02);
  EXPECT_TRUE(bench.desk->State().target->held);
  EXPECT_EQ(bench.Ask(live::ReleaseTarget{}), "");
  EXPECT_FALSE(bench.desk->State().target->held);
  bench.RunUntil(8.0);
  EXPECT_NEAR((bench.world->truth().p_BO - from).norm(), 0.1, 1e-9);
  std::cout << "error 2.9 s after a drag of 0.1 m: " << 1e3 * bench.TrueError() << " mm\n";
  EXPECT_LT(bench.TrueError(), 1e-3);
  EXPECT_EQ(bench.Ask(live::HoldTarget{{from.x(), from.y(), from.z()}}), "");
  EXPECT_EQ(bench.Ask(live::ReleaseTarget{}), "");
  EXPECT_EQ(bench.touches.size(), 4U) << "each drag is taken and let go";
}

// The world does not move the target meanwhile. The page and the saved file still have it where it was put.
TEST(OperatorDesk, APausedTargetIsWhereItWasDragged) {
  OperatedBench bench;
  bench.RunUntil(1.0);
  const Eigen::Vector3d before = bench.world->truth().p_BO;
  EXPECT_EQ(bench.Ask(live::Pause{true}), "");
  EXPECT_EQ(bench.desk->State().target->p_BO, (std::array{before.x(), before.y(), before.z()}));
  constexpr double kHalf = 0.70710678118654757;
  const live::HoldTarget wish{{0.55, 0.05, 0.06}, {kHalf, 0.0, 0.0, kHalf}};
  EXPECT_EQ(bench.Ask(wish), "");
  EXPECT_EQ(bench.Ask(live::ReleaseTarget{}), "");
  const live::TargetState shown = *bench.desk->State().target;
  EXPECT_EQ(shown.p_BO, wish.p_BO);
  EXPECT_NEAR(shown.q_BO[3], kHalf, 1e-12);
  EXPECT_FALSE(shown.held);
  const live::Answer saved = bench.desk->Do({"somebody", live::Save{}});
  ASSERT_EQ(saved.error, "");
  const test::TempFolder folder;
  std::ofstream(folder.path() / "saved.toml") << nlohmann::json::parse(saved.json)["toml"].get<std::string>();
  const OperatedBench again((folder.path() / "saved.toml").string());
  EXPECT_EQ(again.world->truth().p_BO, Eigen::Vector3d(0.55, 0.05, 0.06));
  EXPECT_TRUE(again.world->truth().R_BO.isApprox(
      Eigen::Quaterniond(kHalf, 0.0, 0.0, kHalf).toRotationMatrix(), 1e-9));
  EXPECT_EQ(bench.Ask(live::Pause{false}), "");
  EXPECT_EQ(bench.desk->State().target->p_BO, (std::array{before.x(), before.y(), before.z()}))
      << "it only begins to move";
  EXPECT_EQ(bench.Ask(live::Pause{true}), "");
  EXPECT_EQ(bench.Ask(live::Throw{{0.0, 0.1, 0.0}, {}}), "");
  EXPECT_EQ(bench.desk->State().target->p_BO, (std::array{before.x(), before.y(), before.z()}));
}

TEST(OperatorDesk, ATargetBeyondReachLeadsToHoldWithItsReason) {
  OperatedBench bench;
  bench.RunUntil(4.0);
  EXPECT_EQ(bench.Ask(live::HoldTarget{{1.9, 0.0, 0.04}}), "");
  bench.RunUntil(12.0);
  const live::State state = bench.desk->State();
  EXPECT_EQ(state.mode, "hold");
  EXPECT_FALSE(state.hold_reason == "none" || state.hold_reason_words.empty()) << state.hold_reason;
  EXPECT_NE(bench.Ask(live::HoldTarget{{2.1, 0.0, 0.04}}), "");
}

TEST(OperatorDesk, ATargetInTheArmLeadsToHoldWithItsReason) {
  OperatedBench bench;
  bench.RunUntil(4.0);
  const std::vector<SimLink>& links = bench.about.scene.robot.links;
  const auto forearm =
      std::find_if(links.begin(), links.end(), [](const SimLink& link) { return link.dof == 3; });
  const Exposure seen = bench.world->Look();
  const Eigen::Vector3d p = seen.X_BL[static_cast<std::size_t>(forearm - links.begin())].translation();
  EXPECT_EQ(bench.Ask(live::HoldTarget{{p.x(), p.y(), p.z()}}), "");
  bool touched = false;
  for (int i = 0; i < 80; ++i) {
    bench.RunUntil(4.0 + 0.1 * (i + 1));
    touched = touched || bench.world->truth().contacts.target;
  }
  EXPECT_TRUE(touched) << "the target is where the arm is";
  const live::State state = bench.desk->State();
  EXPECT_EQ(state.mode, "hold");
  EXPECT_FALSE(state.hold_reason == "none" || state.hold_reason_words.empty()) << state.hold_reason;
}

TEST(OperatorDesk, AThrownTargetComesToRest) {
  OperatedBench bench;
  bench.RunUntil(4.0);
  EXPECT_EQ(bench.Ask(live::Throw{{0.0, -0.3, 0.0}, {0.0, 0.0, 0.0}}), "");
  bench.RunUntil(9.0);
  EXPECT_LT(bench.TrueError(), 2e-3);
}

TEST(OperatorDesk, PullsTheArmAndLetsGo) {
  OperatedBench bench("ball", {"servo.auto_track=false"});
  bench.RunUntil(1.0);
  const Eigen::Vector3d rest = bench.world->truth().X_BE.translation();
  const std::string hand =
      bench.about.scene.robot.links[static_cast<std::size_t>(bench.about.scene.robot.tip)].name;
  EXPECT_EQ(bench.Ask(live::Pull{hand, {}, {rest.x(), rest.y() + 0.05, rest.z()}}), "");
  bench.RunUntil(2.0);
  const double pulled = bench.world->truth().X_BE.translation().y() - rest.y();
  std::cout << "a spring of 10 N moves the held hand by " << 1e3 * pulled << " mm\n";
  EXPECT_GT(pulled, 1e-4);
  EXPECT_EQ(bench.desk->State().pull->link, hand);
  EXPECT_EQ(bench.Ask(live::Release{}), "");
  EXPECT_FALSE(bench.desk->State().pull.has_value());
  EXPECT_NE(bench.Ask(live::Pull{"no_such_link", {}, {}}), "");
  EXPECT_EQ(bench.touches.size(), 2U);
}

TEST(OperatorDesk, TheControllersEndReleasesTargetAndArm) {
  OperatedBench bench;
  bench.RunUntil(1.0);
  const std::string hand =
      bench.about.scene.robot.links[static_cast<std::size_t>(bench.about.scene.robot.tip)].name;
  bench.Ask(live::HoldTarget{{0.55, 0.1, 0.05}});
  bench.Ask(live::Pull{hand, {}, {0.5, 0.0, 0.5}});
  bench.RunUntil(1.2);
  EXPECT_EQ(bench.Ask(live::ControlEnded{}), "");
  EXPECT_FALSE(bench.desk->State().target->held);
  EXPECT_FALSE(bench.desk->State().pull.has_value());
  bench.RunUntil(3.0);
  EXPECT_NEAR(bench.world->truth().p_BO.x(), 0.55, 1e-9) << "it arrives, and stays";
}

// Every fault of the panel can be started and stopped in motion. The arm keeps its limits.
TEST(OperatorDesk, EachFaultStartsAndStops) {
  const std::size_t faults = OperatorDesk::Offer(OperatedBench().about).faults.size();
  for (std::size_t i = 0; i < faults; ++i) {
    OperatedBench bench("ball", {"camera.rate_hz=5"});
    const live::FaultKind kind = OperatorDesk::Offer(bench.about).faults[i];
    bench.RunUntil(0.5);
    std::map<std::string, double> sizes;
    if (kind.name == "push") {
      sizes["push[2]"] = 5.0;
    } else if (kind.name == "deadline_miss") {
      sizes["deadline_miss"] = 0.5;  // with all ticks missed, nothing here would end the fault
    }
    ASSERT_EQ(bench.Ask(live::StartFault{i, sizes}), "") << kind.name;
    bench.RunUntil(0.8);
    EXPECT_TRUE(bench.desk->State().faults[i].active) << kind.name;
    ASSERT_EQ(bench.Ask(live::StopFault{i}), "") << kind.name;
    bench.RunUntil(1.0);
    EXPECT_FALSE(bench.desk->State().faults[i].active) << kind.name;
    EXPECT_EQ(bench.touches.size(), 2U) << kind.name;
  }
}

std::string HashOf(const OperatedBench& bench) {
  log::RecordHash hash;
  for (const hal::TickRecord& record : bench.records) {
    hash.Add(record);
  }
  return hash.Finish();
}

// The page's faults, one after the other, are those of a scenario with the same windows, to the last bit. The
// first one begins at the time of an exposure.
TEST(OperatorDesk, FaultsFromThePageEqualThoseOfAScenario) {
  constexpr double kLasts = 0.1;
  const std::vector<std::string> names{"camera_outage", "torque_loss", "encoder_noise", "packet_loss",
                                       "deadline_miss"};
  std::vector<std::string> set{"faults.deadline_miss=0.5", "faults.packet_loss=0.5"};
  OperatedBench page("ball", set);
  const auto next_s = [&page] {
    return static_cast<double>(page.world->now_ns() + hal::kTickPeriodNs) * 1e-9;
  };
  double t_s = 0.52;
  for (const std::string& name : names) {
    page.RunUntil(t_s);
    const double from_s = next_s();
    ASSERT_EQ(page.Ask(live::StartFault{page.Fault(name), {}}), "");
    page.RunUntil(t_s + kLasts);
    const double to_s = next_s();
    ASSERT_EQ(page.Ask(live::StopFault{page.Fault(name)}), "");
    set.push_back(fmt::format("faults.{}_s=[{},{}]", name, from_s, to_s));
    t_s += 2.0 * kLasts;
  }
  page.RunUntil(t_s);
  OperatedBench scenario("ball", set);
  double again_s = 0.52;
  for (std::size_t i = 0; i < names.size(); ++i, again_s += 2.0 * kLasts) {
    scenario.RunUntil(again_s);
    scenario.RunUntil(again_s + kLasts);
  }
  scenario.RunUntil(again_s);
  EXPECT_EQ(page.records.size(), scenario.records.size());
  EXPECT_EQ(HashOf(page), HashOf(scenario));
}

TEST(OperatorDesk, ChangesAGainInMotion) {
  OperatedBench bench;
  bench.RunUntil(0.5);
  const std::size_t lambda = bench.Parameter("servo.lambda");
  EXPECT_EQ(bench.Ask(live::SetParameter{lambda, 4.0}), "");
  bench.RunUntil(1.0);
  ASSERT_EQ(bench.answers.size(), 1U);
  EXPECT_EQ(bench.answers[0], std::pair(lambda, 4.0));
}

TEST(OperatorDesk, PausesStepsAndEnds) {
  OperatedBench bench;
  EXPECT_EQ(bench.Ask(live::Step{5}), "the run is not paused");
  EXPECT_EQ(bench.Ask(live::Pause{true}), "");
  EXPECT_TRUE(bench.desk->State().paused);
  EXPECT_EQ(bench.Ask(live::Step{5}), "");
  EXPECT_EQ(bench.Ask(live::Pause{false}), "");
  EXPECT_EQ(bench.Ask(live::Speed{0.25}), "");
  EXPECT_EQ(bench.desk->State().speed, 0.25);
  EXPECT_EQ(bench.desk->end(), LiveEnd::kNone);
  EXPECT_EQ(bench.Ask(live::Reset{}), "");
  EXPECT_EQ(bench.desk->end(), LiveEnd::kReset);
  EXPECT_FALSE(bench.desk->State().ends) << "it begins anew";
  EXPECT_EQ(bench.Ask(live::Hold{}), "the run is ending");
  EXPECT_EQ(bench.Ask(live::End{}), "");
  EXPECT_EQ(bench.desk->end(), LiveEnd::kEnd);
  EXPECT_TRUE(bench.desk->State().ends);
}

TEST(OperatorDesk, SavesAScenarioThatBeginsThere) {
  OperatedBench bench;
  bench.RunUntil(1.0);
  bench.Ask(live::HoldTarget{{0.5, 0.05, 0.06}});
  bench.Ask(live::SetParameter{bench.Parameter("servo.lambda"), 3.0});
  bench.RunUntil(1.5);
  const live::Answer saved = bench.desk->Do({"somebody", live::Save{}});
  ASSERT_EQ(saved.error, "");
  const auto json = nlohmann::json::parse(saved.json);
  EXPECT_EQ(json["name"], "ball-at-1.500s.toml");
  const test::TempFolder folder;
  std::ofstream(folder.path() / "saved.toml") << json["toml"].get<std::string>();
  OperatedBench again((folder.path() / "saved.toml").string());
  EXPECT_EQ(again.world->truth().q, bench.world->truth().q);
  EXPECT_EQ(again.world->truth().p_BO, bench.world->truth().p_BO);
  EXPECT_LT((again.world->truth().p_BO - Eigen::Vector3d(0.5, 0.05, 0.06)).norm(), 0.01);
  EXPECT_EQ(again.about.servo.law.lambda, 3.0);
  again.RunUntil(6.0);
  EXPECT_LT(again.TrueError(), 1e-3);
}

TEST(OperatorDesk, ARunWithoutTargetOffersNoTarget) {
  const OperatedBench bench("home");
  const live::Catalogue offer = OperatorDesk::Offer(bench.about);
  EXPECT_FALSE(offer.target);
  EXPECT_EQ(std::count(offer.services.begin(), offer.services.end(), live::Service::kThrow), 0);
  EXPECT_FALSE(bench.desk->State().target.has_value());
}

}  // namespace
}  // namespace fovea::sim
