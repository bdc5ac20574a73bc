// SPDX-License-Identifier: Apache-2.0
// The faults of a run as switches for an operator: start, stop, change of size.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/scenario/fault_settings.hpp"

namespace fovea::sim {

// A number that sizes a fault.
struct FaultSize {
  std::string name;  // its key without "faults."; an entry of a list with its number, from 1: "push[1]"
  std::string unit;
  std::string meaning;
  double min = 0.0;
  double max = 0.0;
  bool whole = false;  // a whole number; 0 and 1 of a flag
  double value = 0.0;
};

struct FaultSwitch {
  std::string name;
  std::string meaning;
  bool active = false;
  std::vector<FaultSize> sizes;
};

// Which faults a panel has: all, or those that `serve` accepts (see CheckServedFaults).
enum class FaultChoice { kAll, kServed };

class FaultPanel {
 public:
  FaultPanel(const FaultSettings& faults, int num_joints, FaultChoice choice = FaultChoice::kAll)
      : faults_(faults), num_joints_(num_joints), choice_(choice) {}

  // The faults as they are at `now_s`, in the order of their keys; not "nothing".
  [[nodiscard]] std::vector<FaultSwitch> Switches(double now_s) const;

  // Fault `name` acts from `now_s` on until Stop, with the `sizes` [by FaultSize::name]; the others stay as
  // they are. An active fault takes its new sizes at once; one that has just ended goes on. InputError, and
  // nothing is changed: there is no such fault or size, or a size is out of range.
  void Start(const std::string& name, const std::map<std::string, double>& sizes, double now_s);
  // Ends fault `name` at `now_s`. InputError: there is no such fault.
  void Stop(const std::string& name, double now_s);

  [[nodiscard]] const FaultSettings& faults() const { return faults_; }

 private:
  FaultSettings faults_;
  int num_joints_;
  FaultChoice choice_;
};

}  // namespace fovea::sim
