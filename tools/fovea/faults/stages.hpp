// SPDX-License-Identifier: Apache-2.0
// When a fault starts in a run: the modes of run, the stages of each, and the time of each stage.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/fovea/faults/table.hpp"

namespace fovea::matrix {

enum class Stage { kBoot, kApproach, kTracking, kCoasting, kFault };
inline constexpr std::array kStages{Stage::kBoot, Stage::kApproach, Stage::kTracking, Stage::kCoasting,
                                    Stage::kFault};

const char* Name(Stage stage);

// A kind of run, such as visual servoing or a joint motion.
struct RunMode {
  const char* name;  // for people
  const char* scenario;
  const char* title;
  bool has_eye;
  double approach_share;  // `approach` is after this share of the time from first motion to goal
  double settled_s;       // `tracking` is this long after the goal was reached [s]
  double recovery_s;      // how long a run goes on after the fault [s]
  double kept_s;          // least time at the goal [s]; a moving target's error is a mean over 0.5 s already
};
std::span<const RunMode> RunModes();

// Whether `fault` in `stage` of `mode` makes sense.
bool MakesSense(const RunMode& mode, Stage stage, const Fault& fault);
// Text for people: one line for each kind of combination that is left out, and why.
std::vector<std::string> LeftOut();

// The times of the stages, from the summary of a run without faults. std::runtime_error when that run does
// not reach its goal.
struct StageTimes {
  double boot_s = 0.0;
  double approach_s = 0.0;
  double tracking_s = 0.0;
  double goal_s = 0.0;  // the goal is kept from this time on
};
StageTimes TimesOf(const RunMode& mode, const nlohmann::json& undisturbed);

// The settings that lead to a stage, and the time at which the fault starts.
struct StageSetup {
  std::string name;  // of the run without the fault, for comparison
  std::vector<std::string> assignments;
  double onset_s = 0.0;
};
// `fault` may be null. In the stage `coasting` another fault than `fault` hides the target. A fault from the
// start begins with the first tick, not when half of Boot is over.
StageSetup SetUp(const StageTimes& times, Stage stage, const Fault* fault);

}  // namespace fovea::matrix
