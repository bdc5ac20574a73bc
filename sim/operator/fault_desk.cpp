// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/fault_desk.hpp"

#include <fmt/format.h>

#include <utility>

#include "fovea/hal/types.hpp"

namespace fovea::sim {
namespace {

// The time of the step after `now_ns`, as TimeWindow compares it.
double NextStepS(std::int64_t now_ns) { return static_cast<double>(now_ns + hal::kTickPeriodNs) * 1e-9; }

}  // namespace

FaultDesk::FaultDesk(const RunDescription& about, FaultChoice choice)
    : panel_(about.scenario.faults, about.robot.model.num_joints, choice) {}

std::vector<live::FaultKind> FaultDesk::Kinds() const {
  std::vector<live::FaultKind> kinds;
  for (const FaultSwitch& fault : panel_.Switches(0.0)) {
    live::FaultKind kind{fault.name, fault.meaning, {}};
    for (const FaultSize& size : fault.sizes) {
      kind.settings.push_back(
          {size.name, size.meaning, size.unit, size.min, size.max, size.value, size.whole});
    }
    kinds.push_back(std::move(kind));
  }
  return kinds;
}

std::string FaultDesk::Start(const live::StartFault& request, std::int64_t now_ns) {
  const double from_s = NextStepS(now_ns);
  const std::string name = panel_.Switches(from_s).at(request.fault).name;
  panel_.Start(name, request.sizes, from_s);
  std::string text = "fault " + name;
  for (const auto& [size, value] : request.sizes) {
    text += fmt::format(", {} = {:g}", size, value);
  }
  return text;
}

std::string FaultDesk::Stop(const live::StopFault& request, std::int64_t now_ns) {
  const double to_s = NextStepS(now_ns);
  const std::string name = panel_.Switches(to_s).at(request.fault).name;
  panel_.Stop(name, to_s);
  return fmt::format("fault {} stopped", name);
}

void FaultDesk::Fill(std::int64_t now_ns, live::State& state) const {
  for (const FaultSwitch& fault : panel_.Switches(NextStepS(now_ns))) {
    live::FaultState shown{fault.active, {}};
    for (const FaultSize& size : fault.sizes) {
      shown.values.push_back(size.value);
    }
    state.faults.push_back(std::move(shown));
  }
}

}  // namespace fovea::sim
