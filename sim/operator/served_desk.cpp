// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/served_desk.hpp"

#include <utility>
#include <variant>

#include "firmware/host/config/input_error.hpp"

namespace fovea::sim {

ServedDesk::ServedDesk(const RunDescription& about, World& world, CameraFaults camera_faults)
    : world_(world),
      camera_faults_(std::move(camera_faults)),
      hands_(about, world, [](const std::string& /*what*/, const std::string& /*text*/) {}),
      faults_(about, FaultChoice::kServed) {}

live::Catalogue ServedDesk::Offer(const RunDescription& about) {
  using live::Service;
  live::Catalogue offer;
  offer.name = about.scenario.name;
  offer.faults = FaultDesk(about, FaultChoice::kServed).Kinds();
  offer.services = {Service::kEnd, Service::kStartFault, Service::kStopFault, Service::kPull,
                    Service::kRelease};
  offer.target = about.scene.has_eye;
  if (offer.target) {
    offer.services.push_back(Service::kThrow);
  }
  return offer;
}

live::Answer ServedDesk::Do(const live::Call& call) {
  try {
    return std::visit([this](const auto& request) { return Take(request); }, call.request);
  } catch (const config::InputError& error) {
    return {error.what(), "{}"};
  }
}

live::Answer ServedDesk::Take(const live::StartFault& request) {
  static_cast<void>(faults_.Start(request, now_s()));
  PassFaults();
  return {};
}

live::Answer ServedDesk::Take(const live::StopFault& request) {
  static_cast<void>(faults_.Stop(request, now_s()));
  PassFaults();
  return {};
}

void ServedDesk::PassFaults() {
  world_.SetFaults(faults_.faults().bench);
  if (camera_faults_) {
    camera_faults_(faults_.faults());
  }
}

live::State ServedDesk::State() const {
  live::State state;
  state.stamp_s = now_s();
  faults_.Fill(now_s(), state);
  hands_.Fill(state);
  return state;
}

}  // namespace fovea::sim
