// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/compare/simulated_arm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <set>
#include <utility>

#include "firmware/host/config/input_error.hpp"
#include "sim/scenario/compose.hpp"
#include "sim/scenario/realism.hpp"
#include "sim/scenario/scenario_arm.hpp"
#include "sim/scenario/world_config.hpp"

namespace fovea::compare {
namespace {

using config::InputError;

bool IsOfArm(const std::string& key) { return key.starts_with("arm."); }

// Keys that say how the arm is. The log's other keys say what its servo did, or what was wrong with it.
bool IsUsed(const std::string& key) { return IsOfArm(key) || key == "run.seed"; }

// The arm of the log's configuration: of a robot's log, its model and load.
sim::Scenario ScenarioOf(const RecordedRun& run) {
  if (!run.keys.contains("arm.model")) {
    throw InputError("the log does not name its arm (arm.model): use --scenario");
  }
  sim::Scenario scenario;
  const config::KeyTable keys = sim::ScenarioKeys(scenario);
  std::map<std::string, std::string> known = keys.Values();
  for (const auto& [name, text] : run.keys) {
    const std::string& today = keys.NameToday(name);
    const auto key = known.find(today);
    if (IsUsed(today) && key != known.end() && key->second != text) {
      keys.Apply(config::ParseAssignment(today + "=" + text));
    }
  }
  scenario.arm_is_the_users = true;
  return scenario;
}

void Change(const std::vector<std::string>& assignments, sim::Scenario& scenario) {
  const config::KeyTable keys = sim::ScenarioKeys(scenario);
  std::vector<std::string> allowed;
  for (const config::Key& key : keys.keys()) {
    if (IsOfArm(key.name)) {
      allowed.push_back(key.name);
    }
  }
  std::set<std::string> given;
  for (const std::string& assignment : assignments) {
    const config::Setting setting = config::ParseAssignment(assignment);
    if (!IsOfArm(setting.key)) {
      throw InputError(fmt::format("--set {}: a comparison accepts the keys of [arm]{}", setting.key,
                                   config::DidYouMean(setting.key, allowed)));
    }
    keys.Apply(setting);
    given.insert(setting.key);
  }
  if (given.contains("arm.realism")) {
    sim::ApplyRealism(given, scenario);
  }
}

// InputError: not the log's arm.
void CheckArm(const RecordedRun& run, const robots::Robot& robot) {
  if (run.joints != robot.joint_names) {
    throw InputError(fmt::format("the log is of an arm with the joints {}; the simulated arm \"{}\" has {}",
                                 fmt::join(run.joints, ", "), robot.name,
                                 fmt::join(robot.joint_names, ", ")));
  }
  constexpr double kRounding = 1e-9;  // [m], or entries of rotations
  for (std::size_t i = 0; run.has_arm && i < run.joints.size(); ++i) {
    const model::Pose& there = run.arm.joints[i].X_PJ;
    const model::Pose& here = robot.model.joints[i].X_PJ;
    if ((there.R - here.R).cwiseAbs().maxCoeff() > kRounding ||
        (there.p - here.p).cwiseAbs().maxCoeff() > kRounding) {
      throw InputError(
          fmt::format("the log is of another arm: its joint {} is not where it is on the arm \"{}\"",
                      run.joints[i], robot.name));
    }
  }
}

sim::SimRobot Loaded(sim::SimRobot robot, const model::Load& load) {
  sim::AddLoad(load, robot);
  return robot;
}

}  // namespace

SimulatedArm MakeSimulatedArm(const RecordedRun& run, const std::string& scenario,
                              const std::vector<std::string>& assignments) {
  sim::Scenario believed = scenario.empty() ? ScenarioOf(run) : sim::LoadScenario(scenario, {});
  const auto n = static_cast<std::ptrdiff_t>(run.joints.size());
  believed.arm.q_start.assign(run.q_first.begin(), run.q_first.begin() + n);
  believed.arm.dq_start.clear();
  CheckArm(run, sim::LoadScenarioRobot(believed));
  sim::Scenario changed = believed;
  Change(assignments, changed);
  CheckArm(run, sim::LoadScenarioRobot(changed));
  sim::ScenarioArm arm = sim::LoadScenarioArm(changed);
  const model::Load load = config::MakeLoad(changed.arm.load);
  SimulatedArm simulated;
  simulated.robot = std::move(arm.robot);
  simulated.load_centre_E = load.p_ECom;
  simulated.world.robot = Loaded(std::move(arm.unloaded), load);
  if (!assignments.empty()) {
    simulated.world.robot_truth.believed =
        Loaded(sim::LoadScenarioArm(believed).unloaded, config::MakeLoad(believed.arm.load));
  }
  sim::SetArm(changed, simulated.world);
  simulated.world.encoder_noise = simulated.world.velocity_noise = 0.0;
  return simulated;
}

}  // namespace fovea::compare
