// SPDX-License-Identifier: Apache-2.0
// What a viewer may do to the bench of a served robot, whose servo runs in another program: move the target,
// pull the arm, break something.
#pragma once

#include <functional>

#include "firmware/host/live/calls.hpp"
#include "firmware/host/live/catalogue.hpp"
#include "firmware/host/live/state.hpp"
#include "sim/operator/bench_hands.hpp"
#include "sim/operator/fault_desk.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// All functions from the thread that advances the world.
class ServedDesk {
 public:
  // Borrows `about` and `world`. `camera_faults` passes changed faults on to the camera; may be empty.
  using CameraFaults = std::function<void(const FaultSettings& faults)>;
  ServedDesk(const RunDescription& about, World& world, CameraFaults camera_faults);

  // What a served robot with this description offers, without channels. The end of the serving is not the
  // desk's.
  static live::Catalogue Offer(const RunDescription& about);

  // Carries out a call. An answer with an error changes nothing.
  live::Answer Do(const live::Call& call);
  // Call before each step of the world.
  void Act() { hands_.Act(); }
  // The bench now; the rest of the state is the page's.
  [[nodiscard]] live::State State() const;

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

  [[nodiscard]] double now_s() const { return static_cast<double>(world_.now_ns()) * 1e-9; }
  void PassFaults();

  World& world_;
  const CameraFaults camera_faults_;
  BenchHands hands_;
  FaultDesk faults_;
};

}  // namespace fovea::sim
