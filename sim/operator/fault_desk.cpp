// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/fault_desk.hpp"

#include <fmt/format.h>

#include <utility>

namespace fovea::sim {

FaultDesk::FaultDesk(const RunDescription& about, FaultChoice choice)
    : panel_(about.scenario.faults, about.robot.model.num_joints, choice) {}

std::vector<live::FaultKind> FaultDesk::Kinds() const {
  std::vector<live::FaultKind> kinds;
  for (const FaultSwitch& fault : panel_.Switches(0.0)) {
    live::FaultKind kind{fault.name, fault.meaning, {}};
    for (const FaultSize& size : fault.sizes) {
      kind.settings.push_back({size.name, size.meaning, size.unit, size.min, size.max, size.value});
    }
    kinds.push_back(std::move(kind));
  }
  return kinds;
}

std::string FaultDesk::Start(const live::StartFault& request, double now_s) {
  const std::string name = panel_.Switches(now_s).at(request.fault).name;
  panel_.Start(name, request.sizes, now_s);
  std::string text = "fault " + name;
  for (const auto& [size, value] : request.sizes) {
    text += fmt::format(", {} = {:g}", size, value);
  }
  return text;
}

std::string FaultDesk::Stop(const live::StopFault& request, double now_s) {
  const std::string name = panel_.Switches(now_s).at(request.fault).name;
  panel_.Stop(name, now_s);
  return fmt::format("fault {} stopped", name);
}

void FaultDesk::Fill(double now_s, live::State& state) const {
  for (const FaultSwitch& fault : panel_.Switches(now_s)) {
    live::FaultState shown{fault.active, {}};
    for (const FaultSize& size : fault.sizes) {
      shown.values.push_back(size.value);
    }
    state.faults.push_back(std::move(shown));
  }
}

}  // namespace fovea::sim
