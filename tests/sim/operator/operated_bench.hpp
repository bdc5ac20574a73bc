// SPDX-License-Identifier: Apache-2.0
// A simulated run in virtual time with an operator's desk, and with true measurements instead of pictures.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/host/recording/flight/flight_recorder.hpp"
#include "fovea/linux_rt/tick_meter.hpp"
#include "sim/operator/desk.hpp"
#include "sim/run/sim_planner.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/scenario/world_config.hpp"
#include "sim/world/sim_arm.hpp"
#include "sim/world/world_clock.hpp"
#include "tests/support/truth_eye.hpp"

namespace fovea::test {

class OperatedBench {
 public:
  explicit OperatedBench(const std::string& scenario = "ball", const std::vector<std::string>& set = {})
      : about(sim::DescribeRun(sim::LoadScenario(scenario, set))) {
    if (!servo_.Init(about.servo).ok()) {
      throw std::logic_error("the servo refuses its configuration");
    }
    sim::WorldConfig config = sim::MakeWorldConfig(about);
    config.physics.may_be_loaded = true;
    world = std::make_unique<sim::World>(config);
    world->OnExposure([this](const sim::Exposure& exposure) { See(exposure); });
    sim_arm_.emplace(*world);
    arm.emplace(*sim_arm_, about.scenario.faults.arm);
    clock_.emplace(*world, [this](std::int64_t now_ns) { return Between(now_ns); });
    stalling_.emplace(*clock_, about.scenario.faults.stall);
    loop.emplace(recorder_, *arm, *stalling_, features_, recorder_, meter_);
    loop->UsePlanner(planner_.box());
    sim::DeskParts parts{about, *world, *arm, vision_, planner_, *loop, *stalling_, {}};
    parts.reports.touch = [this](const std::string& what, const std::string& text) {
      touches.push_back(what + ": " + text);
    };
    parts.reports.parameter = [this](std::size_t parameter, double value) {
      answers.push_back({parameter, value});
    };
    desk.emplace(parts, desk::WallPace::kFree);
  }

  // Runs until `end_s`.
  void RunUntil(double end_s) {
    static_cast<void>(loop->Run(static_cast<std::int64_t>(end_s * 1e9)));
    Between(world->now_ns());
    clock_->RethrowFailure();
  }
  // Carries out a request. Returns the error of its answer.
  std::string Ask(const live::Request& request) { return desk->Do({"somebody", request}).error; }
  // The index of a fault in the catalogue.
  [[nodiscard]] std::size_t Fault(const std::string& name) const {
    const live::Catalogue offer = sim::OperatorDesk::Offer(about);
    for (std::size_t i = 0; i < offer.faults.size(); ++i) {
      if (offer.faults[i].name == name) {
        return i;
      }
    }
    throw std::logic_error("no fault " + name);
  }
  [[nodiscard]] std::size_t Parameter(const std::string& name) const {
    const live::Catalogue offer = sim::OperatorDesk::Offer(about);
    for (std::size_t i = 0; i < offer.parameters.size(); ++i) {
      if (offer.parameters[i].name == name) {
        return i;
      }
    }
    throw std::logic_error("no parameter " + name);
  }
  // Distance of the target from its goal, by the truth [m].
  [[nodiscard]] double TrueError() const {
    const sim::Truth& truth = world->truth();
    const Eigen::Vector3d p_CO_C = truth.X_BC.inverse() * truth.p_BO;
    return (p_CO_C - about.servo.feature.p_CO_C_star).norm();
  }

  const sim::RunDescription about;
  std::unique_ptr<sim::World> world;
  std::optional<sim::FaultyArm> arm;
  std::optional<task::ServoLoop> loop;
  std::optional<sim::OperatorDesk> desk;
  std::vector<hal::TickRecord> records;
  std::vector<std::string> touches;
  std::vector<std::pair<std::size_t, double>> answers;

 private:
  bool Between(std::int64_t now_ns) {
    planner_.Act(now_ns, /*lockstep=*/true);
    recorder_.Drain(
        [this](const flight::FlightRecord& flown) {
          records.push_back(flown.record);
          desk->Note(flown.record);
        },
        [](const flight::Keyframe&) {});
    desk->Act();
    return true;
  }
  void See(const sim::Exposure& exposure) {
    const Eigen::Isometry3d X_BC = exposure.X_BC;
    const model::Pose X_CO{X_BC.linear().transpose() * exposure.R_BO, X_BC.inverse() * exposure.p_BO};
    features_.Put(eye_.See(X_CO, exposure.stamp_ns, exposure.sequence));
  }

  task::ServoTask servo_;
  flight::FlightRecorder recorder_{servo_, &servo_, 4096};
  linux_rt::TickMeter meter_;
  hal::FeatureMailbox features_;
  sim::SimPlanner planner_{about.servo, about.reach, about.scenario.faults.planner};
  TruthEye eye_{about.servo.feature, about.intrinsics.f_u_px, 0.0, 1};
  sim::SimVision vision_{about, {}};
  std::optional<sim::SimArm> sim_arm_;
  std::optional<sim::LockstepClock> clock_;
  std::optional<sim::StallingClock> stalling_;
};

}  // namespace fovea::test
