// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/served_desk.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "firmware/host/config/input_error.hpp"

namespace fovea::sim {

ServedDesk::ServedDesk(const RunDescription& about, World& world, CameraFaults camera_faults)
    : about_(about),
      world_(world),
      camera_faults_(std::move(camera_faults)),
      hands_(about, world, {}),
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
  static_cast<void>(faults_.Start(request, world_.now_ns()));
  PassFaults();
  return {};
}

live::Answer ServedDesk::Take(const live::StopFault& request) {
  static_cast<void>(faults_.Stop(request, world_.now_ns()));
  PassFaults();
  return {};
}

void ServedDesk::PassFaults() {
  world_.SetFaults(faults_.faults().bench);
  if (camera_faults_) {
    camera_faults_(faults_.faults());
  }
}

ServedLook ServedDesk::Look() const {
  const Truth& truth = world_.truth();
  ServedLook look;
  look.stamp_ns = truth.stamp_ns;
  look.num_joints = std::min(static_cast<int>(truth.q.size()), hal::kMaxJoints);
  std::copy_n(truth.q.data(), look.num_joints, look.q.begin());
  look.X_BC = truth.X_BC;
  look.hands = hands_.Look(/*paused=*/false);
  return look;
}

live::State ServedDesk::State(const ServedLook& look) const {
  live::State state;
  state.stamp_s = static_cast<double>(look.stamp_ns) * 1e-9;
  faults_.Fill(look.stamp_ns, state);
  Fill(about_, look.hands, state);
  return state;
}

}  // namespace fovea::sim
