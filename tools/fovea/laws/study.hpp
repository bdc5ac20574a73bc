// SPDX-License-Identifier: Apache-2.0
// Simulates all visual laws on the same starts.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/fovea/atlas/rows.hpp"
#include "tools/fovea/laws/tasks.hpp"

namespace fovea::laws {

// The targets that show their orientation: the others leave little to tell laws apart.
inline constexpr std::array<const char*, 2> kTargets{"square", "triangle"};

struct TargetStudy {
  std::string target;
  Tasks tasks;
  std::map<std::string, std::vector<atlas::Row>> rows;  // by law, in the order of the tasks
};

struct Study {
  std::uint64_t seed = 1;  // of the random starts
  std::vector<std::string> laws;
  std::vector<TargetStudy> targets;
  std::string command;  // of one run
};

struct StudyOptions {
  std::uint64_t seed = 1;
  int random = 30;  // starts
  int jobs = 1;
  bool resume = false;
  std::vector<std::string> only;         // laws; empty: all
  std::vector<std::string> assignments;  // for every run
  std::filesystem::path out;             // folder for the rows
};

// InputError: `only` names no law, or the folder cannot be written. std::runtime_error: the simulator refuses
// a run.
Study RunStudy(const StudyOptions& options);

// True if no run exceeded a limit or touched anything.
bool KeepsLimits(const Study& study);

}  // namespace fovea::laws
