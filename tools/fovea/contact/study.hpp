// SPDX-License-Identifier: Apache-2.0
// A contact study: simulates the runs, with the servo's own check of contact off, and judges what they
// record.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/fovea/contact/plan.hpp"
#include "tools/fovea/contact/roc.hpp"

namespace fovea::contact {

// The runs in which the servo's beliefs are right, or wrong.
struct Runs {
  std::vector<QuietRun> quiet;
  std::array<std::array<std::vector<PushedRun>, kForces.size()>, kPlaces.size()> pushed;
};

struct Study {
  int seed = 1;
  int runs = 0;
  std::size_t threshold = 0;   // nearest to the default of safety.contact_torque_fraction
  double sudden_weight = 0.0;  // of the default limits
  std::vector<std::string> motions;
  std::string command;  // of one run
  Runs right;
  Runs wrong;
};

struct StudyOptions {
  int seed = 1;
  int jobs = 1;
  bool resume = false;
  std::vector<std::string> only;  // names of motions; empty: all
  std::filesystem::path out;      // folder for the rows
};

// InputError: `only` names no motion, or the folder cannot be written. std::runtime_error: a run broke off.
Study RunStudy(const StudyOptions& options);

// True if the default detector gave no false alarm, and the arm stops after every push of the largest force
// at the hand.
bool IsGood(const Study& study);

}  // namespace fovea::contact
