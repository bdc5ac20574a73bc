// SPDX-License-Identifier: Apache-2.0
// A study of findings: runs of the scenario ball-exciting, each with other errors of the servo's beliefs, and
// what each found out beside what was drawn.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/fovea/findings/coverage.hpp"

namespace fovea::findings {

// A belief and the truth that it is compared with.
struct Compared {
  const char* belief;  // its name in a summary's `beliefs`
  const char* truth;   // its key in a summary's `truth`
  int entry;           // of the truth
  const char* unit;    // of the belief; "%": of the believed value
  Goal goal;
};
const std::vector<Compared>& ComparedBeliefs();

struct Study {
  int seed = 0;  // of the first run
  int runs = 0;
  int unfinished = 0;               // runs that broke off; they count as runs that know nothing
  std::vector<Coverage> coverages;  // as ComparedBeliefs()
  std::string command;              // of the first run
};

struct StudyOptions {
  int seed = 1;
  int runs = 300;
  int jobs = 1;
  bool resume = false;
  std::filesystem::path out;  // folder for the rows
};

// InputError: the folder cannot be written. std::runtime_error: the simulator refuses a run, or a summary has
// no such belief or truth.
Study RunStudy(const StudyOptions& options);

// True if the findings of all beliefs meet their goals, and no run broke off.
bool IsGood(const Study& study);

}  // namespace fovea::findings
