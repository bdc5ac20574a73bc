// The faults of the matrix, each at three or four severities: which keys of [faults] it sets, to what, and
// why so much.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

namespace fovea::matrix {

inline constexpr std::array<const char*, 4> kSeverities{"mild", "medium", "severe", "extreme"};

inline constexpr double kForever = 8.0;  // what never ends is looked at for so long [s]

struct FaultLevel {
  double lasts_s = 1.0;               // kForever: the run ends with it
  std::vector<std::string> settings;  // "key=value" under faults.
  const char* figures;                // how much, with units, for people
  const char* why;                    // so much
};

struct Fault {
  const char* name;  // for people
  const char* id;    // of its cells
  const char* key;   // faults.<key>_s is its window
  bool is_the_eyes;  // a run without a camera cannot meet it
  std::vector<FaultLevel> levels;
  bool from_start = false;  // there when the arm is switched on, and never gone
};

std::span<const Fault> Faults();
// The fault of that id. std::out_of_range: there is none.
const Fault& FaultOf(const std::string& id);

// What `level` of `fault` sets from `onset_s` on, as fovea-sim's --set takes it.
std::vector<std::string> AssignmentsOf(const Fault& fault, const FaultLevel& level, double onset_s);

// "faults.<key>_s=[from, to]", to the millisecond.
std::string Window(const std::string& key, double from_s, double to_s);

}  // namespace fovea::matrix
