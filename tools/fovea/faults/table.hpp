// SPDX-License-Identifier: Apache-2.0
// The faults of the matrix, each at three or four severities: the keys of [faults] that it sets, their
// values, and the reason for each value.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

namespace fovea::matrix {

inline constexpr std::array<const char*, 4> kSeverities{"mild", "medium", "severe", "extreme"};

inline constexpr double kForever = 8.0;  // simulated duration of a fault that never ends [s]

struct FaultLevel {
  double lasts_s = 1.0;               // kForever: the run ends with it
  std::vector<std::string> settings;  // "key=value" under faults.
  const char* figures;                // text for people: the values with units
  const char* why;                    // reason for these values
};

struct Fault {
  const char* name;  // for people
  const char* id;    // in the names of its cells
  const char* key;   // faults.<key>_s is its window
  bool is_the_eyes;  // does not occur in a run without a camera
  std::vector<FaultLevel> levels;
  bool from_start = false;  // present from switching the arm on until the end
};

std::span<const Fault> Faults();
// The fault with this id. std::out_of_range when there is none.
const Fault& FaultOf(const std::string& id);

// The settings of `level` of `fault` from `onset_s` on, as values of fovea-sim's --set.
std::vector<std::string> AssignmentsOf(const Fault& fault, const FaultLevel& level, double onset_s);

// "faults.<key>_s=[from, to]", rounded to milliseconds.
std::string Window(const std::string& key, double from_s, double to_s);

}  // namespace fovea::matrix
