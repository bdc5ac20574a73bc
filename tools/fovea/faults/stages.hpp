// Where in a run a fault comes: the modes of run, the stages of each, and when a stage is reached.
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

// A kind of run that the servo has a mode for.
struct RunMode {
  const char* name;  // for people
  const char* scenario;
  const char* title;
  bool has_eye;
  double approach_share;  // of the way from the first motion to the goal, in time: where `approach` is
  double settled_s;       // `tracking` is so long after the goal was reached [s]
  double recovery_s;      // a run goes on for so long after the fault [s]
  double kept_s;  // its goal is kept when it is for so long; a moving target's is a mean over 0.5 s itself
};
std::span<const RunMode> RunModes();

// Whether `fault` in `stage` of `mode` means anything.
bool MakesSense(const RunMode& mode, Stage stage, const Fault& fault);
// Why not: for people, one line for each combination that is left out.
std::vector<std::string> LeftOut();

// When the stages are reached, by the summary of a run that nothing disturbs. std::runtime_error when that
// run does not reach its goal.
struct StageTimes {
  double boot_s = 0.0;
  double approach_s = 0.0;
  double tracking_s = 0.0;
  double goal_s = 0.0;  // the goal is kept from then on
};
StageTimes TimesOf(const RunMode& mode, const nlohmann::json& undisturbed);

// A stage, brought about: what is set before the fault, and when the fault begins.
struct StageSetup {
  std::string name;  // of the run beside which the fault's is held
  std::vector<std::string> assignments;
  double onset_s = 0.0;
};
// `fault`, where it is known: what hides the target in the stage `coasting` is not what comes then, and what
// is there from the start comes before half of Boot is over.
StageSetup SetUp(const StageTimes& times, Stage stage, const Fault* fault);

}  // namespace fovea::matrix
