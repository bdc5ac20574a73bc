// SPDX-License-Identifier: Apache-2.0
// What a viewer may do to the bench of a served robot, whose servo runs in another program: move the target,
// pull the arm, break something.
#pragma once

#include <cstdint>
#include <functional>

#include "firmware/host/live/calls.hpp"
#include "firmware/host/live/catalogue.hpp"
#include "firmware/host/live/state.hpp"
#include "fovea/hal/types.hpp"
#include "sim/operator/bench_hands.hpp"
#include "sim/operator/fault_desk.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// The bench at one instant. It has a fixed size: copying it does not allocate.
struct ServedLook {
  std::int64_t stamp_ns = 0;  // in the world's time
  int num_joints = 0;
  hal::JointArray q{};  // [num_joints; rad, m]
  Eigen::Isometry3d X_BC = Eigen::Isometry3d::Identity();
  HandsLook hands;
};

// All functions from the thread that advances the world, except State.
class ServedDesk {
 public:
  // Borrows `about` and `world`. `camera_faults` passes changed faults on to the camera; may be empty.
  using CameraFaults = std::function<void(const FaultSettings& faults)>;
  ServedDesk(const RunDescription& about, World& world, CameraFaults camera_faults);

  // What a served robot with this description offers, without channels. The end of the serving is not the
  // desk's.
  static live::Catalogue Offer(const RunDescription& about);

  // Carries out a call. An answer with an error changes nothing. A request for a fault allocates.
  live::Answer Do(const live::Call& call);
  // Never refused. They allocate nothing.
  void LetTargetGo() { hands_.LetTargetGo(); }
  void LetArmGo() { hands_.LetArmGo(); }
  // Call before each step of the world.
  void Act() { hands_.Act(); }
  // The bench now. Allocates nothing.
  [[nodiscard]] ServedLook Look() const;
  // The bench at `look`; the rest of the state is the page's. From any thread, but not during Do.
  [[nodiscard]] live::State State(const ServedLook& look) const;

 private:
  template <class Request>
  [[nodiscard]] live::Answer Take(const Request& request) {
    if constexpr (HandRequest<Request>) {
      return hands_.Take(request);
    } else {
      return {"a served robot does not offer this", "{}"};
    }
  }
  [[nodiscard]] live::Answer Take(const live::StartFault& request);
  [[nodiscard]] live::Answer Take(const live::StopFault& request);

  void PassFaults();

  const RunDescription& about_;
  World& world_;
  const CameraFaults camera_faults_;
  BenchHands hands_;
  FaultDesk faults_;
};

}  // namespace fovea::sim
