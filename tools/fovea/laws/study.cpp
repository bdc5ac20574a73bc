// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/laws/study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "firmware/core/config/law_config.hpp"
#include "firmware/host/build_info.hpp"
#include "firmware/host/config/input_error.hpp"
#include "tools/fovea/atlas/batch.hpp"

namespace fovea::laws {
namespace {

std::vector<std::string> LawsOf(const std::vector<std::string>& only) {
  std::vector<std::string> laws;
  for (const char* name : config::kLawNames) {
    if (only.empty() || std::find(only.begin(), only.end(), name) != only.end()) {
      laws.emplace_back(name);
    }
  }
  for (const std::string& name : only) {
    if (std::find(laws.begin(), laws.end(), name) == laws.end()) {
      throw config::InputError(
          fmt::format("--only {}: no such law; allowed are {}", name, fmt::join(config::kLawNames, ", ")));
    }
  }
  return laws;
}

TargetStudy RunTarget(const std::string& target, const std::vector<std::string>& laws,
                      const StudyOptions& options) {
  // A law is compared without the plans that would take over far from the goal.
  std::vector<std::string> assignments{"servo.plans=false"};
  assignments.insert(assignments.end(), options.assignments.begin(), options.assignments.end());
  const atlas::Scene scene = atlas::LoadScene(target, atlas::SceneAssignments(assignments));
  TargetStudy study{target, TasksFor(scene, options.random, options.seed), {}};
  std::vector<atlas::Start> starts;
  starts.reserve(study.tasks.tasks.size());
  for (const Task& task : study.tasks.tasks) {
    starts.push_back(task.start);
  }
  std::vector<atlas::Case> cases;
  cases.reserve(laws.size());
  for (const std::string& law : laws) {
    cases.push_back({law, {"servo.law=" + law}, false});
  }
  const atlas::Heading heading{target, options.seed, assignments, kServoLibraryHash, {}, "laws"};
  atlas::Batch batch(heading, options.out / target, options.jobs, options.resume, starts);
  const int runs = static_cast<int>(starts.size());
  {
    atlas::Progress progress("laws, " + target, runs * static_cast<int>(laws.size()));
    batch.Execute(cases, runs, progress);
  }
  for (const std::string& law : laws) {
    for (const auto& [index, row] : batch.rows(law)) {
      study.rows[law].push_back(row);
    }
  }
  return study;
}

}  // namespace

Study RunStudy(const StudyOptions& options) {
  Study study{options.seed, LawsOf(options.only), {}, ""};
  for (const char* target : kTargets) {
    study.targets.push_back(RunTarget(target, study.laws, options));
  }
  const TargetStudy& first = study.targets.front();
  const atlas::Heading heading{first.target, options.seed, {"servo.plans=false"}, "", {}, ""};
  study.command =
      atlas::CommandOf(heading, atlas::ScenarioOf(first.target), first.rows.at(study.laws.front()).front());
  return study;
}

bool KeepsLimits(const Study& study) {
  for (const TargetStudy& target : study.targets) {
    for (const auto& [law, rows] : target.rows) {
      for (const atlas::Row& row : rows) {
        if (row.limit_violations > 0 || row.contact_ticks > 0) {
          return false;
        }
      }
    }
  }
  return true;
}

}  // namespace fovea::laws
