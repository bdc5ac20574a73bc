// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/faults/stages.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace fovea::matrix {
namespace {

constexpr double kHiddenS = 0.5;      // how long the target is hidden in the stage `coasting`
constexpr double kSwallowedS = 0.03;  // how long ticks are missed before the stage `fault`; limit: 20 ms
constexpr double kInTheStopS = 0.02;  // from the end of the missed ticks to the injected fault
constexpr const char* kOccluder = "faults.occluder_px=[320, 240, 640, 480]";

constexpr std::array kRunModes{
    RunMode{"ball", "ball", "visual servo on a still target", true, 0.3, 0.5, 4.0, 0.5},
    RunMode{"ball-moving", "ball-moving", "visual servo on a moving target", true, 0.5, 1.0, 3.5, 0.0},
    RunMode{"home", "home", "joint motion to the ready posture", false, 0.5, 0.5, 3.0, 0.5},
    RunMode{"flange-circle", "flange-circle", "flange control around a circle", false, 0.2, 1.5, 1.5, 0.5}};

double ToMs(double time_s) { return 1e-3 * std::round(1e3 * time_s); }

}  // namespace

const char* Name(Stage stage) {
  constexpr std::array kNames{"boot", "approach", "tracking", "coasting", "fault"};
  return kNames[static_cast<std::size_t>(stage)];
}

std::span<const RunMode> RunModes() { return kRunModes; }

bool MakesSense(const RunMode& mode, Stage stage, const Fault& fault) {
  if (fault.from_start && stage != Stage::kBoot) {
    return false;
  }
  return mode.has_eye || (!fault.is_the_eyes && stage != Stage::kCoasting);
}

std::vector<std::string> LeftOut() {
  return {
      "`home` and `flange-circle` have no camera: faults of frames, pictures and detections cannot affect "
      "them, nor does a planner, and they have no target to lose, so they do not coast",
      "A fault from the start (a load or a tilted base) is in the column of Boot and stays for the whole "
      "run"};
}

StageTimes TimesOf(const RunMode& mode, const nlohmann::json& undisturbed) {
  std::optional<double> boot_ends_s;
  std::optional<double> moves_s;
  for (const auto& event : undisturbed.at("modes")) {
    const double t_s = event.at("t_s");
    const std::string name = event.at("mode");
    if (name != "boot" && !boot_ends_s) {
      boot_ends_s = t_s;
    }
    if ((name == "track" || name == "move") && !moves_s) {
      moves_s = t_s;
    }
  }
  const auto& goal_s = undisturbed.at("end").at("goal_kept_since_s");
  if (!boot_ends_s || !moves_s || !goal_s.is_number()) {
    throw std::runtime_error(fmt::format("{}: without a fault it does not reach its goal: {}", mode.name,
                                         undisturbed.at("verdict").get<std::string>()));
  }
  StageTimes times;
  times.boot_s = ToMs(0.5 * *boot_ends_s);
  times.approach_s = ToMs(*moves_s + mode.approach_share * (goal_s.get<double>() - *moves_s));
  times.tracking_s = ToMs(goal_s.get<double>() + mode.settled_s);
  times.goal_s = goal_s.get<double>();
  return times;
}

StageSetup SetUp(const StageTimes& times, Stage stage, const Fault* fault) {
  StageSetup setup;
  setup.name = Name(stage);
  switch (stage) {
    case Stage::kBoot:
      setup.onset_s = times.boot_s;
      if (fault != nullptr && fault->from_start) {
        setup.name += "-start";
        setup.onset_s = 0.0;
      }
      break;
    case Stage::kApproach: setup.onset_s = times.approach_s; break;
    case Stage::kTracking: setup.onset_s = times.tracking_s; break;
    case Stage::kCoasting: {
      const double end_s = times.approach_s + kHiddenS;
      setup.onset_s = ToMs(times.approach_s + 0.5 * kHiddenS);
      if (fault != nullptr && std::string(fault->key) == "occluder") {
        setup.name += "-outage";
        setup.assignments = {Window("camera_outage", times.approach_s, end_s)};
      } else {
        setup.assignments = {Window("occluder", times.approach_s, end_s), kOccluder};
      }
      break;
    }
    case Stage::kFault:
      setup.assignments = {Window("deadline_miss", times.approach_s, times.approach_s + kSwallowedS)};
      setup.onset_s = ToMs(times.approach_s + kSwallowedS + kInTheStopS);
      break;
  }
  return setup;
}

}  // namespace fovea::matrix
