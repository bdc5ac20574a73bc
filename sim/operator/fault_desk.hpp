// SPDX-License-Identifier: Apache-2.0
// The faults of a run as viewers of a live page see and switch them.
#pragma once

#include <string>
#include <vector>

#include "firmware/host/live/calls.hpp"
#include "firmware/host/live/catalogue.hpp"
#include "firmware/host/live/state.hpp"
#include "sim/operator/fault_panel.hpp"
#include "sim/scenario/run_description.hpp"

namespace fovea::sim {

class FaultDesk {
 public:
  explicit FaultDesk(const RunDescription& about, FaultChoice choice = FaultChoice::kAll);

  // For the catalogue.
  [[nodiscard]] std::vector<live::FaultKind> Kinds() const;
  // Both act at `now_s`, and return what happened, for a person. InputError, and nothing is changed: see
  // FaultPanel.
  std::string Start(const live::StartFault& request, double now_s);
  std::string Stop(const live::StopFault& request, double now_s);
  // Sets the state's faults, in the order of Kinds.
  void Fill(double now_s, live::State& state) const;

  [[nodiscard]] const FaultSettings& faults() const { return panel_.faults(); }

 private:
  FaultPanel panel_;
};

}  // namespace fovea::sim
