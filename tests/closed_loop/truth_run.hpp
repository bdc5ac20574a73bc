// SPDX-License-Identifier: Apache-2.0
// A shipped scenario without renderer and detector: physics, servo and verdict are the real ones,
// measurements are the truth plus noise given in pixels. Ten times faster than the whole run.
#pragma once

#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "firmware/core/task/servo_loop.hpp"
#include "sim/run/sim_planner.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/scenario/world_config.hpp"
#include "sim/verdict/config.hpp"
#include "sim/world/sim_arm.hpp"
#include "sim/world/world_clock.hpp"
#include "tests/support/truth_eye.hpp"

namespace fovea::test {

class TruthRun final : private hal::Recorder, private hal::TickProbe {
 public:
  TruthRun(const std::string& name, const std::vector<std::string>& assignments, double sigma_px)
      : about_(sim::DescribeRun(sim::LoadScenario(name, assignments))),
        eye_(about_.servo.feature, about_.pinhole.f_px, sigma_px,
             static_cast<unsigned>(about_.scenario.run.seed)),
        verdict_(sim::MakeVerdictConfig(about_)),
        world_(sim::MakeWorldConfig(about_)) {}

  sim::Summary Execute() {
    if (!task_.Init(about_.servo).ok()) {
      throw std::logic_error("Init refuses a configuration that was already checked");
    }
    const auto latency_ns = static_cast<std::int64_t>(about_.scenario.camera.latency_ms * 1e6);
    sim::Summary summary;
    world_.OnStep([&](const sim::Truth& truth) { verdict_.AddTruth(truth, mode_); });
    world_.OnExposure([&](const sim::Exposure& exposure) {
      const Eigen::Isometry3d X_CB = exposure.X_BC.inverse();
      const model::Pose X_CO{X_CB.linear() * exposure.R_BO, X_CB * exposure.p_BO};
      under_way_.push_back(eye_.See(X_CO, exposure.stamp_ns, exposure.sequence));
      ++summary.frames;
      ++summary.frames_detected;
    });
    hal::FeatureMailbox mailbox;
    sim::SimArm arm(world_);
    sim::SimPlanner planner(about_.servo, about_.reach, about_.scenario.faults.planner);
    sim::LockstepClock clock(world_, [&](std::int64_t now_ns) {
      while (!under_way_.empty() && under_way_.front().stamp_ns + latency_ns <= now_ns) {
        mailbox.Put(under_way_.front());
        under_way_.pop_front();
      }
      planner.Act(now_ns, /*lockstep=*/true);
      return true;
    });
    task::ServoLoop loop(task_, arm, clock, mailbox, *this, *this);
    loop.UsePlanner(planner.box());
    const hal::Status status = loop.Run(static_cast<std::int64_t>(about_.scenario.run.duration_s * 1e9));
    clock.RethrowFailure();
    if (!status.ok()) {
      throw std::runtime_error("the run was aborted");
    }
    summary.scenario = about_.scenario.name;
    summary.seed = about_.scenario.run.seed;
    verdict_.Fill(summary);
    return summary;
  }

  // What happened to plans, with the times [s].
  [[nodiscard]] const std::vector<std::pair<double, hal::PlanEvent>>& plans() const { return plans_; }

 private:
  void Record(const hal::TickRecord& record) noexcept override {
    mode_ = record.mode;
    verdict_.AddRecord(record);
    if (record.way.event != hal::PlanEvent::kNone) {
      plans_.emplace_back(1e-9 * static_cast<double>(record.stamp_ns), record.way.event);
    }
  }
  void Enter() noexcept override {}
  void Leave() noexcept override {}

  const sim::RunDescription about_;
  TruthEye eye_;
  sim::Verdict verdict_;
  hal::Mode mode_ = hal::Mode::kBoot;  // of the last tick
  sim::World world_;
  task::ServoTask task_;
  std::deque<hal::FeatureMeasurement> under_way_;
  std::vector<std::pair<double, hal::PlanEvent>> plans_;
};

inline sim::Summary RunByTruth(const std::string& name, const std::vector<std::string>& assignments = {},
                               double sigma_px = 0.05) {
  return TruthRun(name, assignments, sigma_px).Execute();
}

}  // namespace fovea::test
