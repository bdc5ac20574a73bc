// SPDX-License-Identifier: Apache-2.0
// The faults of a run as viewers of a live page see and switch them.
#pragma once

#include <cstdint>
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
  // The world is at `now_ns`: its state was measured, and a frame may be exposed. Both act from the next step
  // on, so the run is that of a scenario with this window. They return what happened, for a person.
  // InputError, and nothing is changed: see FaultPanel.
  std::string Start(const live::StartFault& request, std::int64_t now_ns);
  std::string Stop(const live::StopFault& request, std::int64_t now_ns);
  // Sets the state's faults, in the order of Kinds.
  void Fill(std::int64_t now_ns, live::State& state) const;

  [[nodiscard]] const FaultSettings& faults() const { return panel_.faults(); }

 private:
  FaultPanel panel_;
};

}  // namespace fovea::sim
